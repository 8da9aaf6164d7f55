"""What is told of a path before it is driven."""

from pathlib import Path

import pytest

from drawbar.config import load_configuration
from drawbar.recording.header import path_notes, run_header
from drawbar.simulation import build_path

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_off_tracking_that_no_controller_takes_away_is_reported() -> None:
    plain = load_configuration("articulated")
    path, _ = build_path(plain)
    assert path_notes(plain, path, None) == []
    weak = load_configuration("articulated", ["vehicle.trailer_steering_limit=0.1"])
    (note,) = path_notes(weak, path, None)
    assert "in curves of 0.15 1/m the trailer runs 0.08 m beside the tractor's track" in note
    assert "the tractor takes 0.03 m of it by leaving its own line (controller.sharing)" in note
    assert run_header(weak, path, None).path_note == note
    for changes in (["controller.sharing.share=0.0"], ["controller.structure=centralised"]):
        alone = load_configuration("articulated", ["vehicle.trailer_steering_limit=0.1", *changes])
        assert "tractor takes" not in path_notes(alone, path, None)[0]


def test_limits_that_stop_a_vehicle_where_off_tracking_takes_it_are_named() -> None:
    example = str(EXAMPLES / "long-trailer.toml")
    within = load_configuration(example)
    path, _ = build_path(within)
    assert path_notes(within, path, None)[0].endswith("leaving its own line (controller.sharing)")
    for changes, named in (
        ({"safety.drive.leaving": 0.6}, "safety.drive.leaving = 0.6 m to 0.7 m"),
        ({"sanity.leaving": 0.6}, "sanity.leaving = 0.6 m to 0.7 m"),
    ):
        beyond = load_configuration(example, [f"{key}={value}" for key, value in changes.items()])
        assert path_notes(beyond, path, None)[0].endswith(f"the vehicle is stopped: raise {named}")


def test_a_horizon_within_which_slow_front_wheels_hardly_turn_is_reported() -> None:
    plain = load_configuration("articulated", ["sample_time=0.05"])
    path, _ = build_path(plain)
    assert path_notes(plain, path, None) == []
    slow = ["sample_time=0.1", "vehicle.tractor_steering_rate=0.2"]
    (note,) = path_notes(load_configuration("articulated", slow), path, None)
    assert "plans reach 2 s ahead, in which the front wheels turn by 0.4 rad" in note
    assert note.endswith("raise controller.horizon to 32")
    assert path_notes(load_configuration("articulated", [*slow, "controller.horizon=32"]), path, None) == []
    assert path_notes(load_configuration("articulated", [*slow, "speed=0.4"]), path, None) == []
    (calm,) = path_notes(load_configuration("articulated", ["speed=0.65", *slow, "vehicle.wheelbase=3.5"]), path, None)
    assert "plans reach 2 s ahead" in calm
    (slower,) = path_notes(load_configuration("articulated", [*slow, "vehicle.tractor_steering_rate=0.1"]), path, None)
    assert slower.endswith("begin on the line"), "a horizon of 63 samples is more than a solver has time for"


def test_curves_that_slow_front_wheels_round_are_reported_with_a_speed_at_which_they_do_not() -> None:
    eight = ["path.radii=[8.0]", "vehicle.wheelbase=2.8", "controller.horizon=60", "vehicle.tractor_steering_rate=0.1"]
    path, _ = build_path(load_configuration("articulated", eight))
    (note,) = path_notes(load_configuration("articulated", [*eight, "speed=2.0"]), path, None)
    assert "where the path's curves begin or end the tractor leaves its line by 0.24 m or more: at 2 m/s" in note
    assert note.endswith("; at 0.8 m/s it is 0.04 m")
    assert path_notes(load_configuration("articulated", [*eight, "speed=0.8"]), path, None) == []


def test_samples_far_apart_are_reported_with_what_is_near_enough() -> None:
    plain = load_configuration("articulated")
    path, _ = build_path(plain)
    seldom = load_configuration("articulated", ["sample_time=0.5"])
    (note,) = path_notes(seldom, path, None)
    assert "a sample comes every 0.50 m, which is more than 0.3 wheelbases (0.42 m)" in note
    assert note.endswith("lower sample_time to 0.42 s, or speed to 0.84 m/s")
    for enough in ("sample_time=0.42", "speed=0.84", "sample_time=0.2"):
        assert path_notes(load_configuration("articulated", ["sample_time=0.5", enough]), path, None) == []


@pytest.mark.parametrize("seldom", ["sample_time=0.2", "sample_time=0.3"])
def test_three_metres_a_second_need_no_more_samples_than_have_been_driven_with(seldom: str) -> None:
    """The mean error at 3 m/s is 2 to 3 cm with both."""
    fast = load_configuration("articulated", ["speed=3.0", "path.radii=[16.0]", seldom])
    path, _ = build_path(fast)
    assert path_notes(fast, path, None) == []
