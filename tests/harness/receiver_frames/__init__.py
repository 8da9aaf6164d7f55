"""Frames that receivers send of one epoch: what tests decode."""
