"""Misspelt names: for an unknown name, the known ones that may be meant."""

from collections.abc import Iterable


def meant(name: str, known: Iterable[str]) -> str:
    """Return the known name nearest to one that is unknown, as an addition to a message; empty: none is near."""
    from difflib import get_close_matches  # only an error needs it

    near = get_close_matches(str(name), list(known), n=1)
    return f" (did you mean {near[0]}?)" if near else ""
