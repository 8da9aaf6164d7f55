"""Encoding of what a log holds: the header, and steps and messages of older logs, as JSON; all others as CDR.

Layouts: step/layout.py, message_layout.py.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, get_args

import msgspec
import numpy as np
from pydantic import BaseModel

from drawbar.recording.message_layout import message_reader
from drawbar.recording.stream import LoggedMessage
from drawbar.signals import StepRecord
from drawbar.step.layout import StepLayout

_NUMPY = (np.ndarray, np.generic)


def encode_special(value: Any) -> Any:
    """Turn what msgspec does not support into what it does: arrays, numpy scalars, configuration sections.

    Raises:
        TypeError: the value is none of these.
    """
    if isinstance(value, _NUMPY):
        return value.tolist()
    if isinstance(value, BaseModel):
        return value.model_dump()
    raise TypeError(f"a {type(value).__name__} cannot be written to a log; numbers, arrays and dataclasses can")


def decode_special(kind: Any, value: Any) -> Any:
    """Make of what msgspec has read an array or a section of the configuration."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return kind.model_validate(value)
    _, dtype = get_args(kind)  # of NDArray[...]: shape, dtype[...]
    return np.array(value, dtype=get_args(dtype)[0])


def missing_to_nan(value: Any) -> Any:
    """Return decoded JSON in which null, a missing number, is NaN."""
    if isinstance(value, dict):
        return {key: missing_to_nan(item) for key, item in value.items()}
    return np.nan if value is None else value


def decode_step(message: LoggedMessage) -> StepRecord:
    """Return the record of a step. Raises ValueError or DrawbarError: it is none of those that are known."""
    return _step_reader(message.schema)(message.data)


def decode_message(message: LoggedMessage) -> dict[str, Any]:
    """Return the fields of a message of one of the processes. Raises ValueError or struct.error: it is none."""
    if is_json(message.schema):
        content: dict[str, Any] = missing_to_nan(msgspec.json.decode(message.data))
        return content
    return message_reader(message.schema)(message.data)


@cache
def _step_reader(schema: str) -> Callable[[bytes], StepRecord]:
    """Return what reads the steps of a channel with this schema."""
    if is_json(schema):
        return _step_of_json
    layout = StepLayout.of_schema(schema)
    make = layout.reader()
    return lambda data: make(layout.body(data))


def is_json(schema: str) -> bool:
    """Return whether steps or messages are JSON, by their schema: those of logs by older drawbars."""
    return schema.startswith("{") or not schema


def _step_of_json(data: bytes) -> StepRecord:
    content = msgspec.json.decode(data)
    # At the top level null is an absent section (truth), below it a missing number.
    content = {key: None if value is None else missing_to_nan(value) for key, value in content.items()}
    return msgspec.convert(content, StepRecord, dec_hook=decode_special)
