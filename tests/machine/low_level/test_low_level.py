"""The laws of drawbar_actuate, by the very C: position loop, speed cascade, faults."""

import math
from dataclasses import replace

import pytest

from drawbar.errors import ConfigurationError
from drawbar.machine.low_level.low_level import (
    ActuateInput,
    ActuateOutput,
    ActuateStatus,
    LowLevel,
    SpeedAxis,
    SteeringAxis,
    TableSensor,
)
from drawbar.machine.low_level.settings import PositionLoopSettings, SpeedLoopSettings
from drawbar.protocols.sensors import InductiveSensor, Potentiometer

COUNTS = TableSensor(counts=(-1000.0, 1000.0), values=(-1.0, 1.0), lowest=-1000.0, highest=1000.0)
LOOP = PositionLoopSettings(
    dead_band_left=0.1, dead_band_right=0.2, compensation=1.0, full_rate_left=0.5, full_rate_right=0.4, stop_zone=0.002
)
GIVEN = ActuateInput(time=0.0, measured_speed=1.0, steer=(True, False), drive=True)


def front(loop: PositionLoopSettings = LOOP, **changes: float) -> LowLevel:
    return LowLevel(front=SteeringAxis(sensor=COUNTS, loop=loop, limit=0.6), **changes)  # type: ignore[arg-type]


def pedal(**changes: float) -> LowLevel:
    speed = SpeedLoopSettings(**{"proportional": 0.2, "integral": 0.5, **changes})  # type: ignore[arg-type]
    loop = PositionLoopSettings(proportional=6.0, stop_zone=0.0, full_rate_left=0.8, full_rate_right=0.8)
    return LowLevel(pedal=SpeedAxis(sensor=COUNTS, loop=loop, speed=speed, full_speed=3.0))


def ticks(low_level: LowLevel, given: ActuateInput, count: int, start: int = 0) -> list[ActuateOutput]:
    """Return what it does while the same is given, at 50 Hz."""
    return [low_level.step(replace(given, time=0.02 * (start + k))) for k in range(count)]


@pytest.mark.parametrize(
    ("error", "drive"),
    [
        (0.05, 0.1 + 0.9 * 3.0 * 0.05 / 0.5),
        (-0.05, -(0.2 + 0.8 * 3.0 * 0.05 / 0.4)),
        (0.5, 1.0),
        (-0.5, -1.0),
        (0.0019, 0.0),
        (-0.0019, 0.0),
    ],
)
def test_a_drive_skips_the_dead_band_of_its_side_and_is_scaled_by_the_rate_of_its_side(
    error: float, drive: float
) -> None:
    assert front().step(replace(GIVEN, steering=(error, 0.0))).drives == pytest.approx((drive, 0.0, 0.0), abs=1e-12)


def test_a_part_of_the_dead_band_and_a_limited_drive() -> None:
    loop = LOOP.model_copy(update={"compensation": 0.8, "drive_limit": 0.6})
    assert front(loop).step(replace(GIVEN, steering=(0.5, 0.0))).drives[0] == pytest.approx(0.6)
    expected = 0.08 + 0.52 * 3.0 * 0.05 / 0.5
    assert front(loop).step(replace(GIVEN, steering=(0.05, 0.0))).drives[0] == pytest.approx(expected)


@pytest.mark.parametrize(
    "sensor",
    [
        Potentiometer(counts=(100.0, 200.0, 300.0, 400.0, 500.0), angles=(0.5, 0.2, 0.0, -0.2, -0.5)),
        InductiveSensor(coefficients=(0.7, -0.003, 2e-6, -1e-9), lowest=100.0, highest=500.0),
    ],
)
def test_a_sensor_is_linearised_as_python_does(sensor: Potentiometer | InductiveSensor) -> None:
    low_level = LowLevel(front=SteeringAxis(sensor=sensor, loop=LOOP, limit=0.6))
    for k, counts in enumerate([100.0, 150.0, 299.0, 300.0, 333.0, 499.0, 500.0, 505.0, 95.0, 91.9, 508.1, math.nan]):
        read = sensor.read(counts).value
        made = low_level.step(replace(GIVEN, time=0.02 * k, counts=(counts, 0.0, 0.0), steer=(False, False)))
        assert made.positions[0] == pytest.approx(read, abs=1e-14, nan_ok=True)


def test_an_integral_grows_rests_while_saturated_is_bounded_and_ends_on_release() -> None:
    loop = LOOP.model_copy(update={"integral": 1.0, "integral_limit": 0.1, "compensation": 0.0})
    low_level = front(loop)
    drives = [each.drives[0] for each in ticks(low_level, replace(GIVEN, steering=(0.02, 0.0)), 400)]
    assert drives[0] == pytest.approx(3.0 * 0.02 / 0.5)
    assert drives[101] - drives[1] == pytest.approx(100 * 0.02 * 0.02 / 0.5)
    assert drives[-1] == pytest.approx(3.0 * 0.02 / 0.5 + 0.1)
    ticks(low_level, replace(GIVEN, steer=(False, False)), 1, 400)
    assert ticks(low_level, replace(GIVEN, steering=(0.02, 0.0)), 1, 401)[0].drives[0] == pytest.approx(drives[0])
    saturated = front(loop)
    ticks(saturated, replace(GIVEN, steering=(0.5, 0.0)), 100)
    assert ticks(saturated, replace(GIVEN, steering=(0.02, 0.0)), 1, 100)[0].drives[0] == pytest.approx(drives[0])


def test_a_standing_tyre_is_steered_for_two_seconds_without_an_integral() -> None:
    loop = LOOP.model_copy(update={"integral": 1.0, "integral_limit": 0.1})
    low_level = front(loop)
    standing = replace(GIVEN, steering=(0.02, 0.0), measured_speed=0.05)
    made = ticks(low_level, standing, 110)
    assert {each.drives[0] for each in made[:100]} == {made[0].drives[0]}
    assert [each.statuses[0] for each in made[99:103]] == [0, 0, ActuateStatus.STANDING, ActuateStatus.STANDING]
    assert made[-1].drives[0] == 0.0
    # a rest at drive 0 makes up for nothing, motion does
    assert ticks(low_level, replace(standing, steering=(0.0, 0.0)), 50, 110)[-1].drives[0] == 0.0
    assert ticks(low_level, standing, 1, 160)[0].statuses[0] is ActuateStatus.STANDING
    assert ticks(low_level, replace(standing, measured_speed=0.1), 1, 161)[0].drives[0] > 0.0
    assert (
        ticks(low_level, replace(standing, measured_speed=math.nan), 150, 162)[-1].statuses[0] is ActuateStatus.STANDING
    )


FAULTS = {
    "set point": ({"steering": (0.61, 0.0)}, ActuateStatus.SET_POINT),
    "no set point": ({"steering": (math.nan, 0.0)}, ActuateStatus.SET_POINT),
    "no counts": ({"counts": (math.nan, 0.0, 0.0)}, ActuateStatus.SENSOR),
    "counts out of range": ({"counts": (1000.1, 0.0, 0.0)}, ActuateStatus.SENSOR),
    "no time": ({"time": math.nan}, ActuateStatus.TIME),
    "the same time": ({"time": 0.02}, ActuateStatus.TIME),
    "earlier": ({"time": 0.01}, ActuateStatus.TIME),
    "late": ({"time": 0.13}, ActuateStatus.TIME),
}


@pytest.mark.parametrize("case", FAULTS)
def test_a_fault_releases_until_the_caller_has_released(case: str) -> None:
    changes, status = FAULTS[case]
    low_level, given = front(), replace(GIVEN, steering=(0.1, 0.0))
    ticks(low_level, given, 2)
    failed = low_level.step(replace(given, **{"time": 0.04, **changes}))  # type: ignore[arg-type]
    assert (failed.drives[0], failed.statuses[0]) == (0.0, status)
    again = ticks(low_level, given, 20, 8)[-1]
    assert (again.drives[0], again.statuses[0]) == (0.0, status)
    assert ticks(low_level, replace(given, steer=(False, False)), 1, 28)[0].statuses[0] is ActuateStatus.OFF
    assert ticks(low_level, given, 1, 29)[0].drives[0] > 0.0


def test_a_pause_before_engaging_is_no_fault() -> None:
    low_level = front()
    ticks(low_level, replace(GIVEN, steer=(False, False)), 2)
    assert low_level.step(replace(GIVEN, time=100.0, steering=(0.1, 0.0))).statuses[0] is ActuateStatus.FINE


def test_the_reference_ramps_up_down_and_to_a_stop() -> None:
    low_level = pedal(proportional=0.0, integral=0.0)
    given = replace(GIVEN, speed=1.0, measured_speed=0.0, steer=(False, False))
    up = [3.0 * each.pedal for each in ticks(low_level, given, 60)]
    assert up[1:] == pytest.approx([min(1.0, 0.01 * k) for k in range(1, 60)])
    moving = replace(given, measured_speed=1.0)
    ticks(low_level, moving, 60, 60)
    down = [3.0 * each.pedal for each in ticks(low_level, replace(moving, speed=0.5), 30, 120)]
    assert down[:26] == pytest.approx([1.0 - 0.02 * k for k in range(1, 26)] + [0.5])
    stop = [3.0 * each.pedal for each in ticks(low_level, replace(moving, speed=0.0), 12, 150)]
    assert stop == pytest.approx([0.45, 0.4, 0.35, 0.3, 0.25, 0.2, 0.15, 0.1, 0.05, 0.0, 0.0, 0.0], abs=1e-9)


def test_engaging_in_motion_begins_at_the_present_speed() -> None:
    made = pedal().step(replace(GIVEN, speed=2.0, measured_speed=1.2))
    assert made.pedal == pytest.approx(1.2 / 3.0)


def test_a_pedal_never_leaves_its_range_and_its_integral_does_not_wind_up() -> None:
    low_level = pedal(full_pedal=0.5, acceleration=100.0)
    slow = replace(GIVEN, speed=1.4, measured_speed=0.9, counts=(0.0, 0.0, 500.0))
    assert {each.pedal for each in ticks(low_level, slow, 500)[10:]} == {0.5}
    assert low_level.step(replace(slow, time=10.0, measured_speed=1.9)).pedal == pytest.approx(
        1.4 / 3.0 - 0.1, abs=0.02
    )
    pedals = [0.36]
    for k in range(1, 200):  # the pedal follows
        counts = (0.0, 0.0, 1000.0 * pedals[-1])
        pedals.append(low_level.step(replace(slow, time=10.0 + 0.02 * k, measured_speed=1.9, counts=counts)).pedal)
    assert min(pedals) == pedals[-1] == 0.0
    assert low_level.step(replace(slow, time=14.0, measured_speed=1.4, counts=(0.0, 0.0, 0.0))).pedal < 0.2


def test_the_outer_integral_rests_while_the_motor_is_as_fast_as_it_can_be() -> None:
    low_level = pedal(acceleration=100.0)
    far = replace(GIVEN, speed=1.5, measured_speed=1.0, counts=(0.0, 0.0, 0.0))
    assert {round(each.pedal, 9) for each in ticks(low_level, far, 50)[1:]} == {0.6}


def test_set_point_zero_is_pedal_zero_whatever_the_integral_has_learnt() -> None:
    low_level = pedal()
    given = replace(GIVEN, speed=1.0, measured_speed=0.8, counts=(0.0, 0.0, 300.0))
    ticks(low_level, given, 200)
    made = ticks(low_level, replace(given, speed=0.0), 60, 200)
    assert made[-1].pedal == 0.0
    assert made[-1].drives[2] == -1.0


PEDAL_FAULTS = {
    "wheels beyond the possible": ({"measured_speed": 6.1}, ActuateStatus.SPEED, -1.0),
    "no wheel speed": ({"measured_speed": math.nan}, ActuateStatus.SPEED, -1.0),
    "backwards": ({"speed": -0.1}, ActuateStatus.SET_POINT, -1.0),
    "too fast": ({"speed": 3.1}, ActuateStatus.SET_POINT, -1.0),
    "no pedal sensor": ({"counts": (0.0, 0.0, math.nan)}, ActuateStatus.SENSOR, 0.0),
}


@pytest.mark.parametrize("case", PEDAL_FAULTS)
def test_a_fault_of_the_speed_brings_the_pedal_back_or_leaves_it_to_its_spring(case: str) -> None:
    changes, status, drive = PEDAL_FAULTS[case]
    low_level = pedal()
    given = replace(GIVEN, speed=1.0, counts=(0.0, 0.0, 300.0))
    ticks(low_level, given, 5)
    made = low_level.step(replace(given, **{"time": 0.1, **changes}))  # type: ignore[arg-type]
    assert (made.statuses[2], made.pedal, made.drives[2]) == (status, 0.0, drive)
    assert ticks(low_level, given, 5, 6)[-1].statuses[2] is status


def test_a_dead_encoder_does_not_press_the_pedal_to_the_floor() -> None:
    low_level = pedal()
    made = ticks(low_level, replace(GIVEN, speed=1.0, measured_speed=0.0, counts=(0.0, 0.0, 250.0)), 100)
    failed = next(k for k, each in enumerate(made) if each.statuses[2] is ActuateStatus.NO_FEEDBACK)
    assert 0.02 * failed == pytest.approx(1.5, abs=0.05)
    assert made[-1].pedal == 0.0
    assert made[-1].drives[2] < 0.0


@pytest.mark.parametrize("changes", [{"standing_time": math.nan}, {"longest_period": 0.0}, {"longest_period": 1.1}])
def test_settings_that_cannot_be_are_refused(changes: dict[str, float]) -> None:
    with pytest.raises(ConfigurationError, match="drawbar_actuate refuses"):
        front(**changes)


def test_a_table_that_is_none_is_refused() -> None:
    for bad in ((1.0, 1.0), (math.nan, 1.0), (2.0, 1.0)):
        sensor = replace(COUNTS, counts=bad)
        with pytest.raises(ConfigurationError, match="drawbar_actuate refuses"):
            LowLevel(front=SteeringAxis(sensor=sensor, loop=LOOP, limit=0.6))
    many = tuple(float(k) for k in range(17))
    with pytest.raises(ConfigurationError, match="17 points"):
        LowLevel(front=SteeringAxis(sensor=replace(COUNTS, counts=many, values=many), loop=LOOP, limit=0.6))
