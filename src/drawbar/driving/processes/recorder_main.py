"""The recorder's process as a program: writes the log of a drive. It may die without consequence for the drive.

`python -m drawbar.driving.processes.recorder_main`, with its options on standard input.
"""

import sys
from pathlib import Path

from drawbar.config import Configuration, load_configuration
from drawbar.driving.devices.path_frame import local_frame
from drawbar.driving.messaging.datagrams import PackedStep, unpack
from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.heartbeat import HeartbeatSender
from drawbar.driving.messaging.process_options import GATE, RECORDER, ProcessOptions
from drawbar.driving.processes.shutdown import ShutdownRequest, run_program
from drawbar.errors import DrawbarError
from drawbar.message_records import Flaw, decode
from drawbar.messages import KINDS as RECORDS
from drawbar.messages import GateState, Message, Role
from drawbar.realtime import prefer, say
from drawbar.recording.drive_log import DriveLog
from drawbar.recording.drive_records import Order, RawBytes
from drawbar.recording.header import run_header
from drawbar.recording.live import Live
from drawbar.recording.log import LOG_NAME
from drawbar.recording.scene import Scene
from drawbar.simulation import build_path
from drawbar.step.layout import unpacked
from drawbar.transports.clock import MachineClock

_NICENESS = -10
"""of its scheduling: on a busy computer its share would be too small for what comes, and the log would lack it"""
_WITHOUT_STEPS = 500_000_000
"""after which what waits is written where no step comes, ns: each time costs some of the compression, and each step
writes all that came before it"""


def main() -> int:
    """Write until told to end."""
    options = ProcessOptions.model_validate_json(sys.stdin.read())
    shutdown, healthy, clock = ShutdownRequest(), True, options.clock
    configuration = load_configuration(options.configuration)
    live = _live(options.live)
    if word := prefer(_NICENESS):
        say(f"recorder: {word}")
    with _log(configuration, options, live) as log:
        endpoint = Endpoint(options.socket(RECORDER))  # only now: once it is there others send, and nothing is lost
        heartbeat = HeartbeatSender(Role.RECORDER, endpoint, options.socket(GATE))
        while not shutdown.asked or clock.wait([endpoint], 0.2):
            healthy = _write_all(endpoint, log, heartbeat, clock) if healthy else _discard(endpoint)
            heartbeat.pass_time(clock.nanoseconds(), healthy=healthy)
            clock.wait([endpoint], (heartbeat.due - clock.nanoseconds()) * 1e-9)
    endpoint.close()
    if live is not None:
        live.close()
    return 0


def _live(port: int | None) -> Live | None:
    """Return the server that shows it all; where it cannot be, that is said, and the log is written without it."""
    try:
        return None if port is None else Live(port)
    except DrawbarError as error:
        say(f"recorder: not live: {error}")
        return None


def _log(configuration: Configuration, options: ProcessOptions, live: Live | None) -> DriveLog:
    path, drivable = build_path(configuration)
    frame = local_frame(configuration)
    header = run_header(configuration, path, drivable, seed=0, frame=frame)
    scene = Scene(path=path, vehicle=configuration.vehicle, frame=frame)
    return DriveLog(Path(options.run) / LOG_NAME, header, scene, live, clock=options.clock)


def _write_all(endpoint: Endpoint, log: DriveLog, heartbeat: HeartbeatSender, clock: MachineClock) -> bool:
    """Write what has arrived; return whether it could be written. Nothing is added behind what could not."""
    try:
        for data in endpoint.receive():
            _write(data, log, heartbeat, clock)
        if clock.nanoseconds() - log.flushed >= _WITHOUT_STEPS:
            log.flush()
    except (OSError, DrawbarError) as error:
        log.give_up()
        say(f"recorder: the log cannot be written any further ({error}); what came before is kept")
        return False
    return True


def _discard(endpoint: Endpoint) -> bool:
    """Discard what has arrived; return that it is not written."""
    for _ in endpoint.receive():
        pass
    return False


def _write(data: bytes, log: DriveLog, heartbeat: HeartbeatSender, clock: MachineClock) -> None:
    content = unpack(data)
    if isinstance(content, RawBytes):
        log.add_raw(content)
    elif isinstance(content, Order):
        log.add_order(content)
    elif isinstance(content, PackedStep):
        log.add_step(content.time, unpacked(content.data))
    else:
        message = decode(data, *RECORDS.values())
        if isinstance(message, GateState):
            heartbeat.state = message.state
        if isinstance(message, Message):
            log.add_message(message)
        elif isinstance(message, Flaw):
            log.add_event(clock.nanoseconds(), "warning", "recorder", f"a record was refused: {message.value}")


if __name__ == "__main__":
    sys.exit(run_program(main))
