"""What happens on the ISOBUS: its valves, other devices there, and the wire itself."""

import math
import random

from drawbar.machine.stand_in.breaking import steer_otherwise
from drawbar.machine.stand_in.faults import FAULTS
from drawbar.protocols.isobus.address import CLAIM
from drawbar.protocols.isobus.guidance_messages import (
    SYSTEM_COMMAND,
    ExitReason,
    Intention,
    SystemCommand,
    encode_command,
)
from drawbar.protocols.isobus.identifier import Message, encode
from drawbar.protocols.isobus.tractor_messages import WHEEL_SPEED

OWN = 128
"""address of drawbar on the bus"""
OTHER = 28
"""of another device"""
FLOOD = 9
"""frames every 5 ms: 1800 a second, 95 % of what a bus of 250 kbit/s can carry"""


def valve(trial, change):
    """Let the front wheels' valve be changed."""
    trial.begin = lambda: change(trial.rehearsal.machine.can.valves["tractor"])


def at_each_step(trial, send):
    """Let send(bus) be called with the machine's end of the bus at each step from the fault on."""

    def begin():
        machine = trial.rehearsal.machine
        before, bus = machine.advance, machine.can._devices._bus

        def advance(now):
            send(bus)
            return before(now)

        machine.advance = advance

    trial.begin = begin


def bus_cut(trial):
    trial.begin = lambda: FAULTS["bus-off"].begin(trial.rehearsal.machine)


def bus_off(trial):
    """Let the computer's own adapter take no frames, as after too many errors."""

    def begin():
        for wire in trial.rehearsal.gate.wires._wires:
            wire.transport.write = lambda frame: False

    trial.begin = begin


def bus_flooded(trial):
    """Let another device say something of the highest priority, as often as the bus can carry."""
    frame = encode(Message(pgn=0xFF00, source=OTHER, priority=0, data=bytes(8)))

    def send(bus):
        for _ in range(FLOOD):
            bus.write(frame)

    at_each_step(trial, send)


def lost(trial, share):
    """Let a share of what the computer says on the bus not reach the devices."""

    def begin():
        bus, chance = trial.rehearsal.machine.can._devices._bus, random.Random(trial.seed)
        before = bus.read
        bus.read = lambda: [each for each in before() if chance.random() >= share]

    trial.begin = begin


def commands_lost(trial):
    lost(trial, 1.0)


def some_commands_lost(trial):
    lost(trial, 0.2)


def address_claimed(trial):
    """Let another device with a stronger name claim drawbar's address, once."""
    claim = encode(Message(pgn=CLAIM, source=OWN, data=(1).to_bytes(8, "little")))
    trial.begin = lambda: trial.rehearsal.machine.can._devices._bus.write(claim)


def address_used_twice(trial):
    """Let another device talk under drawbar's address."""
    frame = encode(Message(pgn=0xFF00, source=OWN, data=bytes(8)))
    at_each_step(trial, lambda bus: bus.write(frame))


def other_guidance(trial):
    """Let another guidance system command the front wheels' valve."""
    command = SystemCommand(curvature=0.0, intention=Intention.INTENDED)
    address = 38
    message = Message(pgn=SYSTEM_COMMAND, source=OTHER, destination=address, priority=3, data=encode_command(command))

    def begin():
        machine = trial.rehearsal.machine
        front, bus = machine.can.valves["tractor"], machine.can._devices._bus
        bus.write(encode(message))
        front.receive_message(trial.rehearsal.time, message)

    trial.begin = begin


def valve_restarts(trial):
    """Let the valve lose its power for half a second, and with it who may engage it."""

    def restart(front):
        front._target = front._master = None
        front.silent, back = True, trial.rehearsal.time + 0.5
        before = front.frames

        def frames(now):
            front.silent = now < back
            return before(now)

        front.frames = frames

    valve(trial, restart)


def valve_silent(trial):
    valve(trial, lambda front: setattr(front, "silent", True))


def valve_locked_out(trial):
    valve(trial, lambda front: setattr(front, "locked_out", True))


def valve_not_ready(trial):
    valve(trial, lambda front: setattr(front, "interlock", ExitReason.OIL_TEMPERATURE))


def valve_faulty(trial):
    valve(trial, lambda front: setattr(front, "interlock", ExitReason.FUNCTION_FAULT))


def operator_at_the_wheel(trial):
    valve(trial, lambda front: setattr(front, "operator_steers", True))


def operator_at_the_pedal(trial):
    trial.begin = lambda: setattr(trial.rehearsal.machine.can.tractor, "operator_drives", True)


def reported(trial, change):
    """Let the front wheels' valve report change(its true curvature, 1/m)."""

    def begin():
        can = trial.rehearsal.machine.can
        before = can._maps["tractor"].curvature
        can._maps["tractor"] = OtherMap(can._maps["tractor"], lambda angle: change(before(angle)))

    trial.begin = begin


class OtherMap:
    """Turns angles into other curvatures than it should; back as it should."""

    def __init__(self, right, curvature):
        self.angle, self.curvature = right.angle, curvature


def valve_reports_the_same(trial):
    kept = []

    def change(curvature):
        kept.append(curvature)
        return kept[0]

    reported(trial, change)


def valve_reports_5_off(trial):
    reported(trial, lambda curvature: curvature + math.tan(math.radians(5.0)) / 1.4)


def valve_steers_5_off(trial):
    """Let the valve turn the wheels elsewhere than it is told, and report what they do."""
    trial.begin = lambda: steer_otherwise(
        trial.rehearsal.machine, "tractor", lambda wanted, true: wanted + math.radians(5.0)
    )


def tractor_tells_no_speed(trial):
    """Let the tractor's wheel speed be lost from the bus."""

    def begin():
        tractor = trial.rehearsal.machine.can.tractor
        before = tractor.frames
        tractor.frames = lambda now: [each for each in before(now) if each.identifier >> 8 & 0xFFFF != WHEEL_SPEED]

    trial.begin = begin
