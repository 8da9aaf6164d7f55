"""Load a compiled unit and look into its workspace as numpy arrays, without copies."""

import ctypes
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_KINDS = (np.float64, np.int32)


@cache
def load(library: Path) -> ctypes.CDLL:
    """Load a shared library once per process."""
    return ctypes.CDLL(str(library))


class _Field(ctypes.Structure):
    _fields_ = (
        ("name", ctypes.c_char_p),
        ("offset", ctypes.c_int64),
        ("kind", ctypes.c_int32),
        ("shape", ctypes.c_int32 * 3),
        ("padding", ctypes.c_int32),
    )


class Workspace:
    """One instance of a compiled unit's state: its memory, its fields as arrays, its functions bound to it.

    The unit exports `drawbar_size` (bytes), `drawbar_fields` (terminated by a null name) and functions that take
    a pointer to the workspace and return an int.
    """

    def __init__(self, library: Path) -> None:
        self._library = load(library)
        size = ctypes.c_int64.in_dll(self._library, "drawbar_size").value
        memory = np.zeros(size + 63, np.uint8)
        start = -memory.ctypes.data % 64
        self.memory: NDArray[np.uint8] = memory[start : start + size]
        """(size,) bytes of the C struct, aligned to a cache line"""
        self._address = ctypes.c_void_p(self.memory.ctypes.data)
        self._fields = {name: self._view(*place) for name, place in _places(self._library).items()}

    def _view(self, offset: int, kind: type[Any], shape: tuple[int, ...], padding: int) -> NDArray[Any]:
        count = int(np.prod(shape)) * np.dtype(kind).itemsize
        stored: NDArray[Any] = self.memory[offset : offset + count].view(kind).reshape(shape)
        return stored[..., : shape[-1] - padding]

    def array(self, name: str) -> NDArray[Any]:
        """Return the named field as an array that shares the workspace's memory."""
        return self._fields[name]

    def function(self, name: str) -> Callable[[], int]:
        """Return the exported C function, bound to this workspace; calling it costs well under a microsecond."""
        function = getattr(self._library, name)
        function.argtypes = [ctypes.c_void_p]
        function.restype = ctypes.c_int
        address, memory = self._address, self.memory

        def call(_owner: NDArray[np.uint8] = memory) -> int:  # the function may outlive the workspace, not its memory
            return function(address)  # type: ignore[no-any-return]

        return call


def _places(library: ctypes.CDLL) -> dict[str, tuple[int, type[Any], tuple[int, ...], int]]:
    fields = ctypes.cast(library.drawbar_fields, ctypes.POINTER(_Field))
    places = {}
    index = 0
    while fields[index].name is not None:
        field = fields[index]
        shape = tuple(field.shape)
        while len(shape) > 1 and shape[-1] == 0:
            shape = shape[:-1]
        shape = tuple(max(size, 0) for size in shape)  # EMPTY
        places[field.name.decode().replace(" ", "")] = (
            field.offset,
            _KINDS[field.kind],
            shape,
            field.padding,
        )
        index += 1
    return places
