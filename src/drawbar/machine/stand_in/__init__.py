"""Stand-ins of real devices: what they would send, from the simulated machine."""
