"""Recorded runs against the declared bounds of a tube."""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drawbar.config import Configuration
from drawbar.control.settings import BodyTubeSettings, Nominal
from drawbar.control.tube.bodies import Body
from drawbar.control.tube.error_model import ErrorModel
from drawbar.control.tube.identification import Identified, identified
from drawbar.errors import DrawbarError
from drawbar.geometry import Floats
from drawbar.recording.log import RunLog

CONFIDENCE = 0.95


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One declared bound against what was recorded."""

    section: str
    name: str
    unit: str
    magnitudes: Floats
    """(k,), in the unit"""
    declared: float
    """0 where it is not declared"""

    @property
    def beyond(self) -> int:
        """Samples that exceed the declared bound."""
        return int(np.count_nonzero(self.magnitudes > self.declared))

    @property
    def proposed(self) -> float:
        """The largest sample, rounded up to two significant digits."""
        largest = float(self.magnitudes.max(initial=0.0))
        if not largest > 0.0:
            return 0.0
        digit = 10.0 ** (np.floor(np.log10(largest)) - 1.0)
        return float(f"{np.ceil(largest / digit) * digit:.2g}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """Samples of one body that follow each other in a run, as its error model sees them."""

    deviations: Floats
    """x^ - x̄ (k, n)"""
    corrections: Floats
    """u - ū (k,), rad"""
    estimate_errors: Floats
    """x^ - x (k, n), NaN where the truth is not known"""
    nominal: Nominal


def coverage(samples: int) -> float:
    """Return the share of all samples that the largest of these bounds, with CONFIDENCE (Wilks 1941).

    It counts the samples as independent; what drifts slowly has seen less of its range than they pretend.
    """
    return float((1.0 - CONFIDENCE) ** (1.0 / max(samples, 1)))


def recordings(file: Path, log: RunLog, configuration: Configuration, name: str, model: ErrorModel) -> list[Recording]:
    """Return what a log, read from a file, holds of the body of this name: each of its stretches without lost steps.

    Raises:
        DrawbarError: it was driven with other models or an optimised nominal state.
    """
    driven = tomllib.loads(log.header.configuration)  # perhaps of another version of drawbar
    model_name, sample_time, nominal = driven["controller"]["model"], driven["sample_time"], driven["tube"]["nominal"]
    same = (model_name, sample_time) == (configuration.controller.model, configuration.sample_time)
    if not same or nominal == Nominal.OPTIMISED:
        raise DrawbarError(
            f"{file}: was driven with controller.model = {model_name!r}, sample_time = {sample_time} s, tube.nominal = "
            f"{nominal!r}; one-step errors need those of the given configuration ({configuration.controller.model!r}, "
            f"{configuration.sample_time} s) and a nominal state that is 'predicted' or 'propagated'"
        )
    deviations = [getattr(record.plan, name).deviation for record in log.records]
    n = len(model.states)
    if not deviations or any(len(deviation) != n for deviation in deviations):
        raise DrawbarError(f"{file}: holds no deviations of the {name} from its nominal state; drive the run again")
    corrections = log.column(f"{name}_steering.command") - log.column(f"{name}_steering.nominal")
    errors = _estimate_errors(log, name, model.states)
    gaps = np.flatnonzero(np.diff([record.step for record in log.records]) != 1) + 1
    stretches = zip(*(np.split(values, gaps) for values in (np.array(deviations), corrections, errors)), strict=True)
    return [
        Recording(deviations=x, corrections=u, estimate_errors=eps, nominal=Nominal(nominal)) for x, u, eps in stretches
    ]


def findings(recorded: Sequence[Recording], body: Body, settings: BodyTubeSettings) -> list[Finding]:
    """Return what the recordings of one body show of each of its bounds."""
    parts = [
        identified(
            body.model,
            body.explaining,
            recording.nominal,
            deviations=recording.deviations,
            corrections=recording.corrections,
            estimate_errors=recording.estimate_errors,
        )
        for recording in recorded
    ]
    return [_finding(settings, same) for same in zip(*parts, strict=True)]


def _finding(settings: BodyTubeSettings, same: tuple[Identified, ...]) -> Finding:
    first = same[0]
    return Finding(
        section=first.section,
        name=first.name,
        unit=first.unit,
        magnitudes=np.concatenate([one.magnitudes for one in same]),
        declared=getattr(settings, first.section).get(first.name, 0.0),
    )


def _estimate_errors(log: RunLog, name: str, states: tuple[str, ...]) -> Floats:
    """Return x^ - x (k, n) in the coordinates of the body's error model."""

    def error(column: str) -> Floats:
        return log.column(f"estimate.{column}") - log.column(f"truth.{column}")

    yaw = log.column(f"truth.{name}.yaw")
    errors = {
        "lateral": np.cos(yaw) * error(f"{name}.y") - np.sin(yaw) * error(f"{name}.x"),
        "yaw": _wrapped(error(f"{name}.yaw")),
        "articulation": _wrapped(error("tractor.yaw") - error("trailer.yaw")),
        "steering": error(f"{name}_steering"),
    }
    return np.column_stack([errors[state] for state in states])


def _wrapped(angles: Floats) -> Floats:
    return np.asarray(np.remainder(angles + np.pi, 2.0 * np.pi) - np.pi)
