"""Types of the fields of messages: how each lies in its record (docs/messages.md)."""

from dataclasses import dataclass
from typing import Annotated


@dataclass(frozen=True, slots=True)
class Cell:
    """How a field lies in a record."""

    code: str
    """of `struct`, one letter, with a count before it for several numbers"""
    may_miss: bool = False
    """NaN: the value is not known; otherwise a record with NaN is refused, and with infinity always"""


Byte = Annotated[int, Cell("B")]
Count = Annotated[int, Cell("I")]
Signed = Annotated[int, Cell("i")]
Long = Annotated[int, Cell("Q")]
Time = Annotated[int, Cell("Q")]
Codes = Annotated[tuple[int, ...], Cell("8H")]
Number = Annotated[float, Cell("d")]
"""always finite"""
Known = Annotated[float, Cell("d", may_miss=True)]
"""finite, or NaN where it is not known"""
