"""Protocols of real machines: pure functions and state machines between bytes and SI signals. No input, no output."""
