"""Steering follows the closed forms of lag, rate limit and stop; the drive reaches its speed."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from drawbar.machine.settings import ActuatorSettings, SimulatedMachineSettings
from drawbar.machine.simulated import SimulatedMachine
from drawbar.signals import Truth
from drawbar.vehicle.parameters import VehicleParameters

Build = Callable[..., SimulatedMachine]
Drive = Callable[..., list[Truth]]
LAG = VehicleParameters().steering_lag
STRONG = VehicleParameters(tractor_steering_limit=0.9, trailer_steering_limit=0.9)


def test_small_step_is_a_first_order_lag(build: Build, drive: Drive, ideal: SimulatedMachineSettings) -> None:
    """Below the rate limit (target / lag < rate): delta = u (1 - exp(-t / tau)), to RK4's accuracy."""
    for truth in drive(build(ideal), 20, tractor=0.1, trailer=-0.05):
        share = 1.0 - math.exp(-truth.time / LAG)
        assert truth.tractor_steering == pytest.approx(0.1 * share, abs=1e-9)
        assert truth.trailer_steering == pytest.approx(-0.05 * share, abs=1e-9)


@pytest.mark.parametrize(("target", "side"), [(0.5, 1.0), (-0.5, -1.0)])
def test_large_step_first_moves_at_the_rate_limit(
    build: Build, drive: Drive, ideal: SimulatedMachineSettings, target: float, side: float
) -> None:
    """0.5 rad / 0.3 s is beyond both rates; the wheels ramp until the rest is rate · tau."""
    rates = ideal.actuators
    for truth in drive(build(ideal, vehicle=STRONG), 3, tractor=target, trailer=target):
        assert truth.tractor_steering == pytest.approx(side * rates.tractor_rate * truth.time, abs=1e-12)
        assert truth.trailer_steering == pytest.approx(side * rates.trailer_rate * truth.time, abs=1e-12)


def test_after_the_ramp_the_lag_takes_over(build: Build, drive: Drive, ideal: SimulatedMachineSettings) -> None:
    """delta = u - rate tau exp(-(t - t*) / tau) from t* = u / rate - tau; one RK4 step spans the kink."""
    rate, target = ideal.actuators.tractor_rate, 0.5
    change = target / rate - LAG
    for truth in drive(build(ideal), 20, tractor=target)[5:]:
        rest = rate * LAG * math.exp(-(truth.time - change) / LAG)
        assert truth.tractor_steering == pytest.approx(target - rest, abs=1e-6)


def test_mechanical_stops_hold_and_release(build: Build, drive: Drive, ideal: SimulatedMachineSettings) -> None:
    machine = build(ideal, vehicle=STRONG)
    pushed = drive(machine, 25, tractor=0.9, trailer=-0.9)
    assert max(t.tractor_steering for t in pushed) == ideal.actuators.tractor_stop
    assert min(t.trailer_steering for t in pushed) == -ideal.actuators.trailer_stop
    assert pushed[-1].tractor_steering == ideal.actuators.tractor_stop
    released = drive(machine, 25)[-1]
    assert released.tractor_steering == pytest.approx(0.0, abs=1e-4)
    assert released.trailer_steering == pytest.approx(0.0, abs=1e-4)


def test_dead_time_delays_every_actuator(build: Build, drive: Drive, ideal: SimulatedMachineSettings) -> None:
    """0.4 s are two samples: the delayed run is the prompt one, two samples later."""
    late = ideal.model_copy(update={"actuators": ActuatorSettings(dead_time=0.4)})
    prompt_run = drive(build(ideal), 10, tractor=0.2, trailer=0.1)
    late_run = drive(build(late), 12, tractor=0.2, trailer=0.1)
    assert all(t.speed == 0.0 and t.tractor_steering == 0.0 for t in late_run[:2])
    for prompt, delayed in zip(prompt_run, late_run[2:], strict=True):
        assert (delayed.tractor, delayed.trailer_steering) == (prompt.tractor, prompt.trailer_steering)


def test_dead_time_within_a_sample(build: Build, drive: Drive, ideal: SimulatedMachineSettings) -> None:
    """After 0.07 s of dead time a small step is the lag of the time that is left."""
    late = ideal.model_copy(update={"actuators": ActuatorSettings(dead_time=0.07)})
    for truth in drive(build(late), 10, tractor=0.1):
        share = 1.0 - math.exp(-(truth.time - 0.07) / LAG)
        assert truth.tractor_steering == pytest.approx(0.1 * share, abs=1e-9)


@pytest.mark.parametrize("target", [0.5, 1.0, 2.0, -1.0])
def test_drive_reaches_its_speed(build: Build, drive: Drive, ideal: SimulatedMachineSettings, target: float) -> None:
    """Within 2 % after 3 s, at most 5 % above, and no lasting error."""
    run = drive(build(ideal), 150, speed=target)
    share = np.array([t.speed / target for t in run])
    settled = np.array([t.time for t in run]) >= 3.0
    assert np.abs(share[settled] - 1.0).max() <= 0.02
    assert share.max() <= 1.05
    assert share[-1] == pytest.approx(1.0, abs=1e-4)


def test_drive_stops_again(build: Build, drive: Drive, ideal: SimulatedMachineSettings) -> None:
    machine = build(ideal)
    drive(machine, 25)
    assert drive(machine, 100, speed=0.0)[-1].speed == pytest.approx(0.0, abs=1e-4)
