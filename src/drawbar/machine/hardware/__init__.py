"""Hardware: the devices of a real machine, joined to its buses and lines."""
