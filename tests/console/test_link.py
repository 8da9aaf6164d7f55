"""The console as a process: it joins a drive, its death is survived, its records are those of the drive."""

import json
import math
import signal
import socket
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_process import WAIT, console_process, reaches, until
from console_stage import Stage

from drawbar.config import load_configuration
from drawbar.console.drawing import Lines, moving, moving_by_hand, standing, tube_widths
from drawbar.console.thinning import kept_points
from drawbar.console.visitors import MOST, Rank, Visitors
from drawbar.driving.messaging.datagrams import PackedStep, pack
from drawbar.driving.messaging.process_options import CONSOLE
from drawbar.guidance.figure_eight import figure_eights
from drawbar.messages import Action, OperatorMessage
from drawbar.messages.records import decode
from drawbar.simulation import build_path
from drawbar.step.build import build_tubes
from drawbar.step.layout import packed
from drawbar.vehicle.parameters import Mast, Masts, VehicleParameters

NOTHING_DECLARED = [
    f"tube.{body}.{what}={{}}"
    for body in ("tractor", "trailer")
    for what in ("disturbances", "estimation", "increments")
]


@pytest.fixture
def record(run_log):
    log, configuration = run_log
    return log.records[60], configuration


def test_a_step_is_drawn_where_its_record_says(record):
    step, _configuration = record
    data = packed(step)
    stage = Stage()
    stage.link.receive(pack(PackedStep(time=1, data=data)))
    place = stage.link.moving
    assert place.tractor == (step.estimate.tractor.x, step.estimate.tractor.y, step.estimate.tractor.yaw)
    assert place.plans[0][-1] == pytest.approx(step.plan.tractor.poses[-1, :2], abs=1e-3)
    assert list(stage.link.trail)[-1][2] == step.reference.tractor.lateral_error
    assert json.loads(json.dumps(place.to_browser())) == place.to_browser()
    assert moving(step) == place


def test_a_vehicle_that_stands_leaves_no_trail(record):
    step, _configuration = record
    data, stage = packed(step), Stage()
    for _ in range(50):
        stage.link.receive(pack(PackedStep(time=1, data=data)))
    assert len(stage.link.trail) == 1


def test_the_drawn_bodies_are_joined_where_the_vehicle_is(record):
    step, configuration = record
    path, _ = build_path(configuration)
    shapes, vehicle = standing(configuration.vehicle, 1.0, 0.0, []), configuration.vehicle
    place = moving(step)
    import math

    def at(pose, ahead):
        return pose[0] + ahead * math.cos(pose[2]), pose[1] + ahead * math.sin(pose[2])

    apart = math.dist(at(place.tractor, shapes["tractorJoint"]), at(place.trailer, shapes["trailerJoint"]))
    assert apart == pytest.approx(vehicle.drawbar_length, abs=0.05)
    assert Lines(path, 0.0)(0.0)["path"][-1] == pytest.approx(path.nodes[-1, 1:3], abs=1e-3)


def test_away_from_any_line_both_bodies_are_drawn_where_their_receivers_are():
    lengths = {"hitch_length": 1.2, "drawbar_length": 0.2, "trailer_length": 1.5, "trailer_antenna": 0.2}
    vehicle, silent = VehicleParameters(**lengths), fixes_of(math.nan, math.nan)
    place = moving_by_hand((10.0, 5.0, 0.0), fixes_of(7.0, 5.0), vehicle)
    assert place.tractor == (10.0, 5.0, 0.0)
    assert place.trailer == (7.0, 5.0, 0.0)
    turning = moving_by_hand((10.0, 5.0, 0.5 * math.pi), fixes_of(8.0, 4.0), vehicle)
    assert turning.trailer == pytest.approx((8.0, 4.0, 0.0)), "it faces where the tractor pulls it"
    alone = moving_by_hand((10.0, 5.0, 0.0), silent, vehicle)
    assert alone.trailer == pytest.approx((7.5, 5.0, 0.0))
    behind = VehicleParameters(**lengths, masts=Masts(trailer=Mast(forward=-2.0, left=0.5)))
    swung = moving_by_hand((10.0, 5.0, 0.5 * math.pi), fixes_of(6.5, 4.5), behind)
    assert swung.trailer == pytest.approx((8.5, 4.0, 0.0)), "its antenna stands behind it and to its left"
    assert moving_by_hand((10.0, 5.0, math.nan), silent, vehicle) is None
    assert json.loads(json.dumps(place.to_browser())) == place.to_browser()


def fixes_of(x, y):
    """Return where the trailer's receiver is, as far as fixes are asked for it."""
    return SimpleNamespace(trailer=SimpleNamespace(x=x, y=y))


def test_sessions_of_browsers_that_never_come_again_are_forgotten():
    link, visitors = Stage().link, Visitors()
    steady = visitors.admit("", Rank.MAINTAINER, 0.0)
    session = link.session(steady)
    for _ in range(3 * MOST):
        link.session(visitors.admit("", Rank.MAINTAINER, 0.0))
        assert link.session(steady) is session
    assert len(link._sessions) == MOST


def test_garbage_is_no_message():
    stage = Stage()
    for data in (b"", b"DB", bytes(300), b"DBs\0" + bytes(8) + b"{", b"DBs\0" + bytes(8) + b"{}"):
        stage.link.receive(data)
    assert stage.link.gate is None
    assert stage.link.refused == 2


@pytest.fixture
def process(tmp_path):
    with console_process(tmp_path) as (running, gate, port):
        yield running, gate, port, tmp_path


def test_it_listens_at_loopback_only_and_is_nobody_by_itself(process):
    running, gate, port, folder = process

    until(lambda: reaches("127.0.0.1", port))
    others = {each[4][0] for each in socket.getaddrinfo(socket.gethostname(), port, socket.AF_INET)} - {"127.0.0.1"}
    assert not any(reaches(host, port) for host in others if not host.startswith("127."))
    words = []

    def heard():
        words.extend(decode(data, OperatorMessage) for data in gate.receive())
        return words

    until(heard)
    assert {each.action for each in words} == {Action.PRESENT}
    assert {each.seen_time for each in words} == {0}  # it has seen nothing, so that the gate takes nobody for present
    running.send_signal(signal.SIGTERM)
    assert running.wait(WAIT) in (0, -signal.SIGTERM)
    assert not (folder / ".nicegui").exists()
    assert not (folder / CONSOLE).exists()


def test_a_long_line_is_drawn_to_the_centimetre_by_few_points():
    path = figure_eights((3.0,) * 60, 300.0)
    drawn = np.array(Lines(path, 0.0)(2.0)["path"])
    assert len(path.nodes) > 100_000
    assert len(drawn) < 10_000
    beside = shapely.points(path.beside(2.0).nodes[::7, 1:3])
    assert shapely.distance(beside, shapely.LineString(drawn)).max() < 0.02  # the outside of a curve is farther around


def test_a_line_of_too_many_points_is_drawn_by_as_many_as_are_allowed():
    angle = np.linspace(0.0, 300.0, 5000)
    spiral = angle[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    kept = kept_points(spiral, 1e-6, 500)
    assert 100 < len(kept) <= 500
    assert (kept[0], kept[-1]) == (0, 4999)


def test_tubes_are_as_wide_as_they_let_each_body_be():
    configuration = load_configuration("articulated")
    tubes, vehicle = build_tubes(configuration), configuration.vehicle
    tractor, trailer = tube_widths(configuration)
    assert tractor == pytest.approx(tubes.tractor.support(np.eye(3))[0], abs=1e-4)
    swing = tubes.trailer.support(np.eye(2))[0]
    assert trailer == pytest.approx((vehicle.drawbar_length + 1.05) * math.sin(swing), abs=1e-4)
    assert tube_widths(load_configuration("articulated", NOTHING_DECLARED)) == (0, 0)


def test_neighbours_are_so_far_from_the_driven_line_and_not_drawn_where_there_is_no_room():
    path = figure_eights((8.0,), 20.0)
    drawn = Lines(path, 3.0)(0.5)
    assert len(drawn["neighbours"]) == 4
    for line, offset in zip([drawn["path"], *drawn["neighbours"]], (0.5, -5.5, -2.5, 3.5, 6.5), strict=True):
        assert path.project(*line[10], 0.0, 20.0)[1] == pytest.approx(offset, abs=1e-3)
    assert len(Lines(path, 5.0)(0.0)["neighbours"]) == 2  # 10 m are more than the curves' radii
    assert Lines(path, 0.0)(0.0)["neighbours"] == []


@pytest.mark.parametrize("turned", [0.0, math.pi])
@pytest.mark.parametrize("along", [12.0, 20.0, 100.0])
def test_the_nearest_pass_is_counted_from_the_configured_line_that_leads_along_the_vehicle(along, turned):
    path = figure_eights((20.0,), 60.0)  # crosses itself
    lines = Lines(path, 3.0)
    x, y, yaw = path.sample(np.array([along]))[0, :3]
    for number in range(-3, 4):
        for beside in (-1.4, 0.0, 1.4):
            left = 3.0 * number + beside
            place = x - left * math.sin(yaw), y + left * math.cos(yaw)
            assert lines.nearest_pass(*place, yaw + turned) == number
