"""The autopilot in Python: feeds, asks and records the control step, whose order stands in control_step.h."""

import ctypes
from typing import NamedTuple

from drawbar.control.external import External
from drawbar.errors import DrawbarError, PathError, demand, demand_number
from drawbar.guidance.path import Path
from drawbar.signals import Command, Estimate, Measurement, Status, StepRecord, Truth
from drawbar.signals.layout import Layout
from drawbar.step.library import StepLibrary
from drawbar.step.record import RecordReader

_MEASUREMENT, _COMMAND, _ESTIMATE = Layout(Measurement), Layout(Command), Layout(Estimate)


class Memory(NamedTuple):
    """What an autopilot remembers of a run."""

    library: tuple[bytes, ...]
    number: int
    """of its newest step"""


class Autopilot:
    """One vehicle's control step.

    Each sample: feedback(), send the command whatever the status, then prepare(); record() returns its record.
    """

    def __init__(self, library: StepLibrary, horizon: int, external: External | None = None) -> None:
        """Take the library, the number of stages in its plans and, where there is one, the user's own controller."""
        self.library, self._external = library, external
        self._reader = RecordReader(library, horizon)
        self._given, self._taken = self._reader.measurement, self._reader.command
        self._feedback = library.function("feedback", self._given, self._taken)
        self._sent = type(self._taken)()
        self._feedback_again = library.function("feedback_again", self._given, self._sent, self._taken)
        self.prepare = library.function("prepare")
        """does what can be done before the next measurement; returns a Status"""
        self._measurement: Measurement | None = None
        self._command: Command | None = None
        self._number = -1

    def begin(self, path: Path, *, at: float = 0.0) -> None:
        """Let the next measurement start a run along a path.

        Args:
            path: to follow.
            at: arc length at which the run begins, m.

        Raises:
            PathError: the path is not smooth, or `at` is not on it.
        """
        demand_number("at", at, "give an arc length in m", PathError)
        self._set_path("set_path", path)
        if at:
            _require(Status(self.library.call("begin_at", ctypes.c_double(at))), path, at)
        self.path, self.start, self._number = path, at, -1

    def change_path(self, path: Path, *, at: float = 0.0) -> None:
        """Go on along another path without a stop.

        Args:
            path: to follow; near `at` it must be under the vehicle.
            at: arc length there, m.

        Raises:
            PathError: the path is not smooth, or not under the vehicle there; the run continues along the old one.
        """
        demand_number("at", at, "give an arc length in m", PathError)
        self._set_path("change_path", path, ctypes.c_double(at), at=at)
        self.path = path

    def _set_path(self, function: str, path: Path, *arguments: object, at: float = 0.0) -> None:
        demand("path", path, Path, "give one that build_path() made, or Path.through()", PathError)
        nodes = path.nodes  # the library keeps no copy
        status = self.library.call(function, ctypes.c_void_p(nodes.ctypes.data), len(nodes), *arguments)
        _require(Status(status), path, at)
        self._nodes = nodes

    def set_speed(self, speed: float) -> None:
        """Change the set speed, m/s; in a run the commanded speed approaches it by the configuration's acceleration.

        Raises:
            DrawbarError: it is not from 0 to the configuration's own; the set speed stays.
        """
        demand_number("speed", speed, "give m/s")
        if self.library.call("set_speed", ctypes.c_double(speed)) != Status.OK:
            raise DrawbarError(f"speed = {speed} m/s is not allowed; give 0 to the configuration's own speed.")

    def set_offset(self, offset: float) -> None:
        """Drive along the line so far to the left of the path (right: negative), m; 0 after begin and change_path.

        In a run that is engaged the line is shifted, beginning beside the tractor, as softly as the vehicle can follow;
        else it is there at once.

        Raises:
            DrawbarError: it is beyond 100 m, a curve leaves no such line, or there is no path; the line stays.
        """
        demand_number("offset", offset, "give m")
        status = Status(self.library.call("set_offset", ctypes.c_double(offset)))
        if status is Status.RANGE:
            raise DrawbarError(
                f"offset = {offset} m is not allowed; give at most 100 m to either side, and not so far into a curve "
                f"that the line becomes tighter than vehicle.curvature_limit."
            )
        if status is not Status.OK:
            raise DrawbarError(f"offset = {offset} m is not allowed: {status.text}; call begin(path) first.")

    def set_engaged(self, engaged: bool) -> None:
        """Set whether the commands are carried out; at first they are.

        While they are not, the command repeats the steering as it is, and plans continue from what the vehicle does.
        """
        self.library.call("set_engaged", ctypes.c_int32(engaged))

    def remember(self) -> Memory:
        """Return what it remembers of the run, for `recall`."""
        return Memory(self.library.remember(), self._number)

    def recall(self, memory: Memory) -> None:
        """Remember again what it did; it must be on the same path as then. A user's own controller forgets nothing."""
        self.library.recall(memory.library)
        self._number = memory.number

    def give(self, estimate: Estimate) -> None:
        """Give the next sample's estimate to an autopilot whose estimator is ideal.

        Raises SignalError where the estimate holds what is no number.
        """
        estimator = self.library.components["estimator"]
        for structure in (estimator.live, estimator.settings):  # a run that begins takes over its settings
            _ESTIMATE.pack(structure.memory, estimate)

    def feedback(self, measurement: Measurement) -> tuple[Status, Command]:
        """Return a status and the command to send; where there is a new one the status is OK, see record().flags.

        Whatever a controller of the user's own raises comes out here.

        Raises:
            SignalError: the measurement holds what is no number.
        """
        _MEASUREMENT.pack(self._given, measurement)
        return self._answered(measurement, self._feedback())

    def feedback_again(self, measurement: Measurement, sent: Command) -> tuple[Status, Command]:
        """Take in the measurement of a sample again, after recall(); the command that was sent then has acted since.

        Args:
            measurement: of the sample, as it was or otherwise.
            sent: command that feedback() returned then.

        Raises:
            SignalError: the measurement or the command holds what is no number.
        """
        _MEASUREMENT.pack(self._given, measurement)
        _COMMAND.pack(self._sent, sent)
        return self._answered(measurement, self._feedback_again())

    def _answered(self, measurement: Measurement, status: int) -> tuple[Status, Command]:
        """Return what a feedback has answered to a measurement."""
        if self._external is not None and (error := self._external.error) is not None:
            self._external.error = None
            raise error
        self._measurement, self._command = measurement, _COMMAND.unpack(self._taken)
        self._number += 1
        return (Status.OK if status < Status.REFUSED else Status(status)), self._command

    def record(self, truth: Truth | None = None) -> StepRecord:
        """Return what the newest step took in, decided and put out.

        Args:
            truth: of a simulated machine at the time of the measurement.

        Raises:
            DrawbarError: there has been no step yet.
        """
        if self._measurement is None or self._command is None:
            raise DrawbarError("There is no step to record yet; call feedback() first.")
        return self._reader.read(self._number, self._measurement, self._command, truth)


def _require(status: Status, path: Path, at: float) -> None:
    if status is Status.PATH:
        raise PathError(
            "the path is not smooth: its nodes must be 1 mm to 0.25 m apart, without jumps or kinks, its yaw continuous"
        )
    if status is Status.RANGE:
        raise PathError(f"{at} m is not on the path; give an arc length from 0 to below {path.length:.2f} m")
    if status is Status.ELSEWHERE:
        raise PathError(
            f"the vehicle is not on the new path near {at:.2f} m, or faces away from it; the run continues as it was"
        )
    if status is not Status.OK:
        raise PathError(status.text)
