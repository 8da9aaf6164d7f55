"""NMEA 2000: GNSS receivers on the machine's CAN bus, frames to SI signals. Pure, without numpy and python-can."""
