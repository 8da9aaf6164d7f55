"""Check: listens to every device of a configuration for a few seconds, and says what was heard and what is missing.

Nothing is moved: boards are asked where they are, boards and valves told that nobody steers, which makes boards answer.
"""

import math
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from drawbar.driving.actuators import isobus_wire
from drawbar.geometry import LocalFrame
from drawbar.machine.hardware.bare_valve_settings import BareValveSettings
from drawbar.machine.hardware.board_scan import BoardScan
from drawbar.machine.hardware.corrections.corrections import Corrections, open_corrections
from drawbar.machine.hardware.corrections.receivers import correct
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.isobus import IsobusSettings
from drawbar.machine.hardware.receiver import Receiver, ReceiverSettings
from drawbar.machine.hardware.sensor_line import SensorBoardSettings, SensorLine
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.protocols.actuator import Readiness, SteeringRequest
from drawbar.protocols.agopengps.frame import STEER_BOARD
from drawbar.protocols.agopengps.network import ScanReply
from drawbar.protocols.bare_valve import ValveBoard
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.firmware import ASK_UBX, firmware
from drawbar.protocols.gnss.framing import Framer
from drawbar.protocols.gnss.ubx import UBX
from drawbar.protocols.sensors import SensorFault
from drawbar.protocols.speed_actuator import SpeedRequest
from drawbar.safety.wires import Wires
from drawbar.signals import FixQuality
from drawbar.transports.base import Received, Transport
from drawbar.transports.open import open_transport
from drawbar.transports.tapped import Direction, TappedTransport

_SLOW = 1.0
"""limit of the speed, of which none is asked for, m/s"""
_LOOK = 0.02
"""between two looks at a device, s"""
_TICK = 0.1
"""between two words to a board, s"""
_SCAN = 1.0
"""for which answers to a scan are waited for, s"""
_ASK_AGAIN = 0.4
"""between two scans, s"""
_ENOUGH = 0.95
"""of the epochs that the controller takes"""
_UBX_KINDS = frozenset(name for name, _, _ in UBX.values())
_OFF = SteeringRequest(steer=False, angle=0.0, speed=0.0)
_STOP = SpeedRequest(drive=False, speed=0.0, deceleration=1.0)


@dataclass(slots=True, kw_only=True)
class Finding:
    """What was found out about one device."""

    device: str
    heard: bool = False
    facts: list[str] = field(default_factory=list)
    """what it said"""
    problems: list[str] = field(default_factory=list)
    """what is missing, each with what to do"""


def check(devices: DeviceSettings, frame: LocalFrame, seconds: float, sample_time: float) -> Iterator[Finding]:
    """Yield what was found out about each device.

    Args:
        devices: of the configuration.
        frame: of the path.
        seconds: to listen to each device.
        sample_time: of the controller, s.

    Raises:
        DrawbarError: a transport cannot be opened.
    """
    corrections = open_corrections(devices.corrections) if devices.corrections is not None else None
    yield _receiver("tractor receiver", devices.tractor_receiver, frame, seconds, sample_time, corrections)
    yield _receiver("trailer receiver", devices.trailer_receiver, frame, seconds, sample_time, corrections)
    boards = {"tractor board": devices.tractor_board, "trailer board": devices.trailer_board}
    yield from _boards({name: board for name, board in boards.items() if board is not None}, seconds)
    if devices.isobus is not None:
        yield from _isobus(devices.isobus, seconds, drives=devices.speed == "isobus")
    if devices.sensors is not None:
        yield _sensors(devices.sensors, seconds)
    if devices.bare_valve is not None:
        yield _bare_valve(devices.bare_valve, seconds)
    if corrections is not None:
        for now in looks(seconds):
            corrections.advance(now)
        status = corrections.status(time.monotonic())
        corrections.close()
        problems = [status.message] if status.message else []
        facts = [f"RTCM {', '.join(map(str, sorted(status.types)))}"] if status.types else []
        yield Finding(device="corrections", heard=bool(status.types), facts=facts, problems=problems)


def looks(seconds: float) -> Iterator[float]:
    """Yield monotonic times, s, for so long."""
    end = time.monotonic() + seconds
    while (now := time.monotonic()) < end:
        yield now
        time.sleep(_LOOK)


def _silent(finding: Finding, transport: Transport) -> None:
    why = f" ({transport.trouble})" if transport.trouble else ""
    finding.problems.append(f"nothing was heard{why}: check its power, its cable and its transport")


class _Versions:
    """Hears a receiver's make and version among its bytes, and asks a u-blox receiver for them once."""

    def __init__(self, transport: Transport) -> None:
        self.transport = TappedTransport(transport, self._hear)
        self.told = ""
        self._framer, self._asked = Framer(), False

    def _hear(self, direction: Direction, received: Received) -> None:
        if direction is Direction.IN:
            for frame in self._framer.push(received.data, received.time):
                self.told = firmware(frame) or self.told

    def ask(self, kinds: Iterable[str]) -> None:
        if not self._asked and not _UBX_KINDS.isdisjoint(kinds):
            self._asked = self.transport.write(ASK_UBX)


def _receiver(
    name: str,
    settings: ReceiverSettings,
    frame: LocalFrame,
    seconds: float,
    sample_time: float,
    corrections: Corrections | None,
) -> Finding:
    finding, epochs, versions = Finding(device=name), list[Epoch](), _Versions(open_transport(settings.transport))
    receiver = Receiver(versions.transport, settings)
    for now in looks(seconds):
        epochs += receiver.poll(now)
        versions.ask(receiver.kinds)
        if corrections is not None:
            correct(corrections, now, receiver, [receiver])
    finding.heard = bool(epochs)
    if not epochs:
        _silent(finding, receiver.transport)
    else:
        finding.facts += [versions.told] if versions.told else []
        _describe(finding, epochs, frame, receiver, sample_time)
    receiver.close()
    return finding


def _describe(finding: Finding, epochs: list[Epoch], frame: LocalFrame, receiver: Receiver, sample_time: float) -> None:
    last = epochs[-1]
    span = last.time - epochs[0].time
    rate = (len(epochs) - 1) / span if span > 0.0 else math.nan
    told = f"{rate:.1f} Hz, " if math.isfinite(rate) else ""
    finding.facts.append(f"{told}{', '.join(sorted(receiver.kinds))}")
    if rate < _ENOUGH / sample_time:
        needed = f"{1.0 / sample_time:g}"
        finding.problems.append(
            f"it sends {rate:.1f} epochs a second, the controller takes {needed}: set it to {needed} Hz"
        )
    finding.facts.append(f"fix {last.quality.name.lower()}, deviation {max(last.sigma_east, last.sigma_north):.3f} m")
    if math.isfinite(last.correction_age):
        finding.facts.append(f"corrections {last.correction_age:.0f} s old")
    if math.isfinite(last.roll):
        finding.facts.append(f"roll {math.degrees(last.roll):.1f}°")
    if math.isfinite(last.yaw_rate):
        finding.facts.append(f"yaw rate {math.degrees(last.yaw_rate):.1f}°/s")
    if last.has_fix:
        east, north = (float(each) for each in frame.east_north(last.latitude, last.longitude))
        finding.facts.append(f"{math.hypot(east, north):.1f} m from the origin of the path's frame")
    if receiver.dropped:
        finding.facts.append("dropped: " + ", ".join(f"{count} {kind}" for kind, count in receiver.dropped.items()))
    if last.quality is not FixQuality.FIXED:
        finding.problems.append("no RTK fix: wait under open sky, check the corrections")
    if not math.isfinite(last.speed):
        finding.problems.append("it reports no speed: let it send VTG or RMC (NMEA), PVT (UBX, SBF)")
    if not math.isfinite(last.correction_age):
        finding.problems.append("it reports no age of its corrections: engaging needs it")


def _boards(boards: dict[str, SteerBoardSettings], seconds: float) -> Iterator[Finding]:
    """Ask all boards where they are, then listen to those that the configuration names."""
    found = _scan(list(boards.values()), min(seconds, _SCAN))
    named = {source for board in boards.values() for source in found if board.actuator().is_board(source)}
    strangers = {source: reply for source, reply in found.items() if source not in named}
    for name, board in boards.items():
        finding = listen_to_board(name, board, seconds)
        answers = [reply for source, reply in found.items() if board.actuator().is_board(source)]
        finding.facts += [f"scan: {reply.kind} {reply.address}" for reply in answers]
        finding.problems += [_elsewhere(reply) for reply in answers if not reply.address.startswith(f"{reply.subnet}.")]
        if not finding.heard:
            finding.problems += [_perhaps(reply) for reply in strangers.values() if reply.board == STEER_BOARD]
        yield finding
    if strangers:
        facts = [f"{reply.kind} {reply.address}" for reply in strangers.values()]
        yield Finding(device="other boards that answer the scan", heard=True, facts=sorted(facts))


def _scan(boards: list[SteerBoardSettings], seconds: float) -> dict[str, ScanReply]:
    """Return what boards answer to the question where they are, by their `address:port`."""
    found: dict[str, ScanReply] = {}
    for listen in {board.listening for board in boards}:
        scan = BoardScan(listen, [board.destination for board in boards if board.listening == listen])
        asked = 0.0
        for now in looks(seconds):
            if now - asked >= _ASK_AGAIN:
                asked = now
                scan.ask()
            scan.poll()
        scan.close()
        found |= scan.found
    return found


def _elsewhere(reply: ScanReply) -> str:
    network = reply.address.rpartition(".")[0]
    return (
        f"it has the address {reply.address} and hears this computer from {reply.subnet}.*: give this computer's "
        f"network card an address in {network}.*"
    )


def _perhaps(reply: ScanReply) -> str:
    return f"a steer board answers the scan from {reply.address}: if it is this one, write that as its address"


def listen_to_board(name: str, settings: SteerBoardSettings, seconds: float) -> Finding:
    """Return what a board says that is told for so many seconds that nobody steers."""
    finding, board = Finding(device=name), settings.actuator()
    transport, tick = open_transport(settings.transport), 0.0
    for now in looks(seconds):
        for received in transport.read():
            board.receive(received.time, received.data, received.source)
        if now >= tick:
            tick = now + _TICK
            for frame in board.send(now, _OFF):
                transport.write(frame)
    report = board.report(time.monotonic())
    finding.heard = math.isfinite(report.angle_time)
    if finding.heard:
        finding.facts.append(f"angle {math.degrees(report.angle):.1f}°, {report.readiness.name.lower()}")
    else:
        _silent(finding, transport)
    if finding.heard and report.readiness.name != "READY":
        finding.problems.append(report.readiness.value)
    transport.close()
    return finding


def _isobus(settings: IsobusSettings, seconds: float, *, drives: bool) -> Iterator[Finding]:
    """Claim an address, say that nothing is intended, and listen to the valves and to the tractor."""
    wire, now, tick = isobus_wire(settings, _SLOW if drives else None), 0.0, 0.0
    wires = Wires([wire])
    for now in looks(seconds):
        wires.receive()
        if now >= tick:
            tick = now + _TICK / 2.0
            wires.send(now, (_OFF, _OFF), _STOP)
    if wire.transport.trouble:
        problem = f"{wire.transport.trouble}: check the adapter, its bit rate and that its interface is up"
        yield Finding(device="ISOBUS", problems=[problem])
    for name, report in zip(("tractor valve", "trailer valve"), wires.steering(now), strict=True):
        if report is not None:
            angle = [f"angle {math.degrees(report.angle):.1f}°"] if math.isfinite(report.angle) else []
            yield _on_the_bus(name, report.readiness, angle)
    speed = wires.speed(now)
    if speed is not None:
        yield _on_the_bus("tractor's speed", speed.readiness, [])
    wires.close()


def _on_the_bus(name: str, readiness: Readiness, facts: list[str]) -> Finding:
    ready = readiness is Readiness.READY
    heard = readiness not in (Readiness.SILENT, Readiness.ADDRESS_LOST)
    return Finding(
        device=name,
        heard=heard,
        facts=[*facts, readiness.name.lower()] if heard else [],
        problems=[] if ready else [readiness.value],
    )


def _sensors(settings: SensorBoardSettings, seconds: float) -> Finding:
    finding, line = Finding(device="sensor board"), SensorLine(open_transport(settings.transport), settings)
    for _ in looks(seconds):
        line.poll()
    report = line.last
    finding.heard = math.isfinite(report.time)
    if not finding.heard:
        _silent(finding, line.transport)
    if math.isfinite(report.hitch_angle):
        finding.facts.append(f"hitch angle {math.degrees(report.hitch_angle):.1f}°")
    if math.isfinite(report.wheel_speed):
        finding.facts.append(f"wheels {report.wheel_speed:.2f} m/s")
    finding.problems += [f"{count} readings: {fault}" for fault, count in line.board.faults.items()]
    line.close()
    return finding


def _bare_valve(settings: BareValveSettings, seconds: float) -> Finding:
    finding, transport, board = Finding(device="bare valve"), open_transport(settings.transport), ValveBoard()
    reports = [
        report
        for _ in looks(seconds)
        for received in transport.read()
        for report in board.push(received.data, received.time)
    ]
    finding.heard = bool(reports)
    if not reports:
        _silent(finding, transport)
    else:
        reading = settings.sensor().read(reports[-1].counts)
        finding.facts.append(f"angle {math.degrees(reading.value):.1f}°")
        finding.facts.append(f"switch {'held' if reports[-1].permitted else 'let go'}")
        if reading.fault is not SensorFault.NONE:
            finding.problems.append(f"the angle sensor {reading.fault.value}")
    transport.close()
    return finding
