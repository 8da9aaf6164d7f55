"""How exactly a step is recorded: all numbers bit for bit, predictions to a millionth of a metre or radian.

Predictions (the path ahead of both bodies, planned poses and steerings) are most of a step's numbers; the digits beyond
would be more than half of a log. Nothing that is commanded, measured or estimated is rounded.
"""

from dataclasses import replace

import numpy as np

from drawbar.signals import BodyPlan, BodyReference, StepRecord

DIGITS = 6
"""decimals of predictions, m and rad"""


def as_recorded(record: StepRecord) -> StepRecord:
    """Return a step as a log holds it."""
    reference, plan = record.reference, record.plan
    return replace(
        record,
        reference=replace(reference, tractor=_reference(reference.tractor), trailer=_reference(reference.trailer)),
        plan=replace(plan, tractor=_plan(plan.tractor), trailer=_plan(plan.trailer)),
    )


def _reference(body: BodyReference) -> BodyReference:
    return replace(body, samples=np.round(body.samples, DIGITS))


def _plan(body: BodyPlan) -> BodyPlan:
    return replace(body, poses=np.round(body.poses, DIGITS), steerings=np.round(body.steerings, DIGITS))
