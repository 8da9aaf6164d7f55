"""Check of a receiver: its make and version, its rate, its report, and whether the time stamps of two of them agree."""

import math
from collections.abc import Iterable

from drawbar.driving.preparation.finding import Finding, counted, poll_times, tell_silence
from drawbar.geometry import LocalFrame
from drawbar.machine.hardware.corrections.corrections import Corrections
from drawbar.machine.hardware.corrections.receivers import correct
from drawbar.machine.hardware.devices import DeviceSettings
from drawbar.machine.hardware.receiver import Receiver, ReceiverSettings
from drawbar.protocols.gnss.checks import resolution, too_slow
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.firmware import ASK_UBX, firmware
from drawbar.protocols.gnss.framing import Framer
from drawbar.protocols.gnss.messages import DAY
from drawbar.protocols.gnss.pairing import MOST_BEHIND
from drawbar.protocols.gnss.timing import difference
from drawbar.protocols.gnss.ubx import UBX
from drawbar.signals import FixQuality
from drawbar.transports.address import UdpAddress, parse_transport
from drawbar.transports.base import Received, Transport
from drawbar.transports.open import open_transport
from drawbar.transports.tapped import Direction, TappedTransport

_STATIONS = frozenset(range(1, 4096))
"""numbers of base stations; 0 is also sent where it is not known"""
_UBX_KINDS = frozenset(name for name, _, _ in UBX.values())


class _Versions:
    """Finds a receiver's make and version in its bytes, and asks a u-blox receiver for them once."""

    def __init__(self, transport: Transport) -> None:
        self.transport = TappedTransport(transport, self._receive)
        self.text = ""
        self.received = 0
        """bytes"""
        self._framer, self._asked = Framer(), False

    def _receive(self, direction: Direction, received: Received) -> None:
        if direction is Direction.IN:
            self.received += len(received.data)
            for frame in self._framer.push(received.data, received.time):
                self.text = firmware(frame) or self.text

    def ask(self, kinds: Iterable[str]) -> None:
        if not self._asked and not _UBX_KINDS.isdisjoint(kinds):
            self._asked = self.transport.write(ASK_UBX)


def check_receiver(
    name: str,
    settings: ReceiverSettings,
    frame: LocalFrame,
    seconds: float,
    sample_time: float,
    corrections: Corrections | None,
    *,
    oldest: float,
    alone: bool = False,
) -> Finding:
    """Return what a receiver reports.

    Args:
        name: of the finding.
        settings: of the receiver.
        frame: of the path.
        seconds: to listen.
        sample_time: of the controller, s.
        corrections: that it is sent meanwhile; None: it has its own.
        oldest: corrections with which to engage, s.
        alone: it is the only receiver, which has to report a heading.

    Raises:
        DrawbarError: its transport cannot be opened.
    """
    finding, epochs, versions = Finding(device=name), list[Epoch](), _Versions(open_transport(settings.transport))
    receiver = Receiver(versions.transport, settings)
    for now in poll_times(seconds, receiver.transport):
        epochs += receiver.poll(now)
        versions.ask(receiver.kinds)
        if corrections is not None:
            correct(corrections, now, receiver, [receiver])
    finding.received = bool(epochs)
    if not epochs:
        others = {"byte of messages without a position": versions.received} if versions.received else None
        tell_silence(finding, receiver.transport, receiver.dropped or others)
    else:
        finding.facts += [versions.text] if versions.text else []
        _describe(finding, epochs, frame, receiver, sample_time)
        finding.problems += _unfit(epochs[-1], oldest)
        if alone and not math.isfinite(epochs[-1].yaw):
            finding.problems.append(
                "it tells no heading, and the trailer has no receiver: let it send that of its two antennas, or wait "
                "until it is fixed"
            )
    receiver.close()
    return finding


def _describe(finding: Finding, epochs: list[Epoch], frame: LocalFrame, receiver: Receiver, sample_time: float) -> None:
    last = epochs[-1]
    finding.fixed = last.quality is FixQuality.FIXED
    finding.clock, finding.station = last.utc - last.received, last.station
    span = last.time - epochs[0].time
    rate = (len(epochs) - 1) / span if span > 0.0 else math.nan
    rate_text = f"{rate:.1f} Hz, " if math.isfinite(rate) else ""
    finding.facts.append(f"{rate_text}{', '.join(sorted(receiver.kinds))}")
    finding.problems += filter(None, [too_slow(rate, sample_time)])
    deviation = f", deviation {max(last.sigma_east, last.sigma_north):.3f} m" if last.has_fix else ""
    finding.facts.append(f"fix {last.quality.name.lower()}{deviation}")
    if math.isfinite(last.correction_age):
        source = f" of station {last.station}" if last.station in _STATIONS else ""
        finding.facts.append(f"corrections{source} {last.correction_age:.0f} s old")
    if math.isfinite(last.roll):
        finding.facts.append(f"roll {math.degrees(last.roll):.1f}°")
    if math.isfinite(last.yaw):
        finding.facts.append(f"heading {math.degrees(0.5 * math.pi - last.yaw) % 360.0:.1f}°")
    if math.isfinite(last.yaw_rate):
        finding.facts.append(f"yaw rate {math.degrees(last.yaw_rate):.1f}°/s")
    if last.has_fix:
        east, north = (float(each) for each in frame.east_north(last.latitude, last.longitude))
        finding.facts.append(f"{math.hypot(east, north):.1f} m from the origin of the path's frame")
    repeated = receiver.dropped["epoch repeated"]
    if repeated > len(epochs):
        finding.clock = math.nan  # it shows no other receiver's to be wrong
        finding.problems.append(
            f"its time stands still: it has repeated an epoch {repeated} times; switch it off and on, and see its own "
            "status if it does so again"
        )
    if receiver.dropped:
        finding.facts.append(f"dropped: {counted(receiver.dropped)}")


def _unfit(last: Epoch, oldest: float) -> list[str]:
    """Return why its last epoch is not one to engage with."""
    problems = []
    if last.quality is not FixQuality.FIXED:
        problems.append("no RTK fix: wait under open sky, check the corrections")
    if too_coarse := resolution(last):
        problems.append(too_coarse)
    if not math.isfinite(last.speed):
        problems.append("it reports no speed: let it send VTG or RMC (NMEA), PVT (UBX, SBF)")
    if not math.isfinite(last.correction_age):
        problems.append("it reports no age of its corrections: engaging needs it")
    elif last.correction_age > oldest:
        problems.append(
            f"its corrections are {last.correction_age:.0f} s old, and drawbar engages up to {oldest:g} s: check "
            "modem, caster and mount point"
        )
    return problems


def not_forwarded(settings: ReceiverSettings, devices: DeviceSettings) -> list[str]:
    """Report if a receiver on an AgOpenGPS board, which takes corrections at a UDP port of the board, is sent none."""
    corrections = devices.corrections
    if corrections is None or settings not in devices.receivers_on_boards:
        return []
    outlets = [parse_transport(each) for each in corrections.forward]
    peers = [each.peer[0] for each in outlets if isinstance(each, UdpAddress) and each.peer is not None]
    if any(host == settings.sender or host.endswith(".255") or not settings.sender for host in peers):
        return []
    return [
        "it is on an AgOpenGPS board, and gets none of the corrections: add "
        f'"udp://0.0.0.0:0?peer={settings.sender or "ADDRESS"}:2233" to devices.corrections.forward'
    ]


def other_time(tractor: Finding, trailer: Finding) -> list[str]:
    """Report if the time stamps of two receivers disagree, so that their epochs are never a pair."""
    apart = difference(trailer.clock % DAY, tractor.clock % DAY)
    if not abs(apart) > MOST_BEHIND:
        return []
    return [
        f"its time is {apart:+.1f} s from the tractor receiver's, and only epochs of one time are used: let both run "
        "until they know UTC and its leap seconds (up to 13 minutes)"
    ]


def other_station(tractor: Finding, trailer: Finding) -> list[str]:
    """Report if two receivers are corrected from different base stations."""
    stations = {tractor.station, trailer.station}
    if len(stations) == 1 or not stations <= _STATIONS:
        return []
    return [
        f"its corrections are of station {trailer.station}, the tractor receiver's of {tractor.station}: two bases may "
        "be decimetres apart, and then the vehicle is led beside its line: give both receivers the same corrections, "
        "unless your network numbers each connection"
    ]
