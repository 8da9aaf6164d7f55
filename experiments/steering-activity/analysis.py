"""How much the product steers on a straight for its errors, and the least that any linear controller could."""

import itertools
import math
import sys
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drawbar.config import Configuration
from drawbar.experiment.elements import Element, Picture, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.task import Result
from drawbar.geometry import Floats
from drawbar.report.style import INK, REFERENCE, TRACTOR, TRAILER
from drawbar.vehicle.parameters import BODIES

sys.path.insert(0, str(Path(__file__).parent))
from linear_limit import ANSWER_TIME, Front, assumed_straight, front, straight

SETTLED = 20.0
"""way after which a run counts, m"""
SPEEDS = {"1 m/s": 1.0, "2 m/s": 2.0}
SLOPE, SLOPE_BEGINS = "{}, side slope of 1°", 60.0
"""name of the variant of a speed in which a side slope begins, and when that is, s"""
EXPECTED_SLOPES = (0.0, 0.0003, 0.0006, 0.001, 0.0014, 0.002, 0.003, 0.005)
"""random walks of a slope per sample that designs expect, rad; none: they know the ground to be flat"""
MORE = 0.1
"""error beyond a case's own that half its activity may cost, cm"""
RATES = {"1 m/s": (6.0, 5.0, 4.0, 3.0, 2.5, 2.0, 1.5), "2 m/s": (10.0, 8.0, 6.0, 4.0, 3.0, 2.0)}
"""°/s"""


@dataclass(frozen=True, slots=True)
class Fronts:
    """Least errors of linear controllers at a speed, from those that know the ground to be flat on."""

    by_slope: tuple[Front, ...]

    @property
    def flat(self) -> Front:
        """Return the least of all."""
        return self.by_slope[0]

    def error_at(self, rate: float, answer: float) -> float:
        """Return the least error (cm) at a steering rate (°/s), at most `answer` (cm) off after a slope."""
        return _at([(_both(each.answer_at(rate)), each.error_at(rate)) for each in self.by_slope], answer)

    def rate_at(self, error: float, answer: float) -> float:
        """Return the least steering rate (°/s) at an error (cm), at most `answer` (cm) off after a slope."""
        rates = [(each, each.rate_at(error)) for each in self.by_slope]
        return _at([(_both(each.answer_at(rate)), rate) for each, rate in rates], answer)


FrontsBySpeed = Mapping[str, Fronts]


def _at(points: list[tuple[float, float]], answer: float) -> float:
    """Return what points (answer, wanted) have at an answer; more than the largest is that of the largest."""
    known = sorted(point for point in points if all(map(math.isfinite, point)))
    if not known:
        return math.nan
    answers, wanted = zip(*known, strict=True)
    return float(np.interp(answer, answers, wanted, left=math.nan))


def _both(distances: Sequence[float] | Floats) -> float:
    """Return the root mean square over both bodies."""
    return float(np.sqrt(np.mean(np.square(distances))))


def figures(result: Result) -> dict[str, float]:
    """Return mean errors and what estimates are off by, cm, and mean steering rates, °/s, by body and of both."""
    columns = result.columns
    counts = columns["truth.tractor.x"] > SETTLED
    step = float(np.median(np.diff(columns["measurement.time"])))
    found: dict[str, float] = {}
    for body in BODIES:
        error, angle = (columns[name][counts] for name in (f"error.{body}", f"truth.{body}_steering"))
        off = (columns[f"estimate.{body}.y"] - columns[f"truth.{body}.y"])[counts]
        found |= {
            f"{body} error": 100.0 * float(abs(error).mean()),
            f"{body} rate": float(np.degrees(abs(np.diff(angle)).mean() / step)),
            f"{body} estimate": 100.0 * float(off.std()),
        }
    return found | {name: 0.5 * sum(found[f"{body} {name}"] for body in BODIES) for name in ("error", "rate")}


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the tables of what half the activity costs, of all cases and of the limits, the picture, and a check."""
    fronts = {variant: _fronts(speed) for variant, speed in SPEEDS.items()}
    yield _halves(measured, fronts)
    yield _activity(measured, fronts)
    yield Picture(
        name="activity",
        caption="Mean distance from the line against mean steering rate, each the mean of both bodies and of the "
        "seeds, on a straight. No linear estimator and controller gets below the solid line; the dashed one is of "
        "those that answer a side slope as the product does.",
        draw=lambda figure: _draw(figure, measured, fronts),
    )
    yield _limits(measured, fronts)
    yield _estimates(measured)


def _fronts(speed: float) -> Fronts:
    world = straight(speed)
    return Fronts(tuple(front(world, straight(speed, slope)) for slope in EXPECTED_SLOPES))


def _halves(measured: MeasuredExperiment, fronts: FrontsBySpeed) -> Table:
    rows = []
    for variant, case in itertools.product(SPEEDS, ("articulated", "before")):
        error, rate = (measured.statistic(f"{case}: {variant}", name).mean for name in ("error", "rate"))
        least, answer = fronts[variant], _both(_answer(measured, "articulated", variant))
        costs = [each - error for each in (least.flat.error_at(0.5 * rate), least.error_at(0.5 * rate, answer))]
        calm = [each / rate for each in (least.flat.rate_at(error + MORE), least.rate_at(error + MORE, answer))]
        cells = [f"{error:.2f}", f"{rate:.2f}", *(_cell(each, "+.2f") for each in costs)]
        rows.append([f"{case}: {variant}", *cells, *(_cell(100.0 * each, ".0f") for each in calm)])
    return Table(
        name="halves",
        caption="Mean error, cm, and steering rate, °/s; what half that rate costs at least, cm, and which share of "
        "it, %, 1 mm more error leaves at least: on ground known to be flat, and where a slope is answered as the "
        "product does (–: none does).",
        header=["", "error", "rate", "half: flat", "half: slopes", "1 mm more: flat", "1 mm more: slopes"],
        rows=rows,
    )


def _activity(measured: MeasuredExperiment, fronts: FrontsBySpeed) -> Table:
    rows = []
    for variant in SPEEDS:
        for case in measured.experiment.settings.cases:
            of = f"{case.name}: {variant}"
            error, rate = (measured.statistic(of, name) for name in ("error", "rate"))
            least, answer = fronts[variant], _answer(measured, case.name, variant)
            errors = least.flat.error_at(rate.mean), least.error_at(rate.mean, _both(answer))
            rates = least.flat.rate_at(error.mean), least.rate_at(error.mean, _both(answer))
            cells = [error.text(2), *map(_cell, errors), rate.text(2), *map(_cell, rates)]
            rows.append([of, measured.finished(of), *cells, " / ".join(f"{each:.2f}" for each in answer)])
    return Table(
        name="activity",
        caption="Mean distance from the line, cm, and mean steering rate, °/s, each the mean of both bodies. Beside "
        "the error the least of any linear estimator and controller at this steering rate, on ground known to be flat "
        "and of those that answer a slope like this case; beside the rate the least at this error. Last: distance of "
        "tractor / trailer, root mean square of the mean of all seeds in the "
        f"{ANSWER_TIME:.0f} s after a side slope of 1° has begun, cm. –: none does.",
        header=["case", "finished", "error", "flat", "slopes", "rate", "flat", "slopes", "after a slope"],
        rows=rows,
    )


def _cell(value: float, form: str = ".2f") -> str:
    return format(value, form) if math.isfinite(value) else "–"


def _answer(measured: MeasuredExperiment, case: str, variant: str) -> Floats:
    """Return what a slope does to tractor and trailer, root mean squares, cm: the same noise without it taken off."""
    pairs = zip(*(measured.runs[f"{case}: {each}"].results for each in (SLOPE.format(variant), variant)), strict=True)
    differences = []
    for sloping, flat in pairs:
        time = flat.columns["measurement.time"]
        after = np.flatnonzero((time > SLOPE_BEGINS) & (time <= SLOPE_BEGINS + ANSWER_TIME))
        errors = [[run.columns[f"error.{body}"][after] for body in BODIES] for run in (sloping, flat)]
        differences.append(np.subtract(*errors))
    answer: Floats = 100.0 * np.sqrt(np.mean(np.square(np.mean(differences, axis=0)), axis=1))
    return answer


def _limits(measured: MeasuredExperiment, fronts: FrontsBySpeed) -> Table:
    rows = []
    for variant, rates in RATES.items():
        answer = _both(_answer(measured, "articulated", variant))
        for rate in rates:
            least = fronts[variant]
            flat = [_cell(least.flat.error_at(rate)), " / ".join(map(_cell, least.flat.answer_at(rate)))]
            rows.append([variant, f"{rate:.1f}", *flat, _cell(least.error_at(rate, answer))])
    return Table(
        name="limits",
        caption="The least mean error at a steering rate, °/s, and what that controller lets a side slope of 1° do, "
        "cm, as above; last, the least where a slope is answered as the product does (–: by none).",
        header=["", "rate", "flat", "after a slope", "slopes"],
        rows=rows,
    )


def _estimates(measured: MeasuredExperiment) -> Table:
    rows = []
    for variant, speed in SPEEDS.items():
        world = straight(speed)
        designs = {"the truth": world, "the truth, and slopes": straight(speed, 0.001)}
        for case in ("articulated", "flat ground"):
            settings = measured.experiment.configurations[f"{case}: {variant}"]
            configuration = Configuration.model_validate(tomllib.loads(settings))
            designs[case] = assumed_straight(speed, configuration.estimator, configuration.sensors)
        for name, design in designs.items():
            reached = front(world, design)
            linear = [f"{100.0 * each:.2f}" for each in reached.points[0].estimates]
            of = f"{name}: {variant}"
            there = of in measured.cases
            driven = [measured.statistic(of, f"{body} estimate").text(2) if there else "" for body in BODIES]
            error = measured.statistic(f"articulated: {variant}", "error").mean
            rows.append([variant, name, *linear, *driven, _cell(reached.rate_at(error))])
    return Table(
        name="estimates",
        caption="Standard deviation of what the estimates of both distances are off by, cm: of a Kalman filter with "
        "the assumptions of each row, and driven. Last: the steering rate of the best regulator on that filter at the "
        "product's error, °/s.",
        header=["", "", *(f"{body}, {how}" for how in ("linear", "driven") for body in BODIES), "rate"],
        rows=rows,
    )


def _draw(figure: Figure, measured: MeasuredExperiment, fronts: FrontsBySpeed) -> None:
    for axes, variant in zip(figure.subplots(1, len(SPEEDS)), SPEEDS, strict=True):
        least, answer = fronts[variant], _both(_answer(measured, "articulated", variant))
        rates = [point.rate for point in least.flat.points]
        axes.plot(rates, [point.error for point in least.flat.points], label="least, flat ground", color=INK)
        slopes = [least.error_at(rate, answer) for rate in rates]
        axes.plot(rates, slopes, label="least, slopes answered", color=REFERENCE, ls="--")
        _draw_cases(axes, measured, variant)
        axes.set(title=variant, xlabel="steering rate, °/s", ylabel="error, cm")
        axes.legend(loc="upper right")


def _draw_cases(axes: Axes, measured: MeasuredExperiment, variant: str) -> None:
    drawn = []
    for case in measured.experiment.settings.cases:
        error, rate = (measured.statistic(f"{case.name}: {variant}", name) for name in ("error", "rate"))
        colour = TRAILER if case.name.startswith("flat") else TRACTOR
        axes.errorbar(rate.mean, error.mean, yerr=error.half_width, marker="o", ms=3.5, color=colour)
        axes.annotate(case.name, (rate.mean, error.mean), xytext=(5, 4), textcoords="offset points", fontsize=7)
        drawn.append((rate.mean, error.mean))
    rates, errors = zip(*drawn, strict=True)
    axes.set(xlim=(0.0, 1.3 * max(rates)), ylim=(min(errors) - 0.15, max(errors) + 0.2))
