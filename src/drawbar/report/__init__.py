"""Report of a run: progress and figures in the console, metrics, a page and a picture from its log."""
