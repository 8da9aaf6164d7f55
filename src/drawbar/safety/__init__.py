"""The last look at a command, and the decision whether a run may go on."""
