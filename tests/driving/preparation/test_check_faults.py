"""What `drawbar check` says of each fault of wiring and set-up: the table of docs/faults.md; `pytest -s` prints it."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from drawbar.config import load_configuration
from drawbar.driving.preparation import check, check_receiver
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.driving.stand_in.memory_transports import MemoryTransport
from drawbar.driving.stand_in.stand_in_machine import stand_in_machine
from drawbar.machine.stand_in.breaking import measure_otherwise, report_otherwise, send_otherwise
from drawbar.machine.stand_in.faults import FAULTS
from drawbar.machine.stand_in.machine import SENSORS, StandInMachine
from drawbar.machine.stand_in.nmea import sentence
from drawbar.protocols.actuator import SteeringRequest
from drawbar.protocols.agopengps.steer_board import SteerBoard
from drawbar.safety.wires import Wire
from drawbar.signals import FixQuality
from drawbar.simulation import build_path
from drawbar.vehicle.parameters import BODIES

LOOK, SECONDS = 0.02, 3.0
PAGE = Path(__file__).parents[3] / "docs" / "faults.md"


class Yard:
    """A stand-in machine whose wires are memory; it moves on at each look of the check."""

    def __init__(self, monkeypatch):
        configuration = with_stand_ins(load_configuration("articulated"))
        self.devices, frame = configuration.devices, configuration.devices.origin.frame()
        self.frame, self.now, self.agio = frame, 0.0, False
        path, _ = build_path(configuration)
        self.machine: StandInMachine = stand_in_machine(configuration, path, frame, 0)
        receivers = (self.devices.tractor_receiver, self.devices.trailer_receiver)
        names = {each.transport: body for body, each in zip(BODIES, receivers, strict=True)}
        names[self.devices.sensors.transport] = SENSORS
        self.lines = {name: MemoryTransport() for name in names.values()}
        self.wires = {body: MemoryTransport() for body in BODIES}
        for module in (check, check_receiver):
            monkeypatch.setattr(module, "poll_times", self._looks)
            monkeypatch.setattr(module, "open_transport", lambda address: self.lines[names[address]])
        monkeypatch.setattr(check, "board_wires", self._wire)
        monkeypatch.setattr(check, "_scan", lambda *_: {})

    def _wire(self, boards):
        (settings,) = boards.values()
        body = "tractor" if settings == self.devices.tractor_board else "trailer"
        board = SteerBoard(board=f"192.168.{5 + BODIES.index(body)}.126", max_angle=0.7)
        return [Wire(transport=self.wires[body], tractor=board)]

    def _looks(self, seconds, *_):
        for _ in range(round(seconds / LOOK)):
            self.now += LOOK
            streamed, sent = self.machine.advance(self.now)
            for line, data in streamed:
                self.lines[line].arrive(self.now, data)
            for body, wire in self.wires.items():
                for frame in wire.sent:
                    sent += self.machine.receive(self.now, body, frame, 9999)
                wire.sent.clear()
            for body, output in sent:
                self._arrive(body, output.data, f"192.168.{5 + BODIES.index(body)}.126:8888")
            if self.agio:
                self._arrive("tractor", MASTER, "192.168.5.10:9999")
            yield self.now

    def _arrive(self, body, data, sender):
        self.wires[body].arrive(self.now, data, sender)

    def findings(self):
        """Return what is found of each device, from the time on when everything has been heard."""
        found = check.check(self.devices, self.frame, SECONDS, 0.2, oldest=5.0)
        return {each.device: each for each in found}


MASTER = SteerBoard(board="192.168.5.126", max_angle=0.7).send(0.0, SteeringRequest(steer=False, angle=0.0, speed=0.0))[
    0
]
GSV = sentence("GPGSV,1,1,01,01,40,083,46")


def begin(name):
    return lambda yard: FAULTS[name].begin(yard.machine)


def say(change, bodies=BODIES[:1]):
    return lambda yard: report_otherwise(yard.machine, lambda report, since: change(report), bodies)


def send(change):
    return lambda yard: send_otherwise(yard.machine, change, BODIES[:1])


def hitch(counts):
    return lambda yard: setattr(yard.machine, "hitch_counts", lambda right: counts)


def slow(yard):
    yard.machine._settings = replace(yard.machine._settings, epochs=1.0)


def garble(yard):
    sense = yard.lines[SENSORS].arrive
    yard.lines[SENSORS].arrive = lambda now, data: sense(now, bytes(each | 0x80 for each in data))


CASES = {
    "nothing": ("", lambda yard: None, ""),
    "a receiver without power or cable": ("tractor receiver", begin("receiver-silent"), "check its power, its cable"),
    "a receiver at another baud rate": ("tractor receiver", begin("receivers-garbage"), "check the baud rate"),
    "a receiver that sends other messages": ("tractor receiver", send(lambda piece: [GSV]), "which messages"),
    "a receiver without position": ("tractor receiver", begin("fixes-lost"), "no RTK fix"),
    "a receiver that floats": ("tractor receiver", begin("fixes-float"), "no RTK fix"),
    "a receiver without corrections": (
        "tractor receiver",
        say(lambda report: replace(report, quality=FixQuality.SINGLE, correction_age=math.nan)),
        "it reports no age of its corrections",
    ),
    "corrections 30 s old": ("tractor receiver", say(lambda r: replace(r, correction_age=30.0)), "30 s old"),
    "a receiver that sends no speed": (
        "tractor receiver",
        send(lambda piece: [] if b"VTG" in piece else [piece]),
        "it reports no speed",
    ),
    "a receiver at 1 Hz": ("trailer receiver", slow, "set it to 5 Hz"),
    "a board without power, or at another address": ("tractor board", begin("board-silent"), "nothing was received"),
    "AgIO on another computer": ("tractor board", lambda yard: setattr(yard, "agio", True), "stop that program"),
    "a steering sensor with a broken cable": (
        "tractor board",
        lambda yard: measure_otherwise(yard.machine, "tractor", lambda true: 1.2),
        "check for a broken or shorted cable",
    ),
    "a sensor board without power or cable": ("sensor board", begin("sensors-silent"), "check its power, its cable"),
    "a sensor board at another baud rate": ("sensor board", garble, "check the baud rate"),
    "a hitch sensor with a broken cable": ("sensor board", hitch(9999), "check for a broken or shorted cable"),
    "a hitch sensor that the board does not read": ("sensor board", hitch(None), "nothing of the hitch sensor"),
    "an encoder that the board does not read": (
        "sensor board",
        lambda yard: setattr(yard.machine, "pulses", lambda right: None),
        "nothing of the wheel sensor",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_each_fault_is_found_at_its_device(monkeypatch, name):
    device, put_in, expected = CASES[name]
    yard = Yard(monkeypatch)
    put_in(yard)
    found = yard.findings()
    if not device:
        assert not any(each.problems for each in found.values()), found
        return
    told = [problem for problem in found[device].problems if expected in problem]
    assert told, found[device].problems
    row = f"| {name} | {device}: {told[0]} |"
    print(row)
    assert row in PAGE.read_text("utf-8"), row
