"""Settings of vehicle and controller that contradict those of the gate are refused before a machine is driven."""

import pytest

from drawbar.config import load_configuration
from drawbar.driving.preparation.matching_settings import demand_matching_settings
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.errors import ConfigurationError

CONTRADICTIONS = {
    "vehicle.tractor_steering_rate=0.7": [
        "vehicle.tractor_steering_rate = 0.7 rad/s (40.1°/s) is above safety.envelope.steering_rate = 0.4363 rad/s "
        "(25°/s): the gate limits commands that are planned so fast; lower the one or raise the other",
        "vehicle.tractor_steering_rate = 0.7 rad/s (40.1°/s) is above safety.drive.jump_rate = 0.4363 rad/s (25°/s): "
        "a steering that turns so fast is taken for a sensor that slips; lower the one or raise the other",
    ],
    "vehicle.trailer_steering_rate=0.44": [
        "vehicle.trailer_steering_rate = 0.44 rad/s (25.2°/s) is above safety.envelope.steering_rate",
        "vehicle.trailer_steering_rate = 0.44 rad/s (25.2°/s) is above safety.drive.jump_rate",
    ],
    "safety.envelope.speed=0.9": ["speed = 1 m/s is above safety.envelope.speed = 0.9 m/s: the gate stops"],
    "vehicle.dead_time=0.6": ["vehicle.dead_time = 0.6 s is not below safety.drive.stuck_time = 0.6 s"],
    "safety.timing.controller=0.2": ["sample_time = 0.2 s is not below safety.timing.controller = 0.2 s: between"],
    "safety.engage.lateral_deviation=0.09": [
        "safety.engage.lateral_deviation = 0.09 m is above safety.drive.lateral_deviation = 0.08 m: what has just"
    ],
    "safety.drive.lateral_error=0.9": ["safety.engage.lateral_error = 1 m is above safety.drive.lateral_error = 0.9 m"],
    "safety.engage.hitch_angle=1.1": ["safety.engage.hitch_angle = 1.1 rad (63°) is above safety.drive.hitch_angle = "],
    "safety.engage.correction_age=30.0": ["safety.engage.correction_age = 30 s is above safety.drive.correction_age"],
}


@pytest.mark.parametrize("change", list(CONTRADICTIONS))
def test_each_contradiction_is_refused_with_both_settings_and_why(change):
    with pytest.raises(ConfigurationError) as refused:
        demand_matching_settings(load_configuration("articulated", [change]))
    lines = str(refused.value).splitlines()
    assert len(lines) == len(CONTRADICTIONS[change])
    for line, expected in zip(lines, CONTRADICTIONS[change], strict=True):
        assert line.startswith(expected)


BOARDS = """
[devices]
tractor_receiver = { transport = "udp://127.0.0.1:1" }
trailer_receiver = { transport = "udp://127.0.0.1:2" }
tractor_board = { address = "127.0.5.126", max_angle = 0.52 }
trailer_board = { address = "127.0.6.126", max_angle = 0.35 }
"""
VALVES = """
[devices]
tractor_receiver = { transport = "udp://127.0.0.1:1" }
trailer_receiver = { transport = "udp://127.0.0.1:2" }
[devices.isobus]
bus = "can:virtual:matching"
name = { identity = 1 }
tractor_valve = { wheelbase = 1.4, address = 38 }
trailer_valve = { curvature = [[-0.35, -0.2], [0.4, 0.2]], address = 39 }
"""
DEVICES = {
    (BOARDS, "max_angle = 0.35", "max_angle = 0.3"): "vehicle.trailer_steering_limit = 0.3491 rad (20°) is beyond "
    "devices.trailer_board.max_angle, which reaches 0.3 rad (17.2°): a steering that stays more than 0.04072 rad",
    (BOARDS, "max_angle = 0.52", "max_angle = 0.052"): "vehicle.tractor_steering_limit = 0.5236 rad (30°) is beyond "
    "devices.tractor_board.max_angle, which reaches 0.052 rad (2.98°)",
    (VALVES, "-0.35, -0.2", "-0.349, -0.2"): "vehicle.trailer_steering_limit = 0.3491 rad (20°) is beyond "
    "devices.isobus.trailer_valve.curvature, which reaches 0.349 rad (20°): beyond its table nothing is commanded",
    (VALVES, "wheelbase = 1.4", "wheelbase = 2.8"): "devices.isobus.tractor_valve.wheelbase = 2.8 m is not "
    "vehicle.wheelbase = 1.4 m: the wheels would turn by other angles than are commanded",
}


def on_devices(devices, tmp_path):
    mine = tmp_path / "my.toml"
    mine.write_text(f'extends = "articulated"\n{devices}', "utf-8")
    return load_configuration(str(mine))


@pytest.mark.parametrize("devices", [BOARDS, VALVES, VALVES.replace("wheelbase = 1.4", "wheelbase = 1.5")])
def test_devices_that_reach_the_limits_match(devices, tmp_path):
    """They are not refused; the next test sees that others are."""
    assert demand_matching_settings(on_devices(devices, tmp_path)) is None


@pytest.mark.parametrize(("devices", "right", "wrong"), list(DEVICES))
def test_devices_that_do_not_reach_the_limits_are_refused(devices, right, wrong, tmp_path):
    with pytest.raises(ConfigurationError) as refused:
        demand_matching_settings(on_devices(devices.replace(right, wrong), tmp_path))
    assert str(refused.value).startswith(DEVICES[devices, right, wrong])


def test_equal_limits_match():
    equal = ["speed=2.0", "safety.envelope.speed=2.0", "safety.engage.lateral_deviation=0.08"]
    demand_matching_settings(load_configuration("articulated", equal))
    with pytest.raises(ConfigurationError, match=r"speed = 2 m/s is above safety\.envelope\.speed = 1\.999 m/s"):
        demand_matching_settings(load_configuration("articulated", [*equal, "safety.envelope.speed=1.999"]))


@pytest.mark.parametrize("command", ["drive", "check"])
def test_neither_drive_nor_check_begins_with_them(command, tmp_path, drawbar):
    mine = tmp_path / "my.toml"
    mine.write_text(with_stand_ins(load_configuration("articulated")).to_toml(), "utf-8")
    code, told = drawbar(command, str(mine), "--set", "vehicle.tractor_steering_rate=0.7")
    assert code == 2
    assert "is above safety.envelope.steering_rate" in " ".join(told.split())
