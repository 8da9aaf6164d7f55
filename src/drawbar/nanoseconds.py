"""Nanoseconds: whole ns, the times of records, from and to s, the times of everything else."""


def seconds(time: int) -> float:
    """Return a time of a record, ns, in s: the nearest number, so that equal times stay equal."""
    return time / 1e9


def nanoseconds(time: float) -> int:
    """Return a time of s in whole ns; 0 for one before all times."""
    return round(time * 1e9) if time > 0.0 else 0
