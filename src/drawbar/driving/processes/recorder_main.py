"""The recorder's process as a program: writes the log of a drive. It may die without consequence for the drive.

`python -m drawbar.driving.processes.recorder_main`, with its options on standard input.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

from drawbar.config import Configuration, load_configuration
from drawbar.driving.devices.path_frame import local_frame
from drawbar.driving.messaging.datagrams import PackedStep, unpack
from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.heartbeat import HeartbeatSender
from drawbar.driving.messaging.process_options import GATE, RECORDER, ProcessOptions
from drawbar.driving.processes.background_writer import BackgroundWriter, Content
from drawbar.driving.processes.shutdown import ShutdownRequest, run_program
from drawbar.errors import DrawbarError
from drawbar.messages import KINDS as RECORDS
from drawbar.messages import GateState, Role
from drawbar.messages.records import decode
from drawbar.realtime import prefer, say
from drawbar.recording.drive_log import DriveLog
from drawbar.recording.drive_records import Order, RawBytes
from drawbar.recording.header import run_header
from drawbar.recording.live import Live
from drawbar.recording.log import LOG_NAME
from drawbar.recording.scene import Scene, tube_reach
from drawbar.simulation import build_path
from drawbar.step.build import build_tubes

_NICENESS = -10
"""of its scheduling: on a busy computer its share would be too small for what comes, and the log would lack it"""


def main() -> int:
    """Write until told to end."""
    options = ProcessOptions.model_validate_json(sys.stdin.buffer.read())
    shutdown, clock = ShutdownRequest(), options.clock
    configuration = load_configuration(options.configuration)
    live = _live(options.live)
    if word := prefer(_NICENESS):
        say(f"recorder: {word}")
    with _log(configuration, options, live) as log:
        endpoint = Endpoint(options.socket(RECORDER))  # only now: once it is there others send, and nothing is lost
        heartbeat = HeartbeatSender(Role.RECORDER, endpoint, options.socket(GATE))
        writer = BackgroundWriter(log, clock.nanoseconds)
        while not shutdown.asked or clock.wait([endpoint], 0.2):
            writer.put(list(_contents(endpoint, heartbeat)))
            heartbeat.pass_time(clock.nanoseconds(), healthy=writer.writes)
            clock.wait([endpoint], (heartbeat.due - clock.nanoseconds()) * 1e-9)
        writer.close()
    endpoint.close()
    if live is not None:
        live.close()
    return 0


def _live(port: int | None) -> Live | None:
    """Return the server that shows it all; where it cannot start, print why: the log is written without it."""
    try:
        return None if port is None else Live(port)
    except DrawbarError as error:
        say(f"recorder: not live: {error}")
        return None


def _log(configuration: Configuration, options: ProcessOptions, live: Live | None) -> DriveLog:
    path, drivable = build_path(configuration)
    frame = local_frame(configuration)
    header = run_header(configuration, path, drivable, seed=0, frame=frame, shadow=options.shadow)
    reach = tube_reach(build_tubes(configuration), configuration.vehicle)
    scene = Scene(path=path, vehicle=configuration.vehicle, frame=frame, reach=reach)
    return DriveLog(Path(options.run) / LOG_NAME, header, scene, live, clock=options.clock)


def _contents(endpoint: Endpoint, heartbeat: HeartbeatSender) -> Iterator[tuple[Content, int]]:
    """Yield what has arrived, with its size, bytes; pass the gate's states to the heartbeat."""
    for data in endpoint.receive():
        content = unpack(data)
        if isinstance(content, RawBytes | Order | PackedStep):
            yield content, len(data)
            continue
        message = decode(data, *RECORDS.values())
        if isinstance(message, GateState):
            heartbeat.state = message.state
        yield message, len(data)


if __name__ == "__main__":
    sys.exit(run_program(main))
