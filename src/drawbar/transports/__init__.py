"""Transports: bytes in and out of serial lines, sockets, CAN buses and files; without their meaning."""
