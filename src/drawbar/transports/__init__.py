"""Transports: bytes in and out of serial lines, sockets, CAN buses and files; they know nothing of their meaning."""
