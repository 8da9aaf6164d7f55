"""Safety: the last check of a command, and the decision whether a run may continue."""
