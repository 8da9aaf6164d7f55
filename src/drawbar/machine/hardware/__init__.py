"""Wheel-angle and speed sensors, calibration: what lies between drawbar and a real machine's devices."""
