"""Devices of a configuration as a drive needs them: transports of actuators and receivers, frame of the path, pace."""
