"""Signals as an exported library in single precision has them: a time stamp that is a double, then floats."""

from struct import Struct
from typing import Any

from drawbar.signals.layout import Layout


class SingleLayout(Layout):
    """The bytes of one C structure of such a library."""

    def __init__(self, kind: Any) -> None:
        super().__init__(kind)
        numbers = self.struct.format.replace("d", "f")
        self.struct = Struct(f"d{numbers[1:]}")
        self.size = -(-self.struct.size // 8) * 8
