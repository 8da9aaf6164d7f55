"""Stand-ins: the devices of a machine behind their real wires, on this computer."""
