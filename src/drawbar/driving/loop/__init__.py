"""The loop between receivers and gate: samples, control steps, commands, and the line that is driven."""
