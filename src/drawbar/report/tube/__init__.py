"""Tube report, for `drawbar tube`: sets, tightened bounds and their sources, and declared bounds against a log."""
