"""Schemas of logged dataclasses as JSON Schema, as far as viewers of logs read it: no references, one type each."""

from dataclasses import fields, is_dataclass
from enum import IntEnum, IntFlag
from typing import Any, get_args, get_origin, get_type_hints

import msgspec
import numpy as np

from drawbar.signals import Array

_TYPES = {bool: "boolean", int: "integer", float: "number", str: "string"}


def json_schema(kind: type) -> bytes:
    """Return the JSON Schema of a dataclass of numbers, enumerations, arrays and dataclasses.

    A missing number is written as null: viewers take that for a gap, but their parsers know no nullable type.
    """
    return msgspec.json.encode({"title": kind.__name__, **_object(kind)})


def _object(kind: type) -> dict[str, Any]:
    hints = get_type_hints(kind, include_extras=True)
    return {"type": "object", "properties": {field.name: _schema(hints[field.name]) for field in fields(kind)}}


def _schema(hint: Any) -> dict[str, Any]:
    kind = get_args(hint)[0] if hasattr(hint, "__metadata__") else hint
    array = next((each for each in getattr(hint, "__metadata__", ()) if isinstance(each, Array)), None)
    if array is not None or get_origin(kind) is np.ndarray:
        return _array(array)
    if get_origin(kind) is tuple:
        return {"type": "array", "items": _schema(get_args(kind)[0])}
    if type(None) in get_args(kind):  # an absent section
        return _schema(next(each for each in get_args(kind) if each is not type(None)))
    if isinstance(kind, type) and is_dataclass(kind):
        return _object(kind)
    if issubclass(kind, IntEnum | IntFlag):
        return {"type": "integer"}
    return {"type": _TYPES[kind]}


def _array(array: Array | None) -> dict[str, Any]:
    row = {"type": "array", "items": {"type": "number"}}
    return {"type": "array", "items": row} if array is not None and array.rows and array.columns else row
