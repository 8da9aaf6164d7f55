"""Fault detection: sensors that contradict the motion, and what the step is given instead of their values."""
