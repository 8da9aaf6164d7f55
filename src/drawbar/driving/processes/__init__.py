"""Processes of a drive, a program each (`*_main.py`), and what starts, watches and ends them."""
