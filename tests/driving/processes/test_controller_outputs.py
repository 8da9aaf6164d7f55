"""What the controller sends: repeated commands to the gate, and to the recorder only what they ask for anew."""

import socket
from dataclasses import replace
from types import SimpleNamespace

import pytest

from drawbar.driving.processes.controller_main import Outputs
from drawbar.messages import CommandMessage, Mode
from drawbar.messages.records import decode

COMMAND = CommandMessage(
    sequence=1, time=10, valid_until=20, mode=Mode.DRIVE, tractor_angle=0.1, trailer_angle=-0.1, speed=1.0
)


@pytest.fixture
def parts():
    """Outputs, the gate's end, and what the recorder is sent."""
    own, gate = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    recorded = []
    endpoint = SimpleNamespace(lost=0, send_queued=lambda place, data: recorded.append(decode(data, CommandMessage)))
    options = SimpleNamespace(socket=lambda name: name, clock=SimpleNamespace(nanoseconds=lambda: 0))
    yield Outputs(own, endpoint, options), gate, recorded
    own.close()
    gate.close()


def test_a_repeated_command_is_sent_and_recorded_once(parts):
    outputs, gate, recorded = parts
    repeated = [replace(COMMAND, sequence=k, time=10 * k, valid_until=20 * k) for k in (2, 3)]
    turned = replace(COMMAND, sequence=4, trailer_angle=-0.2)  # the joint is held where it is, and that has changed
    outputs.send(COMMAND)
    for each in (*repeated, turned, replace(turned, sequence=5)):
        outputs.send_again(each)
    outputs.send(replace(turned, sequence=6))  # a step's own
    assert [each.sequence for each in recorded] == [1, 4, 6]
    assert [decode(gate.recv(4096), CommandMessage).sequence for _ in range(6)] == [1, 2, 3, 4, 5, 6]


def test_the_first_repetition_is_recorded_where_nothing_was_before(parts):
    outputs, _, recorded = parts
    outputs.send_again(COMMAND)
    assert recorded == [COMMAND]
