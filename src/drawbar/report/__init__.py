"""What a run shows: progress and figures in the console, metrics, a page and a picture from its log."""
