"""Rehearsed drives on stand-ins: how they begin, and what is asked of them."""

import numpy as np

from drawbar.config import load_configuration
from drawbar.driving.stand_in.rehearsal import Rehearsal
from drawbar.signals import Flag
from drawbar.simulation import build_path

SEED = 3


def rehearse(*changes, devices=None):
    configuration = load_configuration("articulated", ["path.radii=[8.0]", "safety.engage.wiggle_test=false", *changes])
    configuration = configuration.model_copy(update={"devices": devices})
    path, _ = build_path(configuration)
    return Rehearsal(configuration, path, SEED, configuration.safety), path


def errors(steps, path):
    """Return true distances (n, 2) of both bodies from the path while engaged, m."""
    found, near = [], [0.0, 0.0]
    for record, truth in steps:
        if not record.flags & Flag.RELEASED and record.status.is_new_command:
            row = []
            for body, pose in enumerate((truth.tractor, truth.trailer)):
                near[body], error = path.project(pose.x, pose.y, near[body] - 5.0, near[body] + 5.0)
                row.append(error)
            found.append(row)
    return np.abs(np.array(found))


def drive_until(rehearsal, state, longest=40.0):
    for _ in rehearsal.run(longest):
        if rehearsal.gate_state.state is state:
            return
    raise AssertionError(f"{state.name} was not reached; {rehearsal.gate_state}")


def released_after(rehearsal, longest):
    """Return the time until the gate steers no more, s."""
    begin = rehearsal.time
    while rehearsal.gate_state.steers and rehearsal.time < begin + longest:
        rehearsal.advance()
    assert not rehearsal.gate_state.steers
    return rehearsal.time - begin
