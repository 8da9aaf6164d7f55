"""The order of one control step, and that a whole run does not care where it takes place."""

import math
from dataclasses import replace

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.guidance.path import Path
from drawbar.machine.base import Machine
from drawbar.signals import BodyPlan, BodySteering, GateVerdict, Plan, SolverStatus
from drawbar.step.autopilot import Autopilot
from drawbar.step.build import build_autopilot, build_path, planned_speed

STEPS = 150
ACTING = "the command that acts"


class Part:
    """Any part of the autopilot: writes down what it is asked for, and answers as told."""

    def __init__(self, name, calls, **answers):
        self._name, self._calls, self._answers = name, calls, answers

    def __getattr__(self, name):
        if name == "times":
            return self._answers["times"]

        def call(*arguments):
            self._calls.append((f"{self._name}.{name}", arguments))
            answer = self._answers.get(name)
            return answer(*arguments) if callable(answer) else answer

        return call


def steering(command):
    return BodySteering(nominal=command, ancillary=0.0, command=command, saturated=False)


@pytest.fixture
def faked(simulate):
    """Return an autopilot made of fakes that repeat one recorded step, the calls it makes, and that step."""
    record = simulate("articulated").records[100]
    calls = []
    ahead = replace(record.estimate, time=record.estimate.time + 0.4)  # where the commands under way lead
    autopilot = Autopilot(
        machine=Part("machine", calls, read=record.measurement, truth=record.truth),
        estimator=Part("estimator", calls, update=record.estimate, times=record.estimator_times),
        predictor=Part("predictor", calls, ahead=ahead, sent=ACTING),
        guidance=Part("guidance", calls, reference=record.reference),
        controller=Part("controller", calls, feedback=record.plan, times=(record.tractor_times, record.trailer_times)),
        tractor_law=Part("tractor_law", calls, apply=steering(0.11)),
        trailer_law=Part("trailer_law", calls, apply=steering(-0.22)),
        gate=Part("gate", calls, check=lambda command: (replace(command, speed=0.7), GateVerdict.LIMITED)),
        speed=1.2,
        planned_speed=-math.inf,
    )
    return autopilot, calls, record


def test_one_step_is_the_block_diagram(faked):
    autopilot, calls, record = faked
    made = autopilot.step()
    names = [name for name, _ in calls]
    order = ["machine.read", "estimator.update", "predictor.ahead", "guidance.reference", "controller.feedback"]
    laws = ["tractor_law.apply", "trailer_law.apply", "gate.check", "machine.write"]
    assert [name for name in names if name != "machine.truth"] == [
        *order,
        *laws,
        "predictor.sent",
        "estimator.prepare",
        "controller.prepare",
    ]
    assert names.index("machine.truth") < names.index("machine.write")  # the truth is that of the measurement
    given = dict(calls)
    assert given["estimator.update"] == (record.measurement,)
    assert given["predictor.ahead"] == (record.estimate,)
    ahead = replace(record.estimate, time=record.estimate.time + 0.4)
    assert given["guidance.reference"] == (ahead,)
    assert given["controller.feedback"] == (ahead, record.reference)
    assert given["tractor_law.apply"] == (record.plan.tractor,)
    assert given["trailer_law.apply"] == (record.plan.trailer,)
    (asked,) = given["gate.check"]
    assert (asked.tractor_steering, asked.trailer_steering, asked.speed) == (0.11, -0.22, 1.2)
    assert asked.time == record.measurement.time
    assert given["machine.write"] == given["predictor.sent"] == (replace(asked, speed=0.7),)
    assert given["estimator.prepare"] == (ACTING,)
    assert made.command == replace(asked, speed=0.7)
    assert made.gate is GateVerdict.LIMITED  # as the gate said


@pytest.mark.parametrize(("estimated", "planned"), [(0.3, 1.2), (1.3, 1.3), (-0.1, 1.2), (float("nan"), float("nan"))])
def test_plans_reckon_with_the_set_speed_at_least(faked, estimated, planned):
    autopilot, calls, record = faked
    autopilot.planned_speed = 1.2
    autopilot.predictor = Part("predictor", calls, ahead=replace(record.estimate, speed=estimated), sent=ACTING)
    autopilot.step()
    ((given,), (handed, _)) = (dict(calls)[name] for name in ("guidance.reference", "controller.feedback"))
    np.testing.assert_equal((given.speed, handed.speed), (planned, planned))
    assert dict(calls)["predictor.ahead"] == (record.estimate,)


def test_only_plans_along_a_preview_reckon_with_the_set_speed():
    assert planned_speed(load_configuration("articulated", ["speed=0.7"])) == 0.7
    assert planned_speed(load_configuration("paper", ["speed=0.7"])) == -math.inf


def test_steps_are_counted_from_zero_and_failures_with_them(faked):
    autopilot, _, record = faked
    assert [autopilot.step().step for _ in range(3)] == [0, 1, 2]
    assert autopilot.step().solver_failures == 0
    failed = replace(record.plan.tractor, status=SolverStatus.CHECK_FAILED)
    assert isinstance(failed, BodyPlan)
    plan = Plan(time=0.0, tractor=failed, trailer=replace(failed, status=SolverStatus.INFEASIBLE))
    autopilot.controller = Part("controller", [], feedback=plan, times=(record.tractor_times, record.trailer_times))
    assert autopilot.step().solver_failures == 2


class Replayed(Machine):
    """Reports recorded measurements, whatever it is commanded."""

    def __init__(self, measurements):
        self._measurements, self._sample = measurements, 0

    def read(self):
        return self._measurements[self._sample]

    def write(self, command):
        self._sample += 1

    def truth(self):
        return None


def transformed_path(path, transform, sign, turn):
    arc_length, x, y, yaw = path.nodes.T
    moved = transform(x + 1j * y)
    return Path.through(
        arc_length=arc_length,
        x=moved.real,
        y=moved.imag,
        yaw=sign * yaw + turn,
        label_of_piece=path.label_of_piece,
        label_names=path.label_names,
    )


def transformed_measurement(measurement, transform, sign):
    tractor = transform(complex(measurement.tractor_x, measurement.tractor_y))
    trailer = transform(complex(measurement.trailer_x, measurement.trailer_y))
    return replace(
        measurement,
        tractor_x=tractor.real,
        tractor_y=tractor.imag,
        trailer_x=trailer.real,
        trailer_y=trailer.imag,
        hitch_angle=sign * measurement.hitch_angle,
        tractor_steering=sign * measurement.tractor_steering,
        trailer_steering=sign * measurement.trailer_steering,
    )


def replay(run, name, transform, sign=1.0, turn=0.0):
    """Feed a recorded run's measurements to a new autopilot in a moved world: its estimates and commands."""
    measurements = [transformed_measurement(r.measurement, transform, sign) for r in run.records[: STEPS + 1]]
    configuration = load_configuration(name)
    path, _ = build_path(configuration)
    autopilot = build_autopilot(configuration, transformed_path(path, transform, sign, turn), Replayed(measurements))
    return [autopilot.step() for _ in range(STEPS)]


@pytest.mark.parametrize("name", ["articulated", "paper"])
@pytest.mark.parametrize("turn", [0.4, math.pi / 2, 2.9, -2.0])
def test_a_run_does_not_care_where_and_which_way_it_goes(simulate, name, turn):
    run = simulate(name)

    def transform(point):
        return np.exp(1j * turn) * point + (250.0 - 120.0j)

    for here, there in zip(run.records, replay(run, name, transform, turn=turn), strict=False):
        assert there.command.tractor_steering == pytest.approx(here.command.tractor_steering, abs=1e-9)
        assert there.command.trailer_steering == pytest.approx(here.command.trailer_steering, abs=1e-9)
        assert there.reference.tractor.progress == pytest.approx(here.reference.tractor.progress, abs=1e-9)
        moved = transform(complex(here.estimate.trailer.x, here.estimate.trailer.y))
        assert (there.estimate.trailer.x, there.estimate.trailer.y) == pytest.approx((moved.real, moved.imag), abs=1e-9)


@pytest.mark.parametrize("name", ["articulated", "paper"])
def test_a_run_in_the_mirror_steers_the_other_way(simulate, name):
    run = simulate(name)
    for here, there in zip(run.records, replay(run, name, np.conj, sign=-1.0), strict=False):
        assert there.command.tractor_steering == pytest.approx(-here.command.tractor_steering, abs=1e-9)
        assert there.command.trailer_steering == pytest.approx(-here.command.trailer_steering, abs=1e-9)
        assert there.reference.tractor.lateral_error == pytest.approx(-here.reference.tractor.lateral_error, abs=1e-9)


@pytest.mark.parametrize("name", ["articulated", "paper"])
def test_a_replay_gives_the_commands_of_the_run(simulate, name):
    run = simulate(name)
    for here, there in zip(run.records, replay(run, name, lambda point: point), strict=False):
        assert there.command == here.command
        assert there.estimate == here.estimate
