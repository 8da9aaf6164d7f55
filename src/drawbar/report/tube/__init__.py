"""What `drawbar tube` shows: sets, tightened bounds and their sources, and what a log says of the declared bounds."""
