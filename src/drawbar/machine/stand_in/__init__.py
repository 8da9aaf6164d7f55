"""Stand-ins: devices of a machine as programs on this computer, behind their real wires."""
