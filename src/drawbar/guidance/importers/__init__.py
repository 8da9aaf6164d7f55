"""Importers of recorded lines, one file format each."""
