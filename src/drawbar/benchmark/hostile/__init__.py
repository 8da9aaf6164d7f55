"""Hostile stage problems whose truth is known by construction, and the verdict of each solver on them.

`python -m drawbar.benchmark.hostile` prints the table; tests/optimal/test_hostile.py judges a sample.
"""
