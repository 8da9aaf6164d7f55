"""Messages between processes in a log: as they were, read by drawbar and by ROS tools; those of older logs, as JSON."""

import math
import random
from dataclasses import asdict, replace

import msgspec
import pytest
from drive_messages import gate_of
from mcap.records import Schema
from mcap_ros2.decoder import DecoderFactory

from drawbar.messages import KINDS, Fixes, GateState, SupervisorState
from drawbar.messages.records import LAYOUTS, encode
from drawbar.recording.drive_records import TOPICS
from drawbar.recording.encoding import decode_message
from drawbar.recording.message_layout import message_reader, message_schema, pack_message
from drawbar.recording.stream import LoggedMessage
from drawbar.step.layout import HEAD

LARGEST = {"B": 2**8 - 1, "H": 2**16 - 1, "I": 2**32 - 1, "i": 2**31 - 1, "Q": 2**64 - 1}


def arbitrary(kind, chance):
    """Return a message of a kind with numbers of every size, some of them missing."""
    fields = {}
    for name, cell, enumeration in LAYOUTS[kind].cells:
        *part, leaf = name.split(".")
        place = fields.setdefault(part[0], {}) if part else fields
        if cell.code == "d":
            place[leaf] = math.nan if cell.may_miss and chance.random() < 0.2 else chance.gauss(0.0, 100.0)
        elif enumeration:
            place[leaf] = chance.choice(list(enumeration))
        elif len(cell.code) > 1:
            place[leaf] = tuple(chance.randrange(2**16) for _ in range(8))
        else:
            place[leaf] = chance.choice([0, chance.randrange(LARGEST[cell.code]), LARGEST[cell.code]])
    return msgspec.convert(fields, KINDS[kind])


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_a_message_is_read_as_it_was_by_drawbar_and_by_ros(kind):
    schema, chance = message_schema(KINDS[kind]), random.Random(kind)
    described = Schema(id=1, name=f"drawbar/msg/{KINDS[kind].__name__}", encoding="ros2msg", data=schema.encode())
    decode = DecoderFactory().decoder_for("cdr", described)
    for _ in range(20):
        message = arbitrary(kind, chance)
        data = pack_message(message)
        assert data.startswith(HEAD)
        assert encode(msgspec.convert(message_reader(schema)(data), KINDS[kind])) == encode(message)
        read = decode(data)
        for name, cell, _ in LAYOUTS[kind].cells:
            here, there = message, read
            for each in name.split("."):
                here, there = getattr(here, each), getattr(there, each)
            if len(cell.code) > 1:
                assert list(there) == list(here)
            else:
                assert there == here or (math.isnan(there) and math.isnan(here))


def test_what_a_message_means_stands_in_the_log():
    schema = message_schema(Fixes)
    assert "float64 hitch_angle  # tractor yaw minus drawbar yaw, rad\n" in schema
    assert schema.count("MSG: drawbar/ReceiverReport\n") == 1


def test_messages_of_older_logs_are_json():
    state = replace(gate_of(SupervisorState.ACTIVE), tractor_angle=0.25, remaining=math.nan)
    data = msgspec.json.encode(asdict(state))
    logged = LoggedMessage(TOPICS[GateState], 0, 0, data, '{"title": "GateState"}')
    assert encode(msgspec.convert(decode_message(logged), GateState)) == encode(state)
