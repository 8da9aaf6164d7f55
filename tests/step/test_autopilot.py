"""The autopilot that Python drives: a whole run does not care where it takes place, and its records are complete."""

import math
from contextlib import closing
from dataclasses import replace
from operator import attrgetter

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.errors import DrawbarError, PathError
from drawbar.guidance.path import Path
from drawbar.signals import Flag, Status
from drawbar.simulation import build_path
from drawbar.step.build import build_autopilot, step_settings

STEPS = 150


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
    """Feed a recorded run's measurements to a new autopilot in a moved world: its records."""
    configuration = load_configuration(name)
    path, _ = build_path(configuration)
    autopilot = build_autopilot(configuration)
    autopilot.begin(transformed_path(path, transform, sign, turn))
    records = []
    for record in run.records[:STEPS]:
        autopilot.feedback(transformed_measurement(record.measurement, transform, sign))
        autopilot.prepare()
        records.append(autopilot.record())
    return records


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


def test_a_record_holds_the_whole_step(simulate):
    run = simulate("articulated", "actuation.identify=false")  # a reference is that of the estimate when commands act
    for step, record in enumerate(run.records[:STEPS]):
        assert record.step == step
        assert record.status is Status.OK
        assert record.flags in (Flag(0), Flag.LIMITED)
        for body in ("tractor", "trailer"):
            reference, plan = getattr(record.reference, body), getattr(record.plan, body)
            assert (plan.poses.shape, plan.steerings.shape) == ((21, 3), (20,))
            assert np.isfinite(reference.closest).all()
            # what is planned begins where the body will be when the command acts
            distance = math.hypot(*(plan.poses[0][:2] - reference.closest[:2]))
            assert distance == pytest.approx(abs(reference.lateral_error), abs=0.02)
            steering = getattr(record, f"{body}_steering")
            assert steering.nominal == plan.steering
        assert record.command.tractor_steering == pytest.approx(record.tractor_steering.command, abs=0.05)
        assert min(record.estimator_times.feedback, record.tractor_times.prepare, record.trailer_times.feedback) > 0.0


def test_later_steps_leave_a_record_alone(build):
    steps = build("articulated").steps()
    first = next(steps)
    poses, closest = first.plan.tractor.poses.copy(), first.reference.tractor.closest.copy()
    next(steps)
    np.testing.assert_array_equal(first.plan.tractor.poses, poses)
    np.testing.assert_array_equal(first.reference.tractor.closest, closest)


def test_predictions_are_rounded_to_a_millimetre_and_what_is_commanded_measured_or_estimated_is_not(build):
    simulation = build("articulated")
    with closing(simulation.steps()) as steps:
        record = [next(steps) for _ in range(20)][-1]
        for body in ("tractor", "trailer"):
            component, plan = simulation.autopilot.library.components[body].live, getattr(record.plan, body)
            for name in ("poses", "steerings"):
                exact = component.array(f"subsystem.{name}")
                np.testing.assert_array_equal(getattr(plan, name), np.rint(exact * 1024.0) / 1024.0)
            exact = component.array("subsystem.deviation")
            np.testing.assert_array_equal(plan.deviation, np.rint(exact * 2.0**20) / 2.0**20)
            progress = getattr(record.reference, body).progress
            assert progress == round(progress * 2.0**20) / 2.0**20 != round(progress, 3)
    for place in ("estimate.tractor.x", "command.tractor_steering", "tractor_steering.nominal", "truth.trailer.yaw"):
        value = attrgetter(place)(record)
        assert value != round(value, 4)


def test_what_a_step_did_not_come_to_is_not_a_number(build):
    simulation = build("articulated")
    first = next(simulation.steps()).measurement
    simulation.autopilot.feedback(replace(first, time=first.time))  # the clock stands still
    record = simulation.autopilot.record()
    assert record.status is Status.TIME
    assert math.isnan(record.estimate.tractor.x)
    assert np.isnan(record.plan.trailer.poses).all()
    assert np.isnan(record.reference.tractor.closest).all()


def test_only_plans_along_a_preview_reckon_with_the_set_speed():
    assert step_settings(load_configuration("articulated", ["speed=0.7"])).planned_speed == 0.7
    assert step_settings(load_configuration("paper", ["speed=0.7"])).planned_speed == -math.inf


def test_two_autopilots_of_one_library_do_not_know_of_each_other(simulate, build):
    alone = simulate("articulated").records[:20]
    one, other = build("articulated").steps(), build("articulated", "controller.tractor.lateral=30.0", seed=3).steps()
    for record in alone:
        next(other)
        assert next(one).command == record.command


def test_a_run_begins_anywhere_on_the_path(build):
    simulation = build("articulated", "start.ahead=4.9")  # on the first straight
    with pytest.raises(PathError, match="is not on the path"):
        simulation.autopilot.begin(simulation.path, at=1e6)
    simulation.autopilot.begin(simulation.path, at=6.0)
    record = next(simulation.steps())
    assert record.reference.tractor.progress == pytest.approx(4.9, abs=0.2)
    assert record.status is Status.OK


def test_the_speed_can_be_set_during_a_run(build):
    simulation = build("articulated")
    steps = simulation.steps()
    next(steps)
    simulation.autopilot.set_speed(0.5)
    with pytest.raises(DrawbarError, match=r"speed = 1.5 m/s is not allowed; give 0 to"):
        simulation.autopilot.set_speed(1.5)
    commanded = [next(steps).command.speed for _ in range(8)]
    np.testing.assert_allclose(commanded, [0.9, 0.8, 0.7, 0.6, 0.5, 0.5, 0.5, 0.5])


def drive_by_hand(simulation, steps):
    """Let a driver steer, and return the records."""
    autopilot, machine = simulation.autopilot, simulation.machine
    autopilot.set_engaged(False)
    records = []
    for step in range(steps):
        status, command = autopilot.feedback(machine.read())
        assert status is Status.OK
        machine.write(replace(command, tractor_steering=0.1 * math.sin(0.3 * step), speed=0.6))
        autopilot.prepare()
        records.append(autopilot.record(machine.truth()))
    return records


def test_while_it_is_not_engaged_the_command_is_the_steering_as_it_is(build):
    records = drive_by_hand(build("articulated"), 60)
    for record in records:
        assert record.flags & Flag.RELEASED
        assert record.command.speed == 0.0
        assert record.command.tractor_steering == pytest.approx(record.estimate.tractor_steering, abs=1e-12)
        # rounded to 1°, while the wheels turn, seen through a dead time
        assert abs(record.command.tractor_steering - record.truth.tractor_steering) < math.radians(3.0)
    estimated, true = records[-1].estimate.trailer, records[-1].truth.trailer
    assert math.hypot(estimated.x - true.x, estimated.y - true.y) < 0.1


def test_an_engagement_begins_with_the_steering_and_the_speed_as_they_are(build):
    simulation = build("articulated")
    last = drive_by_hand(simulation, 67)[-1]
    assert abs(last.reference.tractor.lateral_error) > 0.1
    simulation.autopilot.set_engaged(True)
    after = [record for record, _ in zip(simulation.steps(), range(100), strict=False)]
    first = after[0]
    assert not first.flags & Flag.RELEASED
    assert first.command.speed == pytest.approx(0.7, abs=0.1)  # from 0.6 m/s towards the set speed, by its ramp
    reach = simulation.configuration.machine.actuators.tractor_rate * (0.3 + 0.2)
    assert abs(first.command.tractor_steering - first.measurement.tractor_steering) < reach + math.radians(1.0)
    assert max(abs(r.reference.tractor.lateral_error) for r in after[60:]) < 0.08
    assert max(abs(r.reference.trailer.lateral_error) for r in after[60:]) < 0.08


def test_an_engagement_beside_the_line_joins_it_gently(build):
    simulation = build("articulated", "speed=2.0")
    beside = drive_by_hand(simulation, 67)[-1].reference.tractor.lateral_error
    assert abs(beside) > 0.2
    simulation.autopilot.set_engaged(True)
    after = [record for record, _ in zip(simulation.steps(), range(40), strict=False)]
    assert after[0].reference.tractor.lateral_error == pytest.approx(beside, abs=0.05)  # the line's, not the join's
    assert max(abs(record.command.tractor_steering) for record in after[:10]) < math.radians(9.0)  # 14 without a join
    assert all(abs(record.reference.tractor.lateral_error) < 0.08 for record in after[20:])


@pytest.mark.parametrize("seed", [0, 1])
def test_a_vehicle_whose_delays_are_not_reported_joins_the_line_without_crossing_it(build, seed):
    """With a jerk of 0.5 m/s³ it crosses the line by 9 cm."""
    delays = ("machine.actuators.dead_time=0.25", "machine.actuators.lag_factor=1.6")
    simulation = build("articulated", "start.left=0.3", "machine.sensors.position=0.01", *delays, seed=seed)
    errors = [record.truth.tractor.y for record, _ in zip(simulation.steps(), range(60), strict=False)]
    assert min(errors) > -0.05
    assert max(errors[25:]) < 0.08


def test_the_path_changes_under_the_vehicle_without_a_restart(build):
    simulation = build("articulated", "path.straight_length=40.0")
    steps = simulation.steps()
    for _ in range(50):
        record = next(steps)
    arc_length, x, y, yaw = simulation.path.nodes.T
    beside = Path.through(
        arc_length=arc_length,
        x=x - 0.3 * np.sin(yaw[0]),
        y=y + 0.3 * np.cos(yaw[0]),
        yaw=yaw,
        label_of_piece=simulation.path.label_of_piece,
        label_names=simulation.path.label_names,
    )
    progress = record.reference.tractor.progress
    with pytest.raises(PathError, match="not on the new path"):
        simulation.autopilot.change_path(beside, at=progress + 30.0)
    simulation.autopilot.change_path(beside, at=progress)
    after = [next(steps) for _ in range(40)]
    assert after[0].reference.tractor.lateral_error == pytest.approx(-0.3, abs=0.1)
    assert abs(after[-1].reference.tractor.lateral_error) < 0.05
    assert all(record.status is Status.OK for record in after)


def test_simulations_are_contexts_that_leave_the_machine_stopped(build):
    with build("articulated") as simulation:
        next(simulation.steps())
    assert simulation.machine._newest[2] == 0.0


def test_nodes_of_1_mm_are_a_path_though_their_arc_lengths_are_rounded():
    count = 20_000
    for offset in (0.0, 3e5):  # of the coordinates
        places = 0.001 * np.arange(count)
        assert np.diff(places).min() < 0.001
        zeros = np.zeros(count)
        label = np.zeros(count - 1, np.int8)
        path = Path.through(
            arc_length=places, x=offset + places, y=zeros, yaw=zeros, label_of_piece=label, label_names=("straight",)
        )
        build_autopilot(load_configuration("articulated")).begin(path)
