"""The recorder's process as a program: writes the log of a drive. It may die without consequence for the drive.

`python -m drawbar.driving.recorder_main`, with its orders on standard input.
"""

import sys
from pathlib import Path

from drawbar.config import Configuration, load_configuration
from drawbar.driving.beat import Beat
from drawbar.driving.ending import Ending, told
from drawbar.driving.letters import Step, unpack
from drawbar.driving.mail import Mailbox
from drawbar.driving.orders import GATE, RECORDER, Orders
from drawbar.driving.place import local_frame
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
    orders = Orders.model_validate_json(sys.stdin.read())
    ending, healthy, clock = Ending(), True, orders.clock
    configuration = load_configuration(orders.configuration)
    live = _live(orders.live)
    if word := prefer(_NICENESS):
        say(f"recorder: {word}")
    with _log(configuration, orders, live) as log:
        mailbox = Mailbox(orders.socket(RECORDER))  # only now: whoever sees it may send, and nothing is lost
        beat = Beat(Role.RECORDER, mailbox, orders.socket(GATE))
        while not ending.asked or clock.wait([mailbox], 0.2):
            healthy = _take(mailbox, log, beat, clock) if healthy else _leave(mailbox)
            beat.pass_time(clock.nanoseconds(), healthy=healthy)
            clock.wait([mailbox], (beat.due - clock.nanoseconds()) * 1e-9)
    mailbox.close()
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


def _log(configuration: Configuration, orders: Orders, live: Live | None) -> DriveLog:
    path, drivable = build_path(configuration)
    frame = local_frame(configuration)
    header = run_header(configuration, path, drivable, seed=0, frame=frame)
    scene = Scene(path=path, vehicle=configuration.vehicle, frame=frame)
    return DriveLog(Path(orders.run) / LOG_NAME, header, scene, live, clock=orders.clock)


def _take(mailbox: Mailbox, log: DriveLog, beat: Beat, clock: MachineClock) -> bool:
    """Write what has arrived; return whether it could be written. Nothing is added behind what could not."""
    try:
        for data in mailbox.receive():
            _write(data, log, beat, clock)
        if clock.nanoseconds() - log.flushed >= _WITHOUT_STEPS:
            log.flush()
    except (OSError, DrawbarError) as error:
        log.give_up()
        say(f"recorder: the log cannot be written any further ({error}); what came before is kept")
        return False
    return True


def _leave(mailbox: Mailbox) -> bool:
    """Let go of what has arrived; return that it is not written."""
    for _ in mailbox.receive():
        pass
    return False


def _write(data: bytes, log: DriveLog, beat: Beat, clock: MachineClock) -> None:
    letter = unpack(data)
    if isinstance(letter, RawBytes):
        log.add_raw(letter)
    elif isinstance(letter, Order):
        log.add_order(letter)
    elif isinstance(letter, Step):
        log.add_step(letter.time, unpacked(letter.data))
    else:
        message = decode(data, *RECORDS.values())
        if isinstance(message, GateState):
            beat.state = message.state
        if isinstance(message, Message):
            log.add_message(message)
        elif isinstance(message, Flaw):
            log.add_event(clock.nanoseconds(), "warning", "recorder", f"a record was refused: {message.value}")


if __name__ == "__main__":
    sys.exit(told(main))
