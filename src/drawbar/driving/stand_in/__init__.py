"""Stand-ins of all devices: their sockets and their program on this computer, and a drive with them in one process."""
