"""Library of a compiled unit, loaded, and its workspace as numpy arrays, without copies."""

import ctypes
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drawbar.errors import SolverError

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
        ("setting", ctypes.c_int32),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Place:
    offset: int
    kind: type[Any]
    shape: tuple[int, ...]
    padding: int
    setting: bool


def integer(library: Path, name: str) -> int:
    """Return an int64_t that a library offers."""
    return ctypes.c_int64.in_dll(load(library), name).value


def aligned(size: int) -> NDArray[np.uint8]:
    """Return so many bytes, zero, that begin at a cache line."""
    memory = np.zeros(size + 63, np.uint8)
    start = -memory.ctypes.data % 64
    return memory[start : start + size]


class Workspace:
    """One instance of a compiled unit's structure: its memory, its fields as arrays, its functions bound to it.

    A unit that stands alone exports `drawbar_size` (bytes), `drawbar_fields` (terminated by a null name) and functions
    that take a pointer to the structure and return an int. In a library of several units the names begin with
    `drawbar_UNIT_`.
    """

    def __init__(self, library: Path, unit: str = "", memory: NDArray[np.uint8] | None = None) -> None:
        """Look into memory, or into new memory of the unit's size.

        Args:
            library: compiled.
            unit: name of one of its units; empty: it is a single unit that stands alone.
            memory: (size,) bytes of the structure; None: new memory, all zero.
        """
        self._library, self._prefix = load(library), f"drawbar_{unit}_" if unit else ""
        prefix = self._prefix or "drawbar_"
        self.memory: NDArray[np.uint8] = aligned(integer(library, f"{prefix}size")) if memory is None else memory
        """(size,) bytes of the C structure"""
        self._address = ctypes.c_void_p(self.memory.ctypes.data)
        places = _places(self._library, f"{prefix}fields")
        self._fields = {_short(member): self._view(place) for member, place in places.items()}
        self._settings = [member for member, place in places.items() if place.setting]

    def _view(self, place: _Place) -> NDArray[Any]:
        count = math.prod(place.shape) * np.dtype(place.kind).itemsize
        stored: NDArray[Any] = self.memory[place.offset : place.offset + count].view(place.kind).reshape(place.shape)
        return stored[..., : place.shape[-1] - place.padding]

    def array(self, name: str) -> NDArray[Any]:
        """Return the named field as an array that shares the workspace's memory; of a solver without `rti.`.

        Raises:
            SolverError: there is no field of that name; says which there are.
        """
        if name not in self._fields:
            raise SolverError(f"There is no array {name!r}; there are {', '.join(self._fields)}.")
        return self._fields[name]

    def write(self, values: Mapping[str, ArrayLike]) -> None:
        """Set fields by name; raises SolverError, as `array` does, for a name that no field has."""
        for name, value in values.items():
            self.array(name)[...] = value

    def settings(self) -> dict[str, NDArray[Any]]:
        """Return the fields that are set once, before the first call, by what they are as members of the component."""
        return {member: self._fields[_short(member)] for member in self._settings}

    def function(self, name: str, pointers: int = 0) -> Callable[..., int]:
        """Return the exported C function, bound to this workspace; calling it costs about a microsecond.

        Args:
            name: of the function, whose first argument is the workspace.
            pointers: how many more it takes; the call wants their addresses, or ctypes structures by reference.
        """
        function = getattr(self._library, self._prefix + name)
        function.argtypes = [ctypes.c_void_p] * (1 + pointers)
        function.restype = ctypes.c_int
        address, memory = self._address, self.memory

        # the function may outlive the workspace, not its memory
        def call(*arguments: object, _owner: NDArray[np.uint8] = memory) -> int:
            return function(address, *arguments)  # type: ignore[no-any-return]

        return call


def _short(member: str) -> str:
    """Return what a component's member is called here: that of its solver `rti` by its own name."""
    return member.removeprefix("rti.")


def _places(library: ctypes.CDLL, table: str) -> dict[str, _Place]:
    fields = ctypes.cast(getattr(library, table), ctypes.POINTER(_Field))
    places = {}
    index = 0
    while fields[index].name is not None:
        field = fields[index]
        shape = tuple(field.shape)
        while len(shape) > 1 and shape[-1] == 0:
            shape = shape[:-1]
        shape = tuple(max(size, 0) for size in shape)  # EMPTY
        places[field.name.decode().replace(" ", "")] = _Place(
            offset=field.offset,
            kind=_KINDS[field.kind],
            shape=shape,
            padding=field.padding,
            setting=bool(field.setting),
        )
        index += 1
    return places
