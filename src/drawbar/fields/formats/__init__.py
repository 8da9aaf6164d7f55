"""Formats of fields, one file each: `read` returns fields, `write` returns the bytes of a file."""
