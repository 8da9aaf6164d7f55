"""Antenna distance: receivers that are corrected from two base stations, or lengths that are wrong."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.driving.fault_detection.antenna_distance import AntennaDistance
from drawbar.driving.stand_in.rehearsal import Rehearsal
from drawbar.geometry import arm_offset
from drawbar.machine.stand_in.breaking import report_otherwise
from drawbar.messages import SupervisorState
from drawbar.safety.causes import Cause
from drawbar.signals import FixQuality, FixStatus, SolverStatus
from drawbar.simulation import build_path
from drawbar.vehicle.articulated import trailer_antenna
from drawbar.vehicle.parameters import Mast, Masts, VehicleParameters

ACCEPTED, REJECTED, MISSING = FixStatus.ACCEPTED, FixStatus.REJECTED, FixStatus.MISSING
FIXED = FixQuality.FIXED
VEHICLE = VehicleParameters()


def step(vehicle, shift=(0.0, 0.0), *, yaw=0.4, hitch=0.2, joint=-0.1, pitch=math.nan, quality=FIXED, **estimate):
    """Return a step on whose trailer's positions a shift acts, m, in the vehicle's own axes."""
    behind = yaw - hitch - joint
    x, y = (float(each) for each in trailer_antenna(vehicle, 3.0, -2.0, yaw, behind, joint))
    tilt = pitch if math.isfinite(pitch) else 0.0
    tractor = arm_offset(yaw, 0.0, tilt, vehicle.masts.tractor.arm)
    trailer = arm_offset(behind, 0.0, tilt, vehicle.masts.trailer.arm)
    ahead, left = shift
    measurement = SimpleNamespace(
        tractor_x=3.0 + tractor[0],
        tractor_y=-2.0 + tractor[1],
        trailer_x=x + trailer[0] + ahead * math.cos(yaw) - left * math.sin(yaw),
        trailer_y=y + trailer[1] + ahead * math.sin(yaw) + left * math.cos(yaw),
        **dict.fromkeys(("tractor_roll", "trailer_roll"), 0.0 if math.isfinite(pitch) else math.nan),
        **dict.fromkeys(("tractor_pitch", "trailer_pitch"), pitch),
        tractor_fix_quality=FIXED,
        trailer_fix_quality=quality,
    )
    right = {
        "hitch_angle": hitch, "trailer_steering": joint, "tractor_fix": ACCEPTED, "trailer_fix": ACCEPTED,
        "status": SolverStatus.SOLVED, "tractor": SimpleNamespace(yaw=yaw), "trailer": SimpleNamespace(yaw=behind),
    }  # fmt: skip
    return SimpleNamespace(measurement=measurement, estimate=SimpleNamespace(**right | estimate))


def found(*steps, vehicle=VEHICLE, sample_time=0.2):
    detector = AntennaDistance(vehicle, sample_time)
    return [detector.update(each) for each in steps]


@pytest.mark.parametrize("sample_time", [0.05, 0.2])
def test_a_shift_along_the_vehicle_is_found_after_two_seconds(sample_time):
    for ahead in (-0.3, 0.3):
        answers = found(*[step(VEHICLE, (ahead, 0.0))] * round(2.0 / sample_time), sample_time=sample_time)
        assert answers == [False] * (len(answers) - 1) + [True]


@pytest.mark.parametrize("right", [
    step(VEHICLE),
    step(VEHICLE, (0.12, 0.0)),
    step(VEHICLE, (0.0, 0.3), hitch=0.0, joint=0.0),
    step(VEHICLE, (1.0, 0.0), trailer_fix=REJECTED),
    step(VEHICLE, (1.0, 0.0), quality=FixQuality.SINGLE),
    step(VEHICLE, (1.0, 0.0), quality=FixQuality.FLOAT),
    step(VEHICLE, (1.0, 0.0), tractor_fix=MISSING),
    step(VEHICLE, (1.0, 0.0), status=SolverStatus.BAD_INPUT),
    step(VEHICLE, (math.nan, 0.0)),
])  # fmt: skip
def test_what_does_not_show_is_not_found(right):
    assert not any(found(*[right] * 30))


def test_single_samples_and_gaps_are_not_enough():
    wrong, right = step(VEHICLE, (0.3, 0.0)), step(VEHICLE)
    assert not any(found(*[wrong, right, right] * 20))
    assert not any(found(*[*[wrong] * 9, step(VEHICLE, trailer_fix=REJECTED)] * 4))


def test_a_distance_that_was_wrong_counts_until_it_is_right_in_that_direction():
    straight = {"hitch": 0.0, "joint": 0.0}
    detector = AntennaDistance(VEHICLE, 0.2)

    def drive(shift, yaw, **estimate):
        return [detector.update(step(VEHICLE, shift, yaw=yaw, **straight, **estimate)) for _ in range(25)][-1]

    assert drive((0.3, 0.0), yaw=0.0)
    assert drive((0.0, -0.3), yaw=0.5 * math.pi), "the same shift, across the vehicle"
    assert drive((0.0, -0.3), yaw=0.5 * math.pi, trailer_fix=REJECTED)
    assert not drive((0.0, 0.0), yaw=math.radians(200.0)), "the corrections are the same now"
    assert drive((0.3, 0.0), yaw=0.0)
    assert drive((0.0, 0.0), yaw=math.radians(40.0))
    assert not drive((0.0, 0.0), yaw=math.radians(20.0))


@pytest.mark.parametrize("pitch", [math.nan, 0.1])
def test_masts_whose_pitch_is_not_measured_may_lean(pitch):
    vehicle = VehicleParameters(masts=Masts(tractor=Mast(up=2.5), trailer=Mast(up=2.0)))
    lean = step(vehicle, (0.2, 0.0), pitch=pitch)
    assert found(*[lean] * 10, vehicle=vehicle)[-1] is math.isfinite(pitch)
    upright = step(vehicle, pitch=pitch)
    assert not any(found(*[upright] * 10, vehicle=vehicle))


def test_two_base_stations_refuse_to_engage():
    configuration = load_configuration("articulated", ["safety.engage.wiggle_test=false", "safety.engage.fixed=1.0"])
    path, _ = build_path(configuration)
    rehearsal = Rehearsal(configuration, path, 1, configuration.safety)
    east = np.degrees(0.3 / 6378137.0 / math.cos(math.radians(50.87)))
    report_otherwise(
        rehearsal.machine, lambda report, since: replace(report, longitude=report.longitude + east), ["trailer"]
    )
    list(rehearsal.run(15.0))
    assert rehearsal.gate_state.state is SupervisorState.STANDBY
    assert Cause.ANTENNA_DISTANCE.value in rehearsal.gate_state.refusals
