"""Recording: logs of runs, written step by step and read back."""
