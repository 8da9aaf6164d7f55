"""A rehearsal that writes the log of a drive, with what a replay from raw bytes needs."""

from contextlib import contextmanager

from drawbar.driving.stand_in.rehearsal import Rehearsal
from drawbar.geometry import LocalFrame
from drawbar.machine.stand_in.machine import SENSORS
from drawbar.messages import KINDS
from drawbar.messages.records import decode, encode
from drawbar.recording.drive_log import DriveLog
from drawbar.recording.drive_records import Happening, Kind, Order, RawBytes
from drawbar.recording.header import run_header
from drawbar.recording.scene import Scene
from drawbar.simulation import build_path
from drawbar.transports.tapped import Direction

FRAME = LocalFrame(latitude=50.87, longitude=4.7)
"""where a rehearsal is on Earth"""


@contextmanager
def recorded_rehearsal(configuration, file, seed, *, shadow=False):
    """Yield a rehearsal of a configuration with devices, and the list of its commands; all is written into a file."""
    path, drivable = build_path(configuration)
    rehearsal, commands = Rehearsal(configuration, path, seed, configuration.safety, shadow=shadow), []
    header = run_header(configuration, path, drivable, seed=seed, frame=FRAME, shadow=shadow)
    with DriveLog(file, header, Scene(path=path, vehicle=configuration.vehicle, frame=FRAME)) as log:
        _record_inputs(rehearsal, log)
        _record_controller(rehearsal, log, commands)
        yield rehearsal, commands


def _note(rehearsal, log, kind, sequence):
    log.add_order(Order((Happening(kind=kind, time=rehearsal.now, sequence=sequence),)))


def _record_inputs(rehearsal, log):
    """Record the bytes that arrive, the looks at them, and what is found."""
    receive, poll, arrived = rehearsal._receive, rehearsal._navigation.poll, []

    def receive_recorded(line):
        device, into = line if line == SENSORS else f"{line}_receiver", receive(line)

        def take(data):
            log.add_raw(RawBytes(device=device, time=rehearsal.now, direction=Direction.IN, data=data))
            arrived.append(data)
            into(data)

        return take

    def poll_recorded(now):
        _note(rehearsal, log, Kind.LOOK, len(arrived))
        arrived.clear()
        found = poll(now)
        for fixes in found:
            log.add_message(fixes)
        return found

    rehearsal._receive, rehearsal._navigation.poll = receive_recorded, poll_recorded


def _record_controller(rehearsal, log, commands):
    """Record what the controller takes in, what it sends, and its steps."""
    loop, send, record, receive = (
        rehearsal.loop,
        rehearsal.loop._send,
        rehearsal.loop._record,
        rehearsal.loop.receive_gate,
    )

    def send_recorded(message):
        log.add_message(decode(encode(message), *KINDS.values()))  # as the recorder hears it
        commands.append(message)
        send(message)

    def record_recorded(step):
        log.add_step(rehearsal.now, step)
        log.flush()
        record(step)

    def receive_recorded(state):
        log.add_message(state)
        receive(state)

    loop._tell = lambda kind, sequence: _note(rehearsal, log, kind, sequence)
    loop._send, loop._record, loop.receive_gate = send_recorded, record_recorded, receive_recorded
