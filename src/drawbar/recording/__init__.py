"""Logs: what a run was, written step by step and read back."""
