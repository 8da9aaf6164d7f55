"""A yaw-rate sensor that the control step does not believe any more: what it has led the estimate to is undone."""

import random
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from ordinary import measured
from rehearsals import drive_until, rehearse

from drawbar.driving.fault_detection.wrong_yaw_rate import WrongYawRate
from drawbar.geometry import wrap
from drawbar.messages import SupervisorState
from drawbar.safety.causes import Cause


def test_the_step_is_followed_once_and_the_sensor_excluded_for_as_long_as_it_did():
    remaining = np.zeros(1)
    live = SimpleNamespace(array={"yaw_rate.exclusion": remaining}.__getitem__)
    rate = WrongYawRate(SimpleNamespace(library=SimpleNamespace(components={"alignment": SimpleNamespace(live=live)})))
    for time, excluded in ((0.0, False), (60.0, True), (59.8, False), (60.0, False), (0.0, False), (58.0, True)):
        remaining[0] = time
        assert rate.update() is excluded
    remaining[0] = 0.0  # recalled
    given = measured(0.0, 0.0, 0.0, 0.0)
    assert rate.excluded(given) is given
    assert remaining[0] == 58.0


def stuck_in_a_curve(rehearsal):
    """Let the tractor's yaw rate be measured, and repeat one value from 12 m into the curve on."""
    controller, world = rehearsal.loop._controller, rehearsal.machine.world
    feedback, chance, seen, kept = controller.feedback, random.Random(1), [], []

    def measured_too(measurement, now):
        seen.append((rehearsal.time, world.truth.tractor.yaw))
        (earlier, before), (later, yaw) = seen[0], seen[-1]
        del seen[:-1]
        true = wrap(yaw - before) / (later - earlier) if later > earlier else 0.0
        if world.truth.tractor.x > 12.0 or kept:
            kept.append(true)
            true = kept[0]
        return feedback(replace(measurement, tractor_yaw_rate=true + chance.gauss(0.0, 0.005)), now)

    controller.feedback = measured_too


def test_one_that_sticks_in_a_curve_is_undone_once_and_the_operator_is_told(monkeypatch):
    rehearsal, _ = rehearse("speed=2.0", "path.straight_length=15.0", "safety.engage.fixed=1.0")
    controller, undone = rehearsal.loop._controller, []
    recompute = controller._rollback.recompute
    monkeypatch.setattr(controller._rollback, "recompute", lambda change: (undone.append(change), recompute(change))[1])
    stuck_in_a_curve(rehearsal)
    drive_until(rehearsal, SupervisorState.ACTIVE)
    for record, _ in rehearsal.run(11.0):
        told = Cause.YAW_REJECTED.value in controller._faults.notices
        assert told is bool(undone), record.estimate.time
    assert len(undone) == 1
