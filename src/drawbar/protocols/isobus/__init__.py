"""ISOBUS (ISO 11783): frames of the machine's CAN bus to SI signals and back. Pure, without numpy and python-can."""
