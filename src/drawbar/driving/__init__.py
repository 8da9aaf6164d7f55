"""Driving: the autopilot on a real machine, in processes that watch each other (docs/driving.md)."""
