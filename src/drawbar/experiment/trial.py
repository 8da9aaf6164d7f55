"""A trial: a rehearsal of a drive in which a fault begins at a place of the path, watched until the vehicle stands."""

import math
import random
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from drawbar.config import Configuration
from drawbar.driving.stand_in.rehearsal import STEP, Rehearsal
from drawbar.driving.stand_in.simulated_links import LinkFault
from drawbar.geometry import Floats, wrap
from drawbar.guidance.path import Path
from drawbar.machine.stand_in.faults import FAULTS
from drawbar.messages import SupervisorState
from drawbar.protocols.agopengps.frame import Frame, parse
from drawbar.protocols.agopengps.steering import decode_steer
from drawbar.recording.header import run_header
from drawbar.recording.log import Outcome, RunLog
from drawbar.safety.envelope import Bounds, Envelope
from drawbar.safety.settings import SafetySettings
from drawbar.signals import Pose, StepRecord
from drawbar.simulation import build_path
from drawbar.vehicle.parameters import BODIES

LONGEST = 150.0
"""time in which the fault's place must be reached, s"""
_NEAR = 4.0
"""the path is searched so far around the last place, m"""
_RESTS = 1.0
"""how long a vehicle that stands is watched after its steering has been released, s"""
_MOVING = 0.05
"""between two rows while nothing but the vehicle's motion changes, s"""
_SAME = 1e-3
"""rad, s: half the wire's resolution of angles, and more"""
WATCHED = (
    *("time", "state", "cause", "driving", "speed", "way", "tractor", "trailer", "beyond", "clips", "rejects"),
    *("dropped", "flags"),
)
"""columns `watch.NAME`: s since the fault; SupervisorState; code of its cause; steerings that follow set points; m/s; m
since the fault; signed distances of both bodies from the path, m; set points on the wire beyond the envelope; the
gate's counts since the fault; flags of the control step"""
_EVENTS = tuple(WATCHED.index(name) for name in ("state", "cause", "driving", "beyond"))


class Trial:
    """What alterations of a rehearsal are given; they set what happens, where, and for how long it is watched."""

    def __init__(
        self,
        configuration: Configuration,
        seed: int,
        drive: Callable[[Configuration, Path, int, SafetySettings], Rehearsal] = Rehearsal,
    ) -> None:
        """Build the rehearsal.

        Args:
            configuration: of the run.
            seed: of everything random.
            drive: returns what is watched, given what a Rehearsal is.

        Raises:
            DrawbarError: it cannot be built.
        """
        self.configuration, self.seed = configuration, seed
        self.path, self._drivable = build_path(configuration)
        self.rehearsal = drive(configuration, self.path, seed, configuration.safety)
        self.place = -math.inf
        """arc length of the tractor at which the fault begins, once the vehicle is steered, m; -inf: at the start"""
        self.begin: Callable[[], None] = lambda: None
        """puts the fault in"""
        self.watched = 16.0
        """longest time for which it is watched, s"""
        vehicle = configuration.vehicle
        limits = (vehicle.tractor_steering_limit, vehicle.trailer_steering_limit)
        self._envelope = Envelope(
            configuration.safety, Bounds(wheelbase=vehicle.wheelbase, tractor_limit=limits[0], trailer_limit=limits[1])
        )
        self._trailer_limit, self._beyond = limits[1], 0
        self._near, self._errors = [0.0, 0.0], [0.0, 0.0]
        self._rows: list[tuple[float, ...]] = []
        self._records: list[StepRecord] = []

    def device(self, name: str) -> None:
        """Let the fault be one of the stand-in machine's (drawbar/machine/stand_in/faults.py)."""
        self.begin = lambda: FAULTS[name].begin(self.rehearsal.machine)

    def alter_links(self, names: Sequence[str], make: Callable[[random.Random, float], LinkFault]) -> None:
        """Let the fault be what happens to bytes on their way, behind what happens to them already.

        Args:
            names: of what is carried, see Rehearsal.links.
            make: returns the fault of one of them, given its randomness and the time at which the fault begins, s.
        """

        def begin() -> None:
            faults = self.rehearsal.links.faults
            for name in names:
                own, before = make(random.Random(f"{self.seed} {name}"), self.rehearsal.time), faults.get(name)
                faults[name] = own if before is None else _joined(before, own)

        self.begin = begin

    def approach(self) -> None:
        """Drive to the fault's place.

        Raises:
            RuntimeError: it was never reached.
        """
        rehearsal = self.rehearsal
        while self.place > -math.inf and not (self._steered and self._near[0] >= self.place):
            if rehearsal.time > LONGEST:
                raise RuntimeError(f"arc length {self.place} m was not reached, the gate says {rehearsal.gate_state}")
            self._advance()

    def watch(self) -> None:
        """Put the fault in, and watch what comes of it."""
        rehearsal, way, rested = self.rehearsal, 0.0, 0.0
        self._beyond = 0
        start, before = rehearsal.time, self._counts()
        for body in BODIES:
            self._judge_set_points(body)
        self._keep(0.0, way, before)
        self.begin()
        while rehearsal.time < start + self.watched and rested < _RESTS:
            self._advance()
            truth = rehearsal.machine.world.truth
            way += truth.speed * STEP * 1e-9
            rests = abs(truth.speed) < 0.02 and not self._steered and self.place > -math.inf
            rested = rested + STEP * 1e-9 if rests else 0.0
            self._keep(rehearsal.time - start, way, before)

    def _keep(self, since: float, way: float, before: Sequence[int]) -> None:
        """Keep a row of WATCHED, if it holds something that the last one does not; `before`: counts at the fault."""
        speed, flags = self.rehearsal.machine.world.truth.speed, self._records[-1].flags if self._records else 0
        counts = [after - count for after, count in zip(self._counts(), before, strict=True)]
        row = (since, *self._state(), speed, way, *self._errors, self._beyond, *counts, float(flags))
        last = self._rows[-1] if self._rows else None
        if last is None or row[0] > last[0] + _MOVING - STEP * 0.5e-9 or any(row[i] != last[i] for i in _EVENTS):
            self._rows.append(row)

    def log(self) -> RunLog:
        """Return the log of the control step, whose outcome is that it was watched to the end."""
        header = run_header(self.configuration, self.path, self._drivable, self.seed)
        return RunLog(
            header=header,
            records=tuple(self._records),
            wall_time=np.full(len(self._records), time.time()),
            outcome=Outcome(finished=True, reason="the fault was watched to its end"),
        )

    def column(self, name: str) -> Floats:
        """Return one of WATCHED, (n,), from the fault on: every 0.05 s, and where one of _EVENTS changes."""
        return np.array([row[WATCHED.index(name)] for row in self._rows], dtype=np.float64)

    @property
    def _steered(self) -> bool:
        return self.rehearsal.machine.driving > 0

    def _advance(self) -> None:
        for record, truth in self.rehearsal.run(STEP * 1e-9):
            self._records.append(replace(record, truth=truth))
        can, truth = self.rehearsal.machine.can, self.rehearsal.machine.world.truth
        for body, angle in can.set_points().items() if can else ():
            if angle is not None:
                self._judge(body, angle)
        for i, pose in enumerate((truth.tractor, truth.trailer)):
            self._near[i], self._errors[i] = self._project(pose, self._near[i])

    def _project(self, pose: Pose, near: float) -> tuple[float, float]:
        progress, error = self.path.project(pose.x, pose.y, near - _NEAR, near + _NEAR)
        return float(progress), float(error)

    def _state(self) -> tuple[float, float, float]:
        state = self.rehearsal.gate_state
        cause = float(state.cause if state else 0)
        return (float(state.state if state else SupervisorState.BOOT), cause, self.rehearsal.machine.driving)

    def _counts(self) -> tuple[int, int, int]:
        state = self.rehearsal.gate_state
        return (state.clips, state.rejects, state.dropped) if state else (0, 0, 0)

    def _judge(self, body: str, angle: float) -> None:
        """Count a set point that is beyond the envelope at the speed that the vehicle truly has."""
        speed = max(self.rehearsal.machine.world.truth.speed - 0.1, 0.0)
        limit = self._envelope.angle_cap(speed) if body == "tractor" else self._trailer_limit
        self._beyond += not abs(wrap(angle)) <= limit + _SAME

    def _judge_set_points(self, body: str) -> None:
        """Judge set points that leave the gate for a board."""
        wire = f"{body} set point"

        def fault(now: float, data: bytes) -> list[tuple[float, bytes]]:
            frame = parse(data)
            decoded = decode_steer(frame) if isinstance(frame, Frame) else None
            if decoded is not None and decoded[0].steer:
                self._judge(body, decoded[0].angle)
            return [(0.0, data)]

        self.rehearsal.links.faults[wire] = fault


def _joined(first: LinkFault, second: LinkFault) -> LinkFault:
    return lambda now, data: [
        (delay + more, last) for delay, each in first(now, data) for more, last in second(now, each)
    ]
