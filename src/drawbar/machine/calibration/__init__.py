"""Calibration of sensors and steerings, from what was commanded and measured; it owns no device."""
