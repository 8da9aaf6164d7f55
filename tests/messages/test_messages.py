"""Records between processes: golden bytes, round trips, and everything that is refused."""

import math
import struct
import zlib
from dataclasses import fields, replace
from operator import attrgetter
from typing import get_type_hints

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.messages import (
    KINDS,
    Action,
    CommandMessage,
    ControllerState,
    GateState,
    Heartbeat,
    Mode,
    OperatorMessage,
    Role,
    SupervisorState,
)
from drawbar.messages.records import LAYOUTS, Flaw, decode, encode

COMMAND = CommandMessage(
    sequence=7, time=10**9, valid_until=2 * 10**9, mode=Mode.DRIVE, tractor_angle=0.5, trailer_angle=-0.25, speed=1.0
)
NUMBERS = {"B": 2**8, "H": 2**16, "I": 2**32, "i": 2**31, "Q": 2**64}


def sample(cls, number=lambda: 1.5, whole=lambda size: 1):
    """Return a message of a class with the numbers that the functions give."""
    kind = next(kind for kind, each in KINDS.items() if each is cls)
    values = {}
    for name, cell, enumeration in LAYOUTS[kind].cells:
        if len(cell.code) > 1:
            values[name] = tuple(whole(2**16) for _ in range(8))
        elif cell.code == "d":
            values[name] = number()
        else:
            limit = len(enumeration) if enumeration else NUMBERS[cell.code]
            values[name] = enumeration(whole(limit)) if enumeration else whole(limit)
    return message_of(cls, values)


def message_of(cls, values):
    """Return a message of values by name, those of a part of it by `part.name`."""
    own = {}
    for name, value in values.items():
        first, _, inner = name.partition(".")
        own[first] = own.get(first, {}) | {inner: value} if inner else value
    hints = get_type_hints(cls)
    return cls(**{name: hints[name](**each) if isinstance(each, dict) else each for name, each in own.items()})


def resealed(record):
    return record[:-4] + struct.pack("<I", zlib.crc32(record[:-4]))


def test_a_command_lies_in_its_record_as_documented():
    body = struct.pack("<HBBIQQBddd", 0x4244, 7, 1, 7, 10**9, 2 * 10**9, 1, 0.5, -0.25, 1.0)
    record = encode(COMMAND)
    assert record == body + struct.pack("<I", zlib.crc32(body))
    assert record[:2] == b"DB"
    assert decode(record, CommandMessage) == COMMAND


def test_records_have_fixed_sizes_that_a_pipe_takes_whole():
    sizes = {cls.__name__: LAYOUTS[kind].size for kind, cls in KINDS.items()}
    assert sizes == {
        "CommandMessage": 53, "ControllerState": 156, "GateState": 174, "OperatorMessage": 65, "Heartbeat": 31,
        "Fixes": 258,
    }  # fmt: skip
    for cls in KINDS.values():
        assert len(encode(sample(cls))) == sizes[cls.__name__]


@pytest.mark.parametrize("cls", list(KINDS.values()), ids=lambda cls: cls.__name__)
@given(data=st.data())
@settings(derandomize=True, max_examples=25, deadline=None)
def test_every_message_comes_back_as_it_was(cls, data):
    message = sample(
        cls,
        number=lambda: data.draw(st.floats(allow_nan=False, allow_infinity=False)),
        whole=lambda limit: data.draw(st.integers(0, limit - 1)),
    )
    assert decode(encode(message), *KINDS.values()) == message


@pytest.mark.parametrize("cls", list(KINDS.values()), ids=lambda cls: cls.__name__)
def test_any_changed_byte_is_refused(cls):
    record = encode(sample(cls))
    for index in range(len(record)):
        spoiled = bytearray(record)
        spoiled[index] ^= 0x10
        assert isinstance(decode(bytes(spoiled), cls), Flaw)


@pytest.mark.parametrize("cls", list(KINDS.values()), ids=lambda cls: cls.__name__)
def test_any_other_length_is_refused(cls):
    record = encode(sample(cls))
    for end in range(len(record)):
        assert decode(record[:end], cls) is Flaw.LENGTH
    for end in range(len(record) - 4):
        assert decode(resealed(record[:end] + bytes(4)), cls) in (Flaw.LENGTH, Flaw.MARK, Flaw.KIND)
    assert decode(record + b"\0", cls) is Flaw.LENGTH
    assert decode(resealed(record + b"\0"), cls) is Flaw.LENGTH


def test_a_kind_that_is_not_expected_is_refused():
    assert decode(encode(COMMAND), ControllerState, OperatorMessage) is Flaw.KIND
    assert decode(encode(COMMAND)) is Flaw.KIND
    unknown = bytearray(encode(COMMAND))
    unknown[3] = 99
    assert decode(resealed(bytes(unknown)), *KINDS.values()) is Flaw.KIND


@pytest.mark.parametrize(("index", "value"), [(0, 0x45), (1, 0x43), (2, 1), (2, 0)])
def test_another_mark_or_version_is_refused(index, value):
    other = bytearray(encode(COMMAND))
    other[index] = value
    assert decode(resealed(bytes(other)), CommandMessage) is Flaw.MARK


@pytest.mark.parametrize("mode", [3, 255])
def test_an_undeclared_enumeration_is_refused(mode):
    spoiled = bytearray(encode(COMMAND))
    spoiled[24] = mode
    assert decode(resealed(bytes(spoiled)), CommandMessage) is Flaw.VALUE


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("cls", list(KINDS.values()), ids=lambda cls: cls.__name__)
def test_numbers_that_are_not_finite_are_refused_unless_they_may_miss(cls, bad):
    kind = next(kind for kind, each in KINDS.items() if each is cls)
    for name, cell, _ in LAYOUTS[kind].cells:
        if cell.code == "d":
            values = {each: attrgetter(each)(sample(cls)) for each, _, _ in LAYOUTS[kind].cells}
            found = decode(encode(message_of(cls, values | {name: bad})), cls)
            if cell.may_miss and math.isnan(bad):
                assert math.isnan(attrgetter(name)(found))
            else:
                assert found is Flaw.NOT_FINITE


def test_what_drives_the_vehicle_may_never_miss():
    for cls, names in {
        CommandMessage: ("tractor_angle", "trailer_angle", "speed"),
        GateState: ("speed_limit", "nudge"),
        OperatorMessage: ("value",),
    }.items():
        kind = next(kind for kind, each in KINDS.items() if each is cls)
        assert {name for name, cell, _ in LAYOUTS[kind].cells if cell.code == "d" and not cell.may_miss} == set(names)


@given(st.binary(max_size=200))
@settings(derandomize=True, max_examples=300, deadline=None)
def test_no_bytes_raise(data):
    assert isinstance(decode(data, *KINDS.values()), Flaw)


def test_a_number_beyond_its_field_is_the_senders_error():
    with pytest.raises(struct.error):
        encode(replace(COMMAND, sequence=2**32))


def test_every_field_is_declared_with_its_cell():
    for kind, cls in KINDS.items():
        assert list(dict.fromkeys(name.split(".")[0] for name, _, _ in LAYOUTS[kind].cells)) == [
            each.name for each in fields(cls)
        ]
    assert encode(Heartbeat(time=1, valid_until=2, role=Role.RECORDER, healthy=1, state=SupervisorState.ACTIVE))
    assert len(Action) == 10
