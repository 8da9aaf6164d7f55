"""Steering memory: dead time, lag and rate of both steerings from the log of a drive, where they can be relied on."""

import math
from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise

from drawbar.config import Configuration
from drawbar.driving.preparation.hand_calibration import CalibrationResult
from drawbar.estimation.actuation_settings import SteeringMemories, SteeringMemory
from drawbar.estimation.identification import identify
from drawbar.machine.calibration.calibrated import Calibrated
from drawbar.signals import Actuation, Flag, StepRecord
from drawbar.statuses import Status
from drawbar.vehicle.parameters import STEERINGS

_SHORTEST = 40.0
"""time of steering without a gap in which something may be found, s"""
_DEAD_TIME = 0.05
"""largest deviation of a dead time, s"""
_SHARE = 0.2
"""largest deviation of a lag, and of a rate, in shares of itself"""
_AGREE = 3.0
"""standard deviations by which both halves of the steering may differ"""
_SLOWER = 0.9
"""of the stated rate, below which the rate is shown to be another"""
_QUANTITIES = (("dead_time", "{}: dead time", "s"), ("lag", "{}: lag", "s"), ("rate", "{}: rate", "rad/s"))
"""name in a memory, what it is called of a steering, unit"""


def longest_steering(records: Sequence[StepRecord]) -> list[StepRecord]:
    """Return the longest stretch in which drawbar steered and no step is missing."""
    steered = list(filter(_is_steered, records))
    stretches = groupby(enumerate(steered), key=lambda each: each[1].step - each[0])
    return max(([record for _, record in stretch] for _, stretch in stretches), key=len, default=[])


def _is_steered(record: StepRecord) -> bool:
    """Return whether drawbar steered in a step: a run that has ended while somebody else drives is not flagged."""
    return not record.flags & Flag.RELEASED and not Status(record.status).has_ended


def steering_memory(configuration: Configuration, records: Sequence[StepRecord]) -> Iterator[CalibrationResult]:
    """Yield what a drive shows of both steerings; nothing where drawbar did not steer.

    Both halves of its longest steering are evaluated, too, and must agree with the whole.

    Args:
        configuration: of the drive.
        records: its steps.

    Raises:
        CompilerError: the identification could not be compiled.
    """
    steered = longest_steering(records)
    if len(steered) < 2:
        return
    seconds, half = len(steered) * configuration.sample_time, len(steered) // 2
    refusals = []
    if seconds < _SHORTEST:
        refusals.append(f"{seconds:.0f} s of steering without a gap; let drawbar steer for a minute")
    if any(_is_steered(before) and record.status == Status.STEERING for before, record in pairwise(records)):
        refusals.append("a steering did not follow its commands; look at its sensor and its actuator, and drive again")
    found = [_identified(configuration, part) for part in (steered, steered[:half], steered[half:])]
    for body, name in STEERINGS.items():
        stated = getattr(configuration.vehicle, f"{body}_steering_rate")
        known = getattr(configuration.actuation.remembered, body).rate
        for quantity, title, unit in _QUANTITIES:
            values = [getattr(getattr(each, body), quantity) for each in found]
            if quantity == "rate" and known is None and values[0] > _SLOWER * stated:
                continue  # commands never asked for more
            deviations = [getattr(getattr(each, body), f"{quantity}_deviation") for each in found]
            value = Calibrated(
                value=values[0],
                deviation=deviations[0],
                unit=unit,
                refusals=(*refusals, *_doubts(quantity, values, deviations)),
            )
            key = f"actuation.remembered.{body}.{quantity}"
            sets = {key: round(values[0], 3)} if value.accepted else {}
            yield CalibrationResult(name=title.format(name), value=value, sets=sets)


def _identified(configuration: Configuration, steered: Sequence[StepRecord]) -> Actuation:
    """Return what a stretch shows by itself. A remembered rate stays the prior: planned with, it is hardly exceeded."""
    memory = configuration.actuation.remembered
    rates = {body: SteeringMemory(rate=getattr(memory, body).rate) for body in STEERINGS}
    settings = configuration.actuation.model_copy(update={"remembered": SteeringMemories(**rates)})
    steps = ((record.measurement, record.command) for record in steered)
    return identify(steps, configuration.vehicle, settings, configuration.sample_time)


def _doubts(quantity: str, values: Sequence[float], deviations: Sequence[float]) -> Iterator[str]:
    """Yield why a value cannot be relied on; values and deviations: of all, of the first and of the second half."""
    if deviations[0] > (_DEAD_TIME if quantity == "dead_time" else _SHARE * values[0]):
        yield "known too roughly; let drawbar steer through curves, and onto its line from a metre beside it"
    if abs(values[2] - values[1]) > _AGREE * math.hypot(deviations[1], deviations[2]):
        yield f"{values[1]:.2f} in the first half and {values[2]:.2f} in the second; drive again"
