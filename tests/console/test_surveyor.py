"""Where the surveyor puts the tractor's rear axle, and where it says that it does not know."""

import math

import pytest

pytest.importorskip("nicegui", reason="the extra `console` is not installed")
pytest.importorskip("shapefile", reason="the extra `console` is not installed")

from console_stage import Stage

from drawbar.console.surveyor import Surveyor
from drawbar.errors import PathError
from drawbar.vehicle.parameters import Mast

EAST, NORTH = 0.0, math.pi / 2.0


def heard(stage, surveyor, yaw=math.nan, **fixes):
    stage.link.surveyor = surveyor
    stage.link.moving = None
    receive_fixes, told = surveyor.receive_fixes, []
    surveyor.receive_fixes = lambda message, _: (told.append(message), receive_fixes(message, yaw))
    stage.receive_fixes(10.0, 20.0, **fixes)
    surveyor.receive_fixes = receive_fixes
    return surveyor.place


def test_the_axle_is_behind_and_beside_the_antenna():
    stage = Stage()
    mast = Mast(forward=2.0, left=0.5, up=3.0)
    surveyor = Surveyor(mast, lambda: stage.now)
    assert heard(stage, surveyor, yaw=NORTH)[:2] == pytest.approx((10.5, 18.0))
    assert heard(stage, surveyor, yaw=EAST)[:2] == pytest.approx((8.0, 19.5))


def test_without_a_yaw_an_antenna_that_is_not_above_the_axle_says_nothing():
    stage = Stage()
    aside = Surveyor(Mast(forward=2.0), lambda: stage.now)
    assert heard(stage, aside) is None
    with pytest.raises(PathError, match="RTK-fixed"):
        aside.here()
    above = Surveyor(Mast(up=3.0), lambda: stage.now)
    assert heard(stage, above)[:2] == (10.0, 20.0)


def test_old_positions_and_those_that_are_not_fixed_are_none():
    stage = Stage()
    surveyor = Surveyor(Mast(), lambda: stage.now)
    assert heard(stage, surveyor, quality=4) is None
    assert heard(stage, surveyor) is not None
    stage.now += 1_100_000_000
    assert surveyor.place is None
