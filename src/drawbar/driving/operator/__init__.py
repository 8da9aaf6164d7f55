"""Operator: what a person is shown of a drive in a terminal, and what is asked of the gate."""
