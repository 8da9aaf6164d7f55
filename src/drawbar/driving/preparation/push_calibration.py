"""Push calibration: moves a bare valve or motor a little, push by push, and reports the result (docs/calibration.md).

One implementation for `drawbar calibrate --push` and for the console, whose pages look on from another thread.
"""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from drawbar.config import Configuration
from drawbar.driving.preparation.hand_calibration import CalibrationResult
from drawbar.errors import ConfigurationError
from drawbar.machine.calibration.calibrated import Calibrated, linear_fit
from drawbar.machine.calibration.plans import DeadBandPlan, RatePlan
from drawbar.machine.calibration.pushing import CalibratedMachine, Calibration, CalibrationLimits, Sensed, carry_out
from drawbar.machine.calibration.valve import actuator_dynamics, dead_band
from drawbar.machine.hardware.bare_valve import BareValve, Motion
from drawbar.machine.hardware.bare_valve_settings import BareValveSettings
from drawbar.machine.hardware.receiver import Receiver, ReceiverSettings
from drawbar.transports.open import open_transport

PUSHES = 5
"""to each side, for full rate, lag and dead time"""
STOPPED = "stopped by the operator"
PATIENCE = 2.0
"""for which a page may be silent that looks on, s"""
_READYING = 20.0
"""within which the vehicle must roll and the operator hold the switch, s"""
_RATE, _LARGEST = math.radians(8.0), 0.45
"""of the large pushes: the rate that is aimed at, below what is taken for a runaway (rad/s), and the largest drive"""
_FEWEST, _SPREAD, _SURE = 20, math.radians(1.0), 0.05
"""of the sensor's scale: rests, least standard deviation of their angles (rad), largest deviation of the scale"""


class PushCalibration:
    """The pushes of one calibration. `end`, `attend` and what is read may be called from another thread."""

    def __init__(self, machine: CalibratedMachine, settings: BareValveSettings, *, patience: float = math.inf) -> None:
        """Take what is moved, its settings, and for how long it may continue without `attend`, s."""
        self.rows: list[tuple[float, float, float]] = []
        """monotonic time (s), angle (rad) and drive (-1 to 1) of each report; it only grows"""
        self.bands = DeadBandPlan()
        self.rates: RatePlan | None = None
        """None: its turn has not come"""
        self.reason = ""
        """why it was ended early, and what to do"""
        self._machine, self._settings, self._patience = machine, settings, patience
        self.started = False
        """the vehicle rolls, and the wheels are turned"""
        self._ending, self._attended = "", time.monotonic()

    def end(self, reason: str) -> None:
        """End it now, for a reason."""
        self._ending = self._ending or reason

    def attend(self) -> None:
        """Note that the operator still watches."""
        self._attended = time.monotonic()

    def run(self) -> list[CalibrationResult]:
        """Make all pushes, and return what they show; nothing where it failed (`reason`). Then it is off."""
        try:
            self._wait_until_it_rolls()
            self.started = True
            first = self._made(Calibration(self.bands))
            if self.reason:
                return []
            self.rates = RatePlan(drives=_large_drives(self.bands), pushes=PUSHES)
            second = self._made(Calibration(self.rates, direction=first.direction))
            if self.reason:
                return []
            rests = [*first.rests, *second.rests]
            return [*_actuator(self.bands, self.rates, first.direction), _sensor(self._settings, rests)]
        finally:
            self._machine.off()

    def _wait_until_it_rolls(self) -> None:
        """Wait, off, until a calibration may begin; after a while it begins, and reports what is missing."""
        limits, began = CalibrationLimits(), math.nan
        while not self._ending:
            sensed = self._machine.sense()
            self._machine.off()
            self._watch(sensed, 0.0)
            began = sensed.time if math.isnan(began) else began
            rolls = limits.slowest <= sensed.speed <= limits.fastest
            if (rolls and sensed.permitted) or sensed.time - began > _READYING:
                return

    def _made(self, calibration: Calibration) -> Calibration:
        """Carry a calibration out; `reason`: why it was ended early."""
        carry_out(calibration, self._machine, self._watch)
        self.reason = self._ending or calibration.reason
        return calibration

    def _watch(self, sensed: Sensed, drive: float) -> str:
        """Keep what is sensed; return why to end now, or nothing."""
        self.rows.append((sensed.time, sensed.angle, drive))
        if time.monotonic() - self._attended > self._patience:
            self.end(f"no picture was drawn for {self._patience} s; keep the page in front, and begin again")
        return self._ending


def bare_valve_settings(configuration: Configuration) -> BareValveSettings:
    """Return the bare valve of a configuration; raises ConfigurationError where it names none."""
    settings = configuration.devices.bare_valve if configuration.devices is not None else None
    if settings is None:
        raise ConfigurationError(
            f"{configuration.name} names no valve or motor to push; add [devices.bare_valve] with transport, counts "
            f"and angles (docs/calibration.md)"
        )
    return settings


def open_bare_valve(settings: BareValveSettings, wheelbase: float, motion: Callable[[], Motion]) -> BareValve:
    """Open a bare valve; raises DrawbarError where its transport cannot be opened.

    Args:
        settings: of the valve.
        wheelbase: of the tractor, m.
        motion: returns how it moves now.
    """
    return BareValve(open_transport(settings.transport), settings, wheelbase=wheelbase, motion=motion)


class ReceiverMotion:
    """How the tractor moves, by its receiver."""

    def __init__(self, settings: ReceiverSettings) -> None:
        """Open it; raises DrawbarError where its transport cannot be opened."""
        self._receiver = Receiver(open_transport(settings.transport), settings)

    def __call__(self) -> Motion:
        """Return the newest motion."""
        self._receiver.poll(time.monotonic())
        epoch = self._receiver.last
        if epoch is None:
            return Motion(-math.inf, math.nan, math.nan)
        return Motion(epoch.time, epoch.speed, epoch.yaw_rate)

    def close(self) -> None:
        """Give the transport back."""
        self._receiver.close()


def _large_drives(bands: DeadBandPlan) -> tuple[float, float]:
    """Return the drives, by their sign, at which it turns as fast as it may be let."""
    drives = []
    for runs in (bands.runs[1], bands.runs[-1]):
        band = dead_band(runs).value
        hardest = [run[-1] for run in runs]
        beyond = max(sum(abs(push.drive) for push in hardest) / len(hardest) - band, 0.01)
        rate = sum(abs(push.moved) / push.duration for push in hardest) / len(hardest)
        drives.append(round(min(_LARGEST, band + _RATE / rate * beyond), 3))  # as it is sent to the board
    return drives[0], drives[1]


def _actuator(bands: DeadBandPlan, rates: RatePlan, direction: int) -> Iterator[CalibrationResult]:
    """Yield the direction, and dead band, full rate, lag and dead time of each side."""
    yield CalibrationResult(name="direction of the drive", value=_sure(direction), sets={})
    for side, sign in (("left", direction), ("right", -direction)):
        band = dead_band(bands.runs[sign])
        yield CalibrationResult(name=f"{side}: dead band", value=band, sets={})
        if not band.accepted:
            continue
        pushes = [replace(push, angles=direction * push.angles) for push in rates.records[sign]]
        dynamics = actuator_dynamics(pushes, dead_band=band.value)
        yield CalibrationResult(name=f"{side}: full rate", value=dynamics.size, sets={})
        yield CalibrationResult(name=f"{side}: lag", value=dynamics.lag, sets={})
        yield CalibrationResult(name=f"{side}: dead time", value=dynamics.dead_time, sets={})


def _sure(direction: int) -> Calibrated:
    return Calibrated(
        value=float(direction),
        deviation=0.0,
        unit="(1: positive turns left, -1: right)",
    )


def _sensor(settings: BareValveSettings, rests: Sequence[tuple[float, float]]) -> CalibrationResult:
    """Return the scale of the sensor: the angle turned by the yaw rate, divided by the sensor's."""
    angles, by_yaw = np.array(rests).reshape(-1, 2).T
    refusals = []
    if len(angles) < _FEWEST or not angles.std() >= _SPREAD:
        refusals.append(
            f"rests: {len(angles)}, within {math.degrees(np.ptp(angles)):.1f}°; push again, rolling straight"
        )
    fit = linear_fit(np.column_stack([angles, np.ones(len(angles))]), by_yaw)
    factor, deviation = float(fit.parameters[0]), float(fit.deviations[0])
    if not (deviation <= _SURE and factor > 0.0):
        refusals.append(f"the yaw rate tells it to {deviation:.2f} only; roll faster, at 1 m/s, straight ahead")
    value = Calibrated(
        value=factor,
        deviation=deviation,
        unit="",
        refusals=tuple(refusals),
    )
    scaled = [round(factor * angle, 6) for angle in settings.angles]
    sets = {"devices.bare_valve.angles": scaled} if value.accepted else {}
    return CalibrationResult(name="front wheels: angle by the yaw rate / by the sensor", value=value, sets=sets)
