"""Preparation: what is done with a machine before its first drive: checks, wiggle test, calibrations."""
