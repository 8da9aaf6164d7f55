"""Check: listens to every device of a configuration for a few seconds, and reports what comes and what is missing.

Nothing is moved: boards are scanned for, and boards and valves are sent "not steering", which makes boards answer.
"""

import math
import time
from collections.abc import Callable, Iterator
from functools import partial

from drawbar.driving.devices.actuators import board_wires
from drawbar.driving.preparation.check_isobus import check_isobus
from drawbar.driving.preparation.check_receiver import check_receiver, not_forwarded, other_station, other_time
from drawbar.driving.preparation.finding import MOST_SWINGS, OFF, STOP, Finding, finding_of, poll_times, tell_silence
from drawbar.errors import HardwareError
from drawbar.geometry import LocalFrame
from drawbar.machine.hardware.bare_valve_settings import BareValveSettings
from drawbar.machine.hardware.board_scan import BoardScan
from drawbar.machine.hardware.corrections.corrections import Corrections, open_corrections
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.receiver import ReceiverSettings
from drawbar.machine.hardware.sensor_line import SensorBoardSettings, SensorLine
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.protocols.actuator import Readiness, SteeringActuator, SteeringReport
from drawbar.protocols.agopengps.board_replies import LARGEST_ANGLE
from drawbar.protocols.agopengps.frame import STEER_BOARD
from drawbar.protocols.agopengps.network import ScanReply
from drawbar.protocols.agopengps.steer_board import SteerBoard
from drawbar.protocols.bare_valve import ValveBoard
from drawbar.protocols.sensors import SensorFault
from drawbar.safety.wires import Wires
from drawbar.transports.base import Transport
from drawbar.transports.open import open_transport

_TICK = 0.1
"""between two words to a board, s"""
_SCAN = 1.0
"""for which answers to a scan are waited for, s"""
_ASK_AGAIN = 0.4
"""between two scans, s"""


def check(
    devices: DeviceSettings, frame: LocalFrame, seconds: float, sample_time: float, *, oldest: float
) -> Iterator[Finding]:
    """Yield what was found out about each device.

    Args:
        devices: of the configuration.
        frame: of the path.
        seconds: to listen to each device.
        sample_time: of the controller, s.
        oldest: corrections with which to engage, s.

    A device whose port is taken, or whose recording cannot be read, is a finding, and the others are listened to.

    Raises:
        ConfigurationError: the login of the corrections cannot be had.
    """
    corrections = open_corrections(devices.corrections) if devices.corrections is not None else None
    listen = partial(
        check_receiver,
        frame=frame,
        seconds=seconds,
        sample_time=sample_time,
        corrections=corrections,
        oldest=oldest,
        alone=devices.trailer_receiver is None,
    )
    yield from _receivers(devices, listen)
    boards = {"tractor board": devices.tractor_board, "trailer board": devices.trailer_board}
    yield from _boards({name: board for name, board in boards.items() if board is not None}, seconds)
    if devices.isobus is not None:
        yield from check_isobus(devices.isobus, seconds, drives=devices.speed == "isobus")
    if devices.sensors is not None:
        yield finding_of("sensor board", partial(_sensors, devices.sensors, seconds))
    if devices.bare_valve is not None:
        yield finding_of("bare valve", partial(_bare_valve, devices.bare_valve, seconds))
    if corrections is not None:
        yield _corrections(corrections, seconds)


def _receivers(devices: DeviceSettings, listen: Callable[..., Finding]) -> Iterator[Finding]:
    """Listen to the receivers one after the other, and compare the second with the first."""
    first = _receiver("tractor receiver", devices.tractor_receiver, devices, listen)
    yield first
    if devices.trailer_receiver is not None:
        second = _receiver("trailer receiver", devices.trailer_receiver, devices, listen)
        second.problems += other_time(first, second) + other_station(first, second)
        yield second


def _receiver(
    name: str, settings: ReceiverSettings, devices: DeviceSettings, listen: Callable[..., Finding]
) -> Finding:
    finding = finding_of(name, partial(listen, name, settings))
    if finding.received and not finding.fixed:
        finding.problems += not_forwarded(settings, devices)
    return finding


def _corrections(corrections: Corrections, seconds: float) -> Finding:
    """Receive corrections for so many seconds more, and close them."""
    for now in poll_times(seconds):
        corrections.advance(now)
    status = corrections.status(time.monotonic())
    corrections.close()
    problems = [status.message] if status.message else []
    facts = [f"RTCM {', '.join(map(str, sorted(status.types)))}"] if status.types else []
    return Finding(device="corrections", received=bool(status.types), facts=facts, problems=problems)


def _boards(boards: dict[str, SteerBoardSettings], seconds: float) -> Iterator[Finding]:
    """Ask all boards where they are, then listen to those that the configuration names."""
    replies = _scan(list(boards.values()), min(seconds, _SCAN))
    named = {source for board in boards.values() for source in replies if board.actuator().is_board(source)}
    strangers = {source: reply for source, reply in replies.items() if source not in named}
    for name, board in boards.items():
        finding = finding_of(name, partial(listen_to_board, name, board, seconds))
        answers = [reply for source, reply in replies.items() if board.actuator().is_board(source)]
        finding.facts += [f"scan: {reply.kind} {reply.address}" for reply in answers]
        finding.problems += [_elsewhere(reply) for reply in answers if not reply.address.startswith(f"{reply.subnet}.")]
        if not finding.received:
            finding.problems += [_perhaps(reply) for reply in strangers.values() if reply.board == STEER_BOARD]
        yield finding
    if strangers:
        facts = [f"{reply.kind} {reply.address}" for reply in strangers.values()]
        yield Finding(device="other boards that answer the scan", received=True, facts=sorted(facts))


def _scan(boards: list[SteerBoardSettings], seconds: float) -> dict[str, ScanReply]:
    """Return what boards answer to the question where they are, by their `address:port`; nothing at a taken port."""
    replies: dict[str, ScanReply] = {}
    for listen in {board.listening for board in boards}:
        try:
            scan = BoardScan(listen, [board.destination for board in boards if board.listening == listen])
        except HardwareError:  # listening to the boards themselves shows why
            continue
        asked = 0.0
        for now in poll_times(seconds):
            if now - asked >= _ASK_AGAIN:
                asked = now
                scan.ask()
            scan.poll()
        scan.close()
        replies |= scan.found
    return replies


def _elsewhere(reply: ScanReply) -> str:
    network = reply.address.rpartition(".")[0]
    return (
        f"it has the address {reply.address} and hears this computer from {reply.subnet}.*: give this computer's "
        f"network card an address in {network}.*"
    )


def _perhaps(reply: ScanReply) -> str:
    return f"a steer board answers the scan from {reply.address}: if it is this one, write that as its address"


def listen_to_board(name: str, settings: SteerBoardSettings, seconds: float) -> Finding:
    """Return what a board reports that is sent "not steering" for so many seconds."""
    finding, report, tick, looked = Finding(device=name), SteeringReport(), 0.0, 0.0
    (wire,) = board_wires({"tractor": settings})
    wires, transport = Wires([wire]), wire.transport
    assert isinstance(transport, Transport)
    for now in poll_times(seconds):
        wires.receive()
        # after a pause of a busy computer the board seems silent, which was asked nothing meanwhile
        if now - looked <= _TICK or not math.isfinite(report.angle_time):
            report = wires.steering(now)[0] or report
        looked = now
        if now >= tick:
            tick = now + _TICK
            wires.send(now, (OFF, OFF), STOP)
    finding.received = math.isfinite(report.angle_time)
    if finding.received:
        finding.facts.append(f"angle {math.degrees(report.angle):.1f}°, {report.readiness.name.lower()}")
    else:
        tell_silence(finding, transport)
    if finding.received:
        finding.problems += _unfit(report, wire.tractor)
    elif report.readiness is Readiness.OTHER_MASTER:
        finding.problems.append(report.readiness.value)
    wires.close()
    return finding


def _unfit(report: SteeringReport, board: SteeringActuator[bytes] | None) -> list[str]:
    """Return why a board that reports cannot steer."""
    assert isinstance(board, SteerBoard)
    if board.swings > MOST_SWINGS:
        return [
            f"its angle jumped away and back {board.swings} times: two boards answer from its address (leave one on "
            "and check again: each needs a network of its own), or its sensor has a loose contact"
        ]
    if report.readiness is not Readiness.FAULT:
        return [] if report.readiness is Readiness.READY else [report.readiness.value]
    if abs(report.angle) < LARGEST_ANGLE:
        return ["its angle has jumped by more than 5°: check its sensor for a loose contact"]
    return [
        f"its sensor measures {math.degrees(report.angle):.1f}°, more than a wheel turns: check for a broken or "
        "shorted cable, then calibrate it"
    ]


def _sensors(settings: SensorBoardSettings, seconds: float) -> Finding:
    finding, line = Finding(device="sensor board"), SensorLine(open_transport(settings.transport), settings)
    for _ in poll_times(seconds):
        line.poll()
    report = line.last
    finding.received = math.isfinite(report.time)
    if not finding.received:
        tell_silence(finding, line.transport, line.board.dropped)
    faults = line.board.faults
    for name, shown, is_configured, value in (
        ("hitch", f"hitch angle {math.degrees(report.hitch_angle):.1f}°", settings.measures_hitch, report.hitch_angle),
        ("wheel", f"wheels {report.wheel_speed:.2f} m/s", settings.pulses_per_metre is not None, report.wheel_speed),
    ):
        if math.isfinite(value):
            finding.facts.append(shown)
        elif finding.received and is_configured and not any(fault.startswith(name) for fault in faults):
            finding.problems.append(f"it sends nothing of the {name} sensor: check that the board is set up to read it")
    finding.problems += [f"{fault} (readings: {count})" for fault, count in faults.items()]
    line.close()
    return finding


def _bare_valve(settings: BareValveSettings, seconds: float) -> Finding:
    finding, transport, board = Finding(device="bare valve"), open_transport(settings.transport), ValveBoard()
    reports = [
        report
        for _ in poll_times(seconds)
        for received in transport.read()
        for report in board.push(received.data, received.time)
    ]
    finding.received = bool(reports)
    if not reports:
        tell_silence(finding, transport, board.dropped)
    else:
        reading = settings.sensor().read(reports[-1].counts)
        finding.facts.append(f"angle {math.degrees(reading.value):.1f}°")
        finding.facts.append(f"switch {'held' if reports[-1].permitted else 'released'}")
        if reading.fault is not SensorFault.NONE:
            finding.problems.append(f"the angle sensor {reading.fault.value}")
    transport.close()
    return finding
