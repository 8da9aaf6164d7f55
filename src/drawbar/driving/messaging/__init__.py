"""Messaging: what the processes of a drive tell each other: options at their start, datagrams, heartbeats."""
