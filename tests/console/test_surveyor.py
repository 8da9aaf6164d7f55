"""Where the surveyor puts the tractor's rear axle, and where it says that it does not know."""

import math
from types import SimpleNamespace

import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import Stage

from drawbar.console.surveyor import Surveyor
from drawbar.errors import PathError
from drawbar.geometry import arm_offset, wrap
from drawbar.vehicle.parameters import Mast

EAST, NORTH = 0.0, math.pi / 2.0
WHEELBASE = 2.5
"""m"""


def heard(stage, surveyor, yaw=math.nan, **fixes):
    stage.link.surveyor = surveyor
    stage.link.moving = None
    receive_fixes, told = surveyor.receive_fixes, []
    surveyor.receive_fixes = lambda message, *_: (told.append(message), receive_fixes(message, yaw, math.nan))
    stage.receive_fixes(10.0, 20.0, **fixes)
    surveyor.receive_fixes = receive_fixes
    return surveyor.place


def test_the_axle_is_behind_and_beside_the_antenna():
    stage = Stage()
    mast = Mast(forward=2.0, left=0.5, up=3.0)
    surveyor = Surveyor(mast, WHEELBASE, lambda: stage.now)
    assert heard(stage, surveyor, yaw=NORTH)[:2] == pytest.approx((10.5, 18.0))
    assert heard(stage, surveyor, yaw=EAST)[:2] == pytest.approx((8.0, 19.5))


def test_without_a_yaw_an_antenna_that_is_not_above_the_axle_says_nothing():
    stage = Stage()
    aside = Surveyor(Mast(forward=2.0), WHEELBASE, lambda: stage.now)
    assert heard(stage, aside) is None
    with pytest.raises(PathError, match="where the tractor faces"):
        aside.here()
    above = Surveyor(Mast(up=3.0), WHEELBASE, lambda: stage.now)
    assert heard(stage, above)[:2] == (10.0, 20.0)


def test_old_positions_and_those_that_are_not_fixed_are_none():
    stage = Stage()
    surveyor = Surveyor(Mast(), WHEELBASE, lambda: stage.now)
    assert heard(stage, surveyor, quality=4) is None
    assert heard(stage, surveyor) is not None
    stage.now += 1_100_000_000
    assert surveyor.place is None
    with pytest.raises(PathError, match="RTK-fixed"):
        surveyor.here()


SAMPLE = 0.2
"""s"""


def drive_circle(stage, surveyor, *, mast, seconds, speed, curvature=0.12, roll=0.1, start=(10.0, 20.0, 0.3)):
    """Drive by hand, away from any line, so that nothing estimates the yaw; return where the axle is and was put.

    A negative speed reverses.
    """
    stage.link.surveyor, stage.link.moving = surveyor, None
    stage.link.gate = SimpleNamespace(tractor_angle=math.atan(curvature * WHEELBASE))
    x, y, yaw = start
    true, put = [], []
    for _ in range(round(seconds / SAMPLE)):
        step, turned = speed * SAMPLE, curvature * speed * SAMPLE
        x, y, yaw = x + step * math.cos(yaw + turned / 2), y + step * math.sin(yaw + turned / 2), yaw + turned
        east, north = arm_offset(yaw, roll, 0.0, mast.arm)
        forward, left = curvature * mast.forward, 1.0 - curvature * mast.left
        course = yaw + math.atan2(forward, left) + (math.pi if speed < 0.0 else 0.0)
        stage.now += int(SAMPLE * 1e9)
        stage.receive_fixes(x + east, y + north, course=course, tractor_speed=abs(speed), tractor_roll=roll)
        true.append((x, y, yaw))
        put.append(surveyor.place)
    return true, put


def test_an_antenna_ahead_of_the_axle_tells_in_a_curve_where_the_axle_is():
    stage, mast = Stage(), Mast(forward=1.5, left=0.4, up=2.5)
    surveyor = Surveyor(mast, WHEELBASE, lambda: stage.now)
    true, put = drive_circle(stage, surveyor, mast=mast, seconds=20.0, speed=1.0)
    for (x, y, _), (east, north, _) in list(zip(true, put, strict=True))[50:]:
        assert math.dist((x, y), (east, north)) < 0.02


@pytest.mark.parametrize("mast", [Mast(forward=1.5, up=2.5), Mast(left=0.5), Mast()])
def test_a_tractor_that_creeps_and_stands_away_from_any_line_is_known_as_before(mast):
    stage = Stage()
    surveyor = Surveyor(mast, WHEELBASE, lambda: stage.now)
    [*_, last], _ = drive_circle(stage, surveyor, mast=mast, seconds=6.0, speed=1.0, curvature=0.0)
    [*_, last], put = drive_circle(stage, surveyor, mast=mast, seconds=20.0, speed=0.2, curvature=0.1, start=last)
    true, stood = drive_circle(stage, surveyor, mast=mast, seconds=4.0, speed=0.0, start=last)
    assert all(put)
    assert math.dist(true[-1][:2], stood[-1][:2]) < 0.02
    assert stood[-1][2] == pytest.approx(
        true[-1][2], abs=0.04
    )  # a point 0.3 m behind an antenna above the axle turns with it later
    stage.now += 2_000_000_000  # nobody knows what it did meanwhile
    assert not any(math.isfinite(yaw) for *_, yaw in filter(None, drive_circle(
        stage, surveyor, mast=mast, seconds=1.0, speed=0.0, start=last
    )[1]))  # fmt: skip


@pytest.mark.parametrize("speed", [0.2, 1.0])
@pytest.mark.parametrize("mast", [Mast(forward=1.5, left=0.4), Mast(), Mast(forward=-1.0, left=0.4, up=2.5)])
def test_reversing_away_from_any_line_turns_nothing_about(mast, speed):
    stage = Stage()
    surveyor = Surveyor(mast, WHEELBASE, lambda: stage.now)
    [*_, last], _ = drive_circle(stage, surveyor, mast=mast, seconds=6.0, speed=1.0, curvature=0.0)
    for curvature, direction in ((0.1, -1.0), (-0.1, 1.0), (0.0, -1.0)):
        true, put = drive_circle(
            stage, surveyor, mast=mast, seconds=4.0 / speed, speed=direction * speed, curvature=curvature, start=last
        )
        last = true[-1]
        assert math.dist(last[:2], put[-1][:2]) < 0.06
        assert abs(wrap(last[2] - put[-1][2])) < 0.05


def test_an_antenna_behind_the_axle_tells_in_a_curve_where_the_axle_is():
    stage, mast = Stage(), Mast(forward=-1.0, left=0.4, up=2.5)
    surveyor = Surveyor(mast, WHEELBASE, lambda: stage.now)
    true, put = drive_circle(stage, surveyor, mast=mast, seconds=20.0, speed=1.0)
    for (x, y, _), (east, north, _) in list(zip(true, put, strict=True))[5:]:
        assert math.dist((x, y), (east, north)) < 0.02


def test_a_tractor_that_begins_to_reverse_faces_away_from_its_motion():
    stage = Stage()
    surveyor = Surveyor(Mast(), WHEELBASE, lambda: stage.now)
    assert heard(stage, surveyor, course=NORTH, tractor_speed=1.0, wheel_speed=-1.0)[2] == pytest.approx(-NORTH)


def test_before_it_has_moved_a_tractor_is_drawn_as_if_in_one_line_with_its_trailer():
    stage = Stage()
    surveyor = Surveyor(Mast(forward=1.5), WHEELBASE, lambda: stage.now)
    stage.link.surveyor = surveyor
    stage.receive_fixes(10.0, 20.0, trailer_x=6.0, trailer_y=20.0)
    assert surveyor.place is None
    assert surveyor.shown == (8.5, 20.0, 0.0)
    stage.receive_fixes(10.0, 20.0)
    assert surveyor.shown is None, "it has no trailer's receiver"
