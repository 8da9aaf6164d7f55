"""A stand-in of a bare valve's board on a rolling tractor, in virtual time: every look at it lets 20 ms pass."""

import math

import numpy as np

from drawbar.machine.hardware.bare_valve import BareValve, Motion
from drawbar.machine.hardware.bare_valve_settings import BareValveSettings
from drawbar.machine.stand_in.bare_valve import StandInBareValve
from drawbar.machine.stand_in.machine import HITCH_ANGLES, HITCH_COUNTS
from drawbar.transports.base import Received, Transport

PERIOD, WHEELBASE, SPEED = 0.02, 1.4, 0.8
SETTINGS = BareValveSettings(transport="tcp://127.0.0.1:1", counts=HITCH_COUNTS, angles=HITCH_ANGLES)


class PushedValve(Transport):
    """The board's line, its wheels and the tractor; `each` is called at every look, with the time (s)."""

    def __init__(self, *, motor=1.0, scale=1.0, each=lambda time, line: None, seed=0):
        self.board = StandInBareValve(SETTINGS.model_copy(update={"angles": tuple(scale * a for a in HITCH_ANGLES)}))
        self.connected, self.time, self.speed, self.silent, self.knows_yaw = True, 0.0, SPEED, False, True
        self.rng, self.each, self.motor, self.angle, self.farthest = np.random.default_rng(seed), each, motor, 0.0, 0.0
        self.received = []
        """all drives"""
        self.motion = Motion(-math.inf, math.nan, math.nan)

    def machine(self):
        """Return the valve as a calibration moves it."""
        return BareValve(self, SETTINGS, wheelbase=WHEELBASE, motion=lambda: self.motion, clock=lambda: self.time)

    def fileno(self):
        return -1

    def read(self):
        self.time += PERIOD
        self.each(self.time, self)
        turned = self.board.turn(self.time, self.angle, PERIOD)
        self.angle = self.angle if turned is None else turned
        self.farthest = max(self.farthest, abs(self.angle))
        if round(self.time / PERIOD) % 10 == 0:  # the receiver's epochs
            rate = self.speed * math.tan(self.angle) / WHEELBASE + math.radians(0.3) * self.rng.standard_normal()
            self.motion = Motion(self.time, self.speed, rate if self.knows_yaw else math.nan)
        return [] if self.silent else [Received(self.time, self.board.report(self.time))]

    def write(self, data):
        drive = int(data.split(b",")[1].split(b"*")[0])
        self.received.append(drive)
        self.board.receive(self.time, drive_of(round(self.motor * drive)))
        return True

    def close(self):
        self.connected = False


def drive_of(number):
    """Return the sentence of a drive."""
    from drawbar.protocols.own_sentence import own_sentence

    return own_sentence("PDBD", number)
