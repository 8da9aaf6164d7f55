"""The tractor's yaw by two antennas: its mounting's error, which are rejected, and what it is worth to the estimate."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from alignment import Alignment
from alone import Alone
from c_signals import Real
from ordinary import believed, measured

from drawbar.codegen import Unit
from drawbar.config import load_configuration
from drawbar.estimation.alignment import YAW_GATE
from drawbar.geometry import arm_offset, wrap
from drawbar.report.path_errors import true_path_errors
from drawbar.signals import Estimate, Pose, Status
from drawbar.simulation import Simulation, simulate
from drawbar.vehicle.parameters import Mast, Masts, VehicleParameters

UNIT = """
#include "yaw_sensor.h"
#include "unit.h"
struct component { struct yaw_sensor sensor; double judged; };
#define COMPONENT_FIELDS FIELD(component, judged, 0, 1, 0, 0) FIELD(component, sensor.error, 0, 1, 0, 0) \\
    FIELD(component, sensor.change, 0, 1, 0, 0) \\
    FIELD(component, sensor.latency, 0, 1, 0, 0) SETTING(component, sensor.gate, 0, 1, 0, 0)
int UNIT(judged)(struct component *component, double measured, const struct yaw_known *known, double elapsed)
{
    component->judged = yaw_judged(&component->sensor, measured, known, elapsed);
    return 0;
}
"""
PRESENT = "machine.attitude.yaw.present=true"
SAMPLE = 0.2
ALONE = 'machine.events=[{kind="gps_loss",start=0.0,duration=1e6,antenna="trailer"}]'
"""no receiver on the trailer"""


class Sensor(Alone):
    """The sensor's judge by itself."""

    def __init__(self) -> None:
        settings = {"sensor.gate": YAW_GATE}
        super().__init__(Unit(name="yaw", source=UNIT, configure=lambda workspace: workspace.write(settings)))

    def judged(
        self, told: float, expected: float, shown: float = math.nan, *, rate: float = 0.0, fix_latency: float = 0.0
    ) -> float:
        known = (Real * 4)(expected, rate, shown, fix_latency)
        self.call("judged", Real(told), known, Real(SAMPLE))
        return float(self.live.array("judged").item())

    @property
    def error(self) -> float:
        return float(self.live.array("sensor.error").item())

    @property
    def change(self) -> float:
        return float(self.live.array("sensor.change").item())

    @property
    def latency(self) -> float:
        return float(self.live.array("sensor.latency").item())


@pytest.mark.parametrize("turns", [-3, 0, 2])
def test_a_yaw_has_the_turns_of_the_expected_one(turns: int) -> None:
    expected = 3.1 + 2.0 * math.pi * turns
    assert Sensor().judged(-3.13, expected) == pytest.approx(expected + wrap(-3.13 - 3.1), abs=1e-12)


@pytest.mark.parametrize("off", [0.11, -0.11, math.pi, math.nan, math.inf])
def test_a_yaw_far_from_the_expected_one_is_rejected(off: float) -> None:
    assert math.isnan(Sensor().judged(1.0 + off, 1.0))


def test_the_mountings_error_is_found_where_both_bodies_have_fixes() -> None:
    rng, sensor, off = np.random.default_rng(7), Sensor(), math.radians(2.0)
    for yaw in np.linspace(-4.0, 4.0, 300).tolist():
        shown = wrap(yaw + rng.normal(0.0, math.radians(1.5)))
        answer = sensor.judged(wrap(yaw + off), yaw, shown, rate=0.3 * math.sin(yaw))
    assert sensor.error == pytest.approx(-off, abs=math.radians(0.3))
    assert answer == pytest.approx(yaw, abs=math.radians(0.3))


def changes(off: float, bump: float) -> list[float]:
    """Return what is told of the error's change at each sample of two minutes, rad; after one it changes by `bump`."""
    rng, sensor, told = np.random.default_rng(7), Sensor(), list[float]()
    for sample in range(600):
        yaw = 0.01 * sample
        shown, wrong = wrap(yaw + rng.normal(0.0, math.radians(1.5))), off + (bump if sample >= 300 else 0.0)
        sensor.judged(wrap(yaw + wrong), yaw, shown)
        told.append(sensor.change)
    return told


@pytest.mark.parametrize("bump", [-0.052, 0.052])
def test_a_change_of_a_known_error_is_told_within_seconds_and_a_constant_one_is_none(bump: float) -> None:
    constant, changed = np.array(changes(0.05, 0.0)), np.array(changes(0.05, bump))
    assert np.abs(constant).max() < math.radians(1.0)
    assert np.count_nonzero(constant) > 500
    assert not constant[:50].any(), "the error is not known yet"
    np.testing.assert_array_equal(changed[:300], constant[:300])
    assert (-np.sign(bump) * changed[330:360] > math.radians(1.5)).all()


@pytest.mark.parametrize(("yaw_late", "fixes_late", "corrected"), [(0.2, 0.0, 0.0), (0.0, 0.2, 0.0), (0.3, 0.2, 0.2)])
def test_an_unreported_age_is_found_beside_the_mountings_error(
    yaw_late: float, fixes_late: float, corrected: float
) -> None:
    """A weaving tractor, the yaw of its sensor off by 1 degree; the corrected yaw is as late as the fixes are."""
    rng, sensor, off = np.random.default_rng(7), Sensor(), math.radians(1.0)

    def yaw(time: float) -> float:
        return math.cos(0.3 * time)

    for time in np.arange(0.0, 60.0, SAMPLE).tolist():
        rate = -0.3 * math.sin(0.3 * time)
        told, shown = yaw(time - yaw_late) + off, yaw(time - fixes_late + corrected) + rng.normal(0.0, 0.026)
        answer = sensor.judged(told, yaw(time), shown, rate=rate, fix_latency=corrected)
    assert sensor.latency == pytest.approx(yaw_late - fixes_late, abs=0.03)
    assert sensor.error == pytest.approx(-off, abs=math.radians(0.3))
    assert answer == pytest.approx(yaw(time - fixes_late + corrected), abs=math.radians(0.5))


def test_beside_a_reference_a_yaw_counts_in_turns_once_they_have_shown_its_age() -> None:
    sensor = Sensor()
    assert [sensor.judged(0.0, 0.0, 0.0, rate=0.05) for _ in range(100)] == pytest.approx([0.0] * 100, abs=1e-12)
    turning = [sensor.judged(0.0, 0.0, 0.0, rate=0.3) for _ in range(20)]
    assert math.isnan(turning[0])
    assert turning[-1] == pytest.approx(0.0, abs=1e-12)


def test_without_a_reference_the_measured_yaw_counts() -> None:
    sensor = Sensor()
    assert [sensor.judged(0.05, 0.0) for _ in range(100)] == pytest.approx([0.05] * 100, abs=1e-15)


def test_a_late_yaw_is_brought_up_to_the_sample() -> None:
    def there(time: float) -> Estimate:
        pose = Pose(x=0.0, y=0.0, yaw=0.2 * time)
        return believed(pose, Pose(x=-2.0, y=0.0, yaw=0.0), time=time)

    given = measured(0.0, 0.0, math.nan, math.nan, time=1.2, tractor_yaw=0.2, tractor_attitude_age=0.2)
    aligned = Alignment(VehicleParameters()).apply(given, there(1.0), there(1.2))
    assert aligned.tractor_yaw == pytest.approx(0.24, abs=1e-12)


def driven(*changes: str, seed: int = 0) -> list[float]:
    """Return the mean distances of both bodies from a figure-eight, cm, and the tractor's mean steering rate, °/s."""
    log = simulate(load_configuration("articulated", ["path.radii=[8.0]", *changes]), seed=seed)
    assert log.outcome is not None
    assert log.outcome.finished
    errors = true_path_errors(log)
    rate = np.abs(np.diff(log.column("truth.tractor_steering"))).mean() / 0.2
    means = [100.0 * float(np.abs(each.error).mean()) for each in (errors.tractor, errors.trailer)]
    return [*means, math.degrees(float(rate))]


@cache
def mean_of(*changes: str) -> tuple[float, ...]:
    return tuple(np.mean([driven(*changes, seed=seed) for seed in range(3)], axis=0).tolist())


def test_a_measured_yaw_brings_the_tractor_nearer_with_less_steering() -> None:
    usual, better = mean_of(), mean_of(PRESENT)
    assert better[0] < 0.8 * usual[0]
    assert better[1] < usual[1]
    assert better[2] < 0.75 * usual[2]


def test_the_mountings_error_costs_nothing_where_both_bodies_have_receivers() -> None:
    assert mean_of(PRESENT, "machine.attitude.yaw.bias=0.03") == pytest.approx(mean_of(PRESENT), rel=0.1)


FAST = ("speed=2.0", PRESENT)


LATE = "machine.delays={%s={latency=0.2},reported=false}"


@pytest.mark.parametrize("late", ["attitude", "fix"])
def test_a_yaw_of_another_age_than_the_fixes_costs_little(late: str) -> None:
    """Uncorrected, the tractor has 6 and 7 cm."""
    delayed = mean_of(*FAST, LATE % late)
    assert delayed[0] < mean_of(*FAST)[0] + 2.0
    assert delayed[1] < mean_of(*FAST)[1] + 1.0


def test_one_receiver_with_two_antennas_drives_both_bodies() -> None:
    alone, usual = mean_of(PRESENT, ALONE), mean_of()
    assert alone[0] < usual[0]
    assert alone[1] < 1.2 * usual[1]


@pytest.mark.parametrize("missing", ["tractor_yaw", "hitch_angle", "tractor_x"])
def test_without_the_trailers_receiver_a_run_waits_for_yaw_hitch_angle_and_position(missing: str) -> None:
    with Simulation(load_configuration("articulated", [PRESENT, ALONE])) as simulation:
        first = simulation.machine.read()
        status, command = simulation.autopilot.feedback(replace(first, **{missing: math.nan}))
        simulation.autopilot.prepare()
        assert (status, command.speed) == (Status.POSITION, 0.0)
        status, _ = simulation.autopilot.feedback(simulation.machine.read())
        assert status < Status.POSITION


def test_a_run_begins_with_the_trailer_where_yaw_and_angles_put_it() -> None:
    mast, yaw, hitch, joint, lean = Mast(forward=0.2, left=-0.1, up=2.5), 2.0, 0.3, -0.1, (0.05, 0.02)
    vehicle = VehicleParameters(masts=Masts(tractor=mast))
    east, north = arm_offset(yaw, *lean, (mast.forward, mast.left, mast.up))
    told = {"tractor_yaw": yaw, "hitch_angle": hitch, "trailer_steering": joint}
    given = measured(5.0 + east, 6.0 + north, math.nan, math.nan, tractor_roll=lean[0], tractor_pitch=lean[1], **told)
    found = Alignment(vehicle).begin(given)
    lengths = vehicle.free_joint_offset, vehicle.drawbar_length, vehicle.trailer_length - vehicle.trailer_antenna
    behind = sum(np.array(lengths) * np.exp(1j * np.array([yaw, yaw - hitch, yaw - hitch - joint])))
    trailer = complex(5.0, 6.0) - behind
    assert (found.tractor_x, found.tractor_y) == pytest.approx((5.0, 6.0), abs=1e-12)
    assert (found.trailer_x, found.trailer_y) == pytest.approx((trailer.real, trailer.imag), abs=1e-12)


def test_without_a_yaw_the_tractors_position_is_given_as_it_is() -> None:
    found = Alignment(VehicleParameters(masts=Masts(tractor=Mast(up=2.5)))).begin(
        measured(5.0, 6.0, math.nan, math.nan)
    )
    assert (found.tractor_x, found.tractor_y) == (5.0, 6.0)
    assert math.isnan(found.trailer_x)


if __name__ == "__main__":
    for kind, changes in {
        "a receiver on each body": (),
        "with two antennas on the tractor": (PRESENT,),
        "that receiver alone": (PRESENT, ALONE),
        "two antennas, 2 m/s": FAST,
        "the same, their yaw 0.2 s late, unreported": (*FAST, LATE % "attitude"),
        "the same, the fixes 0.2 s late, unreported": (*FAST, LATE % "fix"),
    }.items():
        print("| " + " | ".join([kind, *(f"{each:.1f}" for each in mean_of(*changes))]) + " |")
