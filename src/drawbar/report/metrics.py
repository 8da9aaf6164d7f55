"""The figures of a run, computed from its log: the content of metrics.json.

Without truth (a real machine) errors are those of estimated positions; every other figure that needs the truth is NaN,
null in JSON. Steering and commands count while the autopilot is engaged; else they are the driver's.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import msgspec
import numpy as np

from drawbar.geometry import Floats
from drawbar.recording.log import Columns
from drawbar.report.columns import actual_steering, along, engaged, estimated
from drawbar.report.masts import mast_doubt
from drawbar.report.path_errors import Bodies, PathErrors
from drawbar.report.positions import antennas_aside, lasting_residual, rejected_share
from drawbar.report.shadow import ShadowMetrics
from drawbar.report.two_antennas import yaw_difference
from drawbar.signals import FixStatus, GateVerdict

ALL = "all"
"""the class of every position of the path"""
STRAIGHT = "straight"
"""the class of a figure-eight's straights"""

_AT_LIMIT = math.radians(0.5)


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorStatistics:
    """Of a distance, m: of its magnitude, but for the standard deviation."""

    mean: float
    rms: float
    max: float
    deviation: float = math.nan
    """standard deviation of the signed distance"""
    p95: float = math.nan
    """95 % of all magnitudes are at most this"""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeStatistics:
    """Of a wall-clock time, s."""

    median: float
    p99: float
    max: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PhaseTimes:
    """Of the two phases of one solver."""

    prepare: TimeStatistics
    feedback: TimeStatistics


@dataclass(frozen=True, slots=True, kw_only=True)
class SolverTimes:
    """Of the solvers of a control step; a body without a solver of its own has NaN, null in JSON.

    A centralised controller's one solver counts as the tractor's.
    """

    estimator: PhaseTimes
    tractor: PhaseTimes
    trailer: PhaseTimes


@dataclass(frozen=True, slots=True, kw_only=True)
class Metrics:
    """Everything in metrics.json."""

    config: str
    seed: int
    finished: bool
    outcome: str
    """how the run ended, in words"""
    losses: tuple[str, ...] = ()
    """what of the log is damaged, and which steps are lost by that"""
    duration_s: float
    """by the clock of the measurements"""
    length_m: float
    """how far along the path the tractor got"""
    real_time_factor: float
    """duration over the wall-clock time it took"""
    error_m: Bodies[Mapping[str, ErrorStatistics]]
    """absolute distance of the body's point on the ground to the path, by class of the path: the true point's, or the
    estimated one's"""
    error_estimated: bool
    """the errors are of estimated positions, as on every real machine: what the estimate is off by is not in them"""
    mast_doubt_m: Bodies[float]
    """by how much masts may mislead for want of an attitude sensor, see masts.py; 0: there is one, or no mast"""
    residual_m: Bodies[float]
    """by how much accepted fixes lay beside the estimate for seconds on end, root mean square: estimated errors are too
    small by as much"""
    rejected_share: Bodies[float]
    """of the new fixes of each antenna"""
    antennas_aside_m: float
    """by how much the tractor's antenna stands further to the left of the trailer's than stated, by side-slips that are
    the same in all headings; NaN: the headings do not tell that from a slope"""
    yaw_difference_rad: float
    """by how much the yaw of the tractor's two antennas is left of the estimated one; NaN: they are not there"""
    yaw_rmse_rad: Bodies[float]
    """estimate against truth"""
    steering_rate_mean_rad_s: Bodies[float]
    """mean of |steering rate| from step to step: how busy the actuators are"""
    steering_rate_straight_rad_s: Bodies[float]
    """the same on straights of a path whose curves are marked; else NaN"""
    ancillary_share: Bodies[float]
    """signed share of the steering: sum of the ancillary term in the command's direction over sum of |command|"""
    saturated_share: Bodies[float]
    """steps whose command was clipped, of all engaged steps"""
    at_limit_share: Bodies[float]
    """steps at which the steering stood within 0.5° of its limit, of all engaged steps: what it cannot reach, nobody
    controls away"""
    tube_margin_min: Bodies[float]
    """how far inside its tube a body was at the worst: 1 at the centre, negative outside; NaN where none is declared"""
    stale_fixes: int
    """of both antennas: the receiver repeated an old one"""
    rejected_fixes: int
    """of both antennas: further from where they were expected than they can be"""
    solver_failures: int
    limited_commands: int
    """commands that the gate brought nearer to the wheels, as no actuator could tell the difference"""
    refused_commands: int
    """commands that the gate did not let pass"""
    solve_time_s: SolverTimes
    shadow: ShadowMetrics | None = None
    """of a drive at which drawbar only looked on"""

    def to_json(self) -> bytes:
        """Return the content of metrics.json: sorted, indented, the same bytes for the same figures."""
        return msgspec.json.format(msgspec.json.encode(self, order="sorted"), indent=2) + b"\n"


def _present(values: Floats) -> Floats:
    """Return the values that are not missing; one NaN when there are none, so that statistics are NaN."""
    present = values[~np.isnan(values)]
    return present if present.size else np.full(1, np.nan)


def _share(part: float, whole: float) -> float:
    return part / whole if whole > 0.0 else np.nan


def _span(values: Floats) -> float:
    return float(values[-1] - values[0]) if values.size else 0.0


def error_statistics(error: Floats) -> ErrorStatistics:
    """Summarise the magnitudes of (n,) errors; missing ones do not count, all NaN when there are none."""
    present = _present(error)
    size = np.abs(present)
    return ErrorStatistics(
        mean=float(size.mean()),
        rms=float(np.sqrt(np.mean(size**2))),
        max=float(size.max()),
        deviation=float(present.std()),
        p95=float(np.percentile(size, 95.0)),
    )


def _errors_by_class(errors: PathErrors, classes: tuple[str, ...]) -> dict[str, ErrorStatistics]:
    by_class = {name: error_statistics(errors.error[errors.of_class(name)]) for name in classes}
    return by_class | {ALL: error_statistics(errors.error)}


def _yaw_rmse(log: Columns, body: str) -> float:
    difference = log.column(f"estimate.{body}.yaw") - log.column(f"truth.{body}.yaw")
    return error_statistics(np.remainder(difference + np.pi, 2.0 * np.pi) - np.pi).rms


def _steering(log: Columns, body: str) -> Floats:
    """Return a body's steering, (n,) in rad; NaN while the autopilot was not engaged."""
    return np.where(engaged(log), actual_steering(log, body), np.nan)


def _steering_rates(log: Columns, body: str) -> Floats:
    """Return |steering rate|, (n - 1,), rad/s; NaN while the autopilot was not engaged."""
    rates: Floats = np.abs(np.diff(_steering(log, body))) / np.diff(log.column("measurement.time"))
    return rates


def _steering_rate(log: Columns, body: str) -> float:
    return float(_present(_steering_rates(log, body)).mean())


def _straight_rate(log: Columns, errors: PathErrors, body: str) -> float:
    return float(_present(_steering_rates(log, body)[errors.of_class(STRAIGHT)[1:]]).mean())


def _ancillary_share(log: Columns, body: str) -> float:
    steered = engaged(log)
    command = log.column(f"{body}_steering.command")[steered]
    ancillary = log.column(f"{body}_steering.ancillary")[steered] * np.sign(command)
    return _share(float(ancillary.sum()), float(np.abs(command).sum()))


def _saturated_share(log: Columns, body: str) -> float:
    steered = engaged(log)
    return _share(float(log.column(f"{body}_steering.saturated")[steered].sum()), float(steered.sum()))


def _at_limit_share(log: Columns, body: str) -> float:
    limit = getattr(log.header.vehicle, f"{body}_steering_limit")
    angles = _present(np.abs(_steering(log, body)))
    return math.nan if np.isnan(angles).any() else float(np.mean(angles >= limit - _AT_LIMIT))


def _tube_margin(log: Columns, body: str) -> float:
    return float(_present(log.column(f"{body}_steering.margin")[engaged(log)]).min())


def _fixes(log: Columns, status: FixStatus) -> int:
    return sum(int((log.column(f"estimate.{body}_fix") == status).sum()) for body in ("tractor", "trailer"))


def _time_statistics(time: Floats) -> TimeStatistics:
    median, p99, largest = np.percentile(_present(time), (50.0, 99.0, 100.0))
    return TimeStatistics(median=float(median), p99=float(p99), max=float(largest))


def _phase_times(log: Columns, solver: str) -> PhaseTimes:
    return PhaseTimes(
        prepare=_time_statistics(log.column(f"{solver}_times.prepare")),
        feedback=_time_statistics(log.column(f"{solver}_times.feedback")),
    )


def _of_both(figure: Callable[[Columns, str], float], log: Columns) -> Bodies[float]:
    return Bodies(tractor=figure(log, "tractor"), trailer=figure(log, "trailer"))


def compute_metrics(log: Columns, errors: Bodies[PathErrors]) -> Metrics:
    """Compute the figures of a run from its log and the true errors of both bodies."""
    classes = log.header.path.label_names
    gate = log.column("gate")[engaged(log)]
    progress = along(log, "tractor")
    duration, wall_time = _span(log.column("measurement.time")), _span(log.wall_time)
    return Metrics(
        config=log.header.configuration_name,
        seed=log.header.seed,
        finished=log.outcome.finished,
        outcome=log.outcome.reason,
        losses=log.losses,
        duration_s=duration,
        length_m=_span(progress[~np.isnan(progress)]),
        real_time_factor=_share(duration, wall_time),
        error_m=Bodies(
            tractor=_errors_by_class(errors.tractor, classes),
            trailer=_errors_by_class(errors.trailer, classes),
        ),
        error_estimated=not log.has_truth,
        mast_doubt_m=_of_both(mast_doubt, log),
        residual_m=_of_both(lasting_residual, log),
        rejected_share=_of_both(rejected_share, log),
        antennas_aside_m=antennas_aside(log),
        yaw_difference_rad=yaw_difference(log),
        yaw_rmse_rad=_of_both(_yaw_rmse, log),
        steering_rate_mean_rad_s=_of_both(_steering_rate, log),
        steering_rate_straight_rad_s=Bodies(
            tractor=_straight_rate(log, errors.tractor, "tractor"),
            trailer=_straight_rate(log, errors.trailer, "trailer"),
        ),
        ancillary_share=_of_both(_ancillary_share, log),
        saturated_share=_of_both(_saturated_share, log),
        at_limit_share=_of_both(_at_limit_share, log),
        tube_margin_min=_of_both(_tube_margin, log),
        stale_fixes=_fixes(log, FixStatus.STALE),
        rejected_fixes=_fixes(log, FixStatus.REJECTED),
        solver_failures=int(log.column("solver_failures")[estimated(log)].sum()),
        limited_commands=int((gate == GateVerdict.LIMITED).sum()),
        refused_commands=int((gate >= GateVerdict.REPEATED).sum()),
        solve_time_s=SolverTimes(
            estimator=_phase_times(log, "estimator"),
            tractor=_phase_times(log, "tractor"),
            trailer=_phase_times(log, "trailer"),
        ),
    )
