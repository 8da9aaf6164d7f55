"""Sensors of wheel angle and wheel speed: values, limits, faults."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.errors import ConfigurationError
from drawbar.protocols.sensors import Encoder, InductiveSensor, Potentiometer, SensorFault, WheelSpeed

TABLE = Potentiometer(counts=(100.0, 300.0, 500.0, 700.0, 900.0), angles=(0.6, 0.25, 0.0, -0.25, -0.6))
CUBIC = InductiveSensor(coefficients=(-0.6, 0.2, 0.02, -0.001), lowest=0.0, highest=5.0)


@pytest.mark.parametrize(
    ("counts", "angle"), [(100.0, 0.6), (200.0, 0.425), (500.0, 0.0), (900.0, -0.6), (916.0, -0.628), (84.0, 0.628)]
)
def test_a_table_is_linear_between_its_points_and_a_little_beyond(counts: float, angle: float) -> None:
    read = TABLE.read(counts)
    assert read.fault is SensorFault.NONE
    assert read.value == pytest.approx(angle, abs=1e-12)


@pytest.mark.parametrize("sensor", [TABLE, CUBIC])
@pytest.mark.parametrize(
    ("counts", "fault"),
    [
        (math.nan, SensorFault.NOT_FINITE),
        (math.inf, SensorFault.NOT_FINITE),
        (916.1, SensorFault.ELECTRICAL),
        (-1e-9, SensorFault.ELECTRICAL),
    ],
)
def test_outside_the_electrical_range_is_a_fault(
    sensor: Potentiometer | InductiveSensor, counts: float, fault: SensorFault
) -> None:
    read = sensor.read(counts)
    assert math.isnan(read.value)
    assert read.fault is fault


@settings(derandomize=True)
@given(st.floats(allow_nan=True, allow_infinity=True))
def test_a_value_is_finite_or_there_is_a_fault(counts: float) -> None:
    for sensor in (TABLE, CUBIC):
        read = sensor.read(counts)
        assert math.isfinite(read.value) == (read.fault is SensorFault.NONE)


@pytest.mark.parametrize(
    ("counts", "angles"),
    [
        ((1, 2, 3, 4), (1, 2, 3, 4)),
        ((1, 2, 3, 4, 4), (1, 2, 3, 4, 5)),
        ((1, 2, 3, 4, 5), (1, 2, 3, 3, 5)),
        ((1, 2, 3, 4, 5), (1, 2, 3, 2, 5)),
        ((1, 2, 3, 4, math.nan), (1, 2, 3, 4, 5)),
        ((1, 2, 3, 4, 5), (1, 2, 3, 4)),
        (tuple(range(17)), tuple(range(17))),
    ],
)
def test_what_is_no_table_is_refused(counts: tuple[float, ...], angles: tuple[float, ...]) -> None:
    with pytest.raises(ConfigurationError, match="potentiometer"):
        Potentiometer(counts=counts, angles=angles)


def test_a_polynomial_that_turns_back_is_refused() -> None:
    InductiveSensor(coefficients=(0.0, 1.0, -0.1, 0.0), lowest=0.0, highest=4.9)
    with pytest.raises(ConfigurationError, match="two angles"):
        InductiveSensor(coefficients=(0.0, 1.0, -0.1, 0.0), lowest=0.0, highest=5.1)
    # the slope is positive at both ends and negative between them
    with pytest.raises(ConfigurationError, match="two angles"):
        InductiveSensor(coefficients=(0.0, 0.5, 0.0, 1.0 - 1.5), lowest=-1.0, highest=1.0)
    with pytest.raises(ConfigurationError, match="two angles"):
        InductiveSensor(coefficients=(0.0, 1.0, -1.2, 0.4), lowest=0.0, highest=2.0)
    with pytest.raises(ConfigurationError, match="not finite"):
        InductiveSensor(coefficients=(0.0, math.nan, 0.0, 0.0), lowest=0.0, highest=5.0)


@pytest.mark.parametrize(
    "kwargs", [{"pulses_per_metre": 0.0}, {"pulses_per_metre": math.nan}, {"pulses_per_metre": 50.0, "bits": 8}]
)
def test_what_is_no_encoder_is_refused(kwargs: dict[str, float]) -> None:
    with pytest.raises(ConfigurationError):
        Encoder(**kwargs)  # type: ignore[arg-type]


@pytest.mark.parametrize("bits", [16, 32])
@pytest.mark.parametrize("factor", [1.0, -1.0])
def test_counters_wrap_in_both_directions(bits: int, factor: float) -> None:
    wheel = WheelSpeed(Encoder(pulses_per_metre=100.0 * factor, bits=bits))
    assert math.isnan(wheel.read(0.0, 5).value)
    assert wheel.read(0.1, 2**bits - 5).value == pytest.approx(-1.0 * factor)
    assert wheel.read(0.2, 15).value == pytest.approx(2.0 * factor)


@settings(derandomize=True, deadline=None)
@given(speed=st.floats(0.15, 5.0), start=st.integers(0, 2**16 - 1), period=st.sampled_from([0.01, 0.05, 0.1, 0.2]))
def test_a_steady_speed_is_known_to_a_report_or_a_pulse_in_its_window(speed: float, start: int, period: float) -> None:
    wheel = WheelSpeed(Encoder(pulses_per_metre=50.0))
    reads = [wheel.read(period * k, (start + int(50.0 * speed * period * k)) % 2**16).value for k in range(400)]
    frequency = 50.0 * speed
    window = max(period, min(3.0 / frequency, 0.5))  # of the reckoning
    share = min(period / (window - period), 0.9) if window > 1.5 * period else 1.0 / (frequency * period)
    assert max(abs(read - speed) for read in reads[100:]) <= 1.1 * speed * share
    assert sum(reads[100:]) / 300.0 == pytest.approx(speed, rel=0.15)


def test_a_wheel_that_stops_is_seen_to_stop() -> None:
    wheel = WheelSpeed(Encoder(pulses_per_metre=50.0))
    for k in range(11):
        wheel.read(0.1 * k, 5 * k)
    seen = [wheel.read(1.0 + 0.1 * k, 50).value for k in range(1, 7)]
    assert seen == sorted(seen, reverse=True)
    assert seen[1] == pytest.approx(1.0 / (50.0 * 0.2))
    assert seen[3] > 0.0
    assert seen[4] == seen[5] == 0.0
    # it moves again: nobody knows since when, but not since before the last report
    assert wheel.read(1.7, 51).value == pytest.approx(1.0 / 50.0 / 0.1)


def test_wrong_stamps_and_impossible_counts_are_faults_and_the_next_report_begins_anew() -> None:
    wheel = WheelSpeed(Encoder(pulses_per_metre=50.0))
    wheel.read(1.0, 0)
    assert wheel.read(math.nan, 5).fault is SensorFault.NOT_FINITE
    assert wheel.read(1.0, 5).fault is SensorFault.TIME
    assert wheel.read(0.5, 5).fault is SensorFault.TIME
    assert wheel.read(1.1, 5).value == pytest.approx(1.0)
    assert wheel.read(1.2, 20_000).fault is SensorFault.IMPOSSIBLE
    assert wheel.read(1.3, 20_005).value == pytest.approx(1.0)
