"""Hardware: settings and drivers that join the devices of a real machine to their transports and protocols."""
