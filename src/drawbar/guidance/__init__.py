"""Guidance: paths, their importers, and the references that the controllers follow."""
