"""Corrections for the receivers: from an NTRIP caster to a serial line or a board."""
