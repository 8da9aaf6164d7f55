"""Evaluation of a drive from its log: replay from its raw bytes, comparison of a shadow with its driver."""
