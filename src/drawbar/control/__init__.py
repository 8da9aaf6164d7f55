"""Control: the nominal controllers of both bodies, and the ancillary law that holds the vehicle to their plan."""
