"""Messaging: what the processes of a drive send each other: options at their start, datagrams, heartbeats."""
