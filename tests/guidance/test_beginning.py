"""Where a run begins, and which way along the path."""

import math

import numpy as np
import pytest

from drawbar.errors import PathError
from drawbar.guidance.beginning import beginning
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.path import Path
from drawbar.signals import Pose

EIGHT = figure_eights((8.0,), 20.0)
TWICE = figure_eights((8.0, 8.0), 20.0)
REACH = 5.0


def at(path: Path, s: float, left: float = 0.0, turned: float = 0.0) -> Pose:
    x, y, yaw, _ = path.sample(np.array(s)).tolist()
    return Pose(x=x - left * math.sin(yaw), y=y + left * math.cos(yaw), yaw=yaw + turned)


def begun(path: Path, vehicle: Pose, *, both_ways: bool = False) -> tuple[Path, float]:
    return beginning(path, vehicle, reach=REACH, both_ways=both_ways)


def test_near_the_start_a_run_begins_there() -> None:
    for vehicle in (at(EIGHT, 0.0), at(EIGHT, 4.9), at(EIGHT, 2.0, 3.0), at(EIGHT, -4.0), at(EIGHT, 0.0, turned=3.1)):
        assert begun(EIGHT, vehicle) == (EIGHT, 0.0)


def test_elsewhere_it_begins_beside_the_vehicle_on_the_branch_that_leads_along() -> None:
    rng = np.random.default_rng(4)  # seed 4
    for s in np.arange(6.0, EIGHT.length - 6.0, 0.3):
        left, turned = rng.uniform(-1.0, 1.0), rng.uniform(-0.5, 0.5)
        vehicle = at(EIGHT, float(s), left, turned)
        path, place = begun(EIGHT, vehicle)
        assert path is EIGHT
        near_start = math.hypot(vehicle.x, vehicle.y) <= REACH
        assert place == (0.0 if near_start else pytest.approx(s, abs=1e-4))  # also at the crossing


def test_of_several_passes_the_first_is_taken() -> None:
    second = at(TWICE, EIGHT.length + 20.0)
    path, place = begun(TWICE, second)
    assert place == pytest.approx(20.0, abs=1e-4)
    assert path.sample(np.array(place))[:2] == pytest.approx([second.x, second.y], abs=1e-6)


@pytest.mark.parametrize("s", [12.0, 40.0, 70.0])
def test_a_path_of_both_ways_is_turned_round_for_a_vehicle_that_faces_the_other_way(s: float) -> None:
    vehicle = at(EIGHT, s, 0.4, math.pi)
    assert begun(EIGHT, vehicle)[0] is EIGHT
    path, place = begun(EIGHT, vehicle, both_ways=True)
    assert place == pytest.approx(EIGHT.length - s, abs=1e-4)
    x, y, yaw, _ = path.sample(np.array(place)).tolist()
    assert math.hypot(vehicle.x - x, vehicle.y - y) == pytest.approx(0.4, abs=1e-6)
    assert math.cos(yaw - vehicle.yaw) == pytest.approx(1.0)
    assert begun(EIGHT, at(EIGHT, s), both_ways=True)[0] is EIGHT


def test_a_path_is_not_turned_round_where_nothing_of_it_would_lie_ahead() -> None:
    assert begun(EIGHT, at(EIGHT, 1.0, turned=math.pi), both_ways=True) == (EIGHT, 0.0)


def test_a_vehicle_far_away_or_at_the_end_is_reported() -> None:
    with pytest.raises(
        PathError, match=r"is 6\.00 m from where the run is to begin, .*, 12\.00 m along the path; at most 5 m"
    ):
        begun(EIGHT, at(EIGHT, 12.0, -6.0))
    line = Path.through(
        arc_length=np.arange(0.0, 30.1, 0.25),
        x=np.arange(0.0, 30.1, 0.25),
        y=np.zeros(121),
        yaw=np.zeros(121),
        label_of_piece=np.zeros(120, dtype=np.int8),
        label_names=("line",),
    )
    with pytest.raises(PathError, match=r"stands at the end of the path, .* nothing of it lies ahead"):
        begun(line, Pose(x=30.5, y=0.3, yaw=0.0))
    assert begun(line, Pose(x=30.5, y=0.3, yaw=3.0), both_ways=True)[1] == 0.0


def test_a_yaw_that_is_not_known_leaves_the_nearest_place() -> None:
    x, y, _, _ = EIGHT.sample(np.array(30.0)).tolist()
    assert EIGHT.nearest(x, y, math.nan, reach=REACH, both_ways=True) == (pytest.approx(30.0, abs=1e-4), False)
