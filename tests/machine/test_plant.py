"""The integrated world: order of the integration, and the closed forms of docs/theory/vehicle-models.md."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from drawbar.codegen.recurrence import CompiledRecurrence
from drawbar.geometry import Floats
from drawbar.machine.plant import plant_constants, plant_step
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.machine.simulated import SimulatedMachine
from drawbar.signals import Truth
from drawbar.vehicle.parameters import VehicleParameters

Build = Callable[..., SimulatedMachine]
Drive = Callable[..., list[Truth]]
VEHICLE = VehicleParameters()


def axle(truth: Truth) -> Floats:
    """Centre of the trailer's axle, m."""
    c, yaw = VEHICLE.trailer_antenna, truth.trailer.yaw
    return np.array([truth.trailer.x - c * math.cos(yaw), truth.trailer.y - c * math.sin(yaw)])


def driven(settings: SimulatedMachineSettings, state: Floats, inputs: Floats, count: int) -> Floats:
    """Return the states (count, 11) after each of so many steps under the same inputs (11,)."""
    plant = CompiledRecurrence(plant_step(), count)
    plant.state[:], plant.inputs[:], plant.constants[:] = state, inputs, plant_constants(VEHICLE, settings)
    plant()
    return plant.states


def test_integration_is_of_fourth_order() -> None:
    """Halving the step divides the error by 16; commands below every limit keep the world smooth."""
    state = np.array([0.0, 0.0, 0.3, 0.1, 0.05, 0.1, 1.0, 1.0 / 3.0, 0.0, 0.5, 0.0])
    inputs = np.array([0.2, 0.15, 1.05, 0.95, 0.92, 0.01, 0.007, -0.007, 0.0, 0.0, 0.0])

    def final(count: int) -> Floats:
        settings = SimulatedMachineSettings(step=0.8 / count)
        return driven(settings, state, inputs, count)[-1]

    exact = final(1280)
    errors = [np.abs(final(count) - exact)[:6].max() for count in (20, 40, 80)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.3)
    assert math.log2(errors[1] / errors[2]) == pytest.approx(4.0, abs=0.3)


def test_trailer_answers_its_steering_by_the_closed_forms_transfer(
    build: Build, drive: Drive, ideal: SimulatedMachineSettings
) -> None:
    """y_i / delta_i = -V d / ((L_i + d) s + V): the step response of that transfer behind the steering lag.

    A step of 1 mrad keeps the linearisation's error (third order) far below the tolerance.
    """
    step, lag = 1e-3, VEHICLE.steering_lag
    machine = build(ideal)
    begin = drive(machine, 200)[-1].time
    delay = VEHICLE.trailer_length + VEHICLE.drawbar_length
    for truth in drive(machine, 100, trailer=step):
        t = truth.time - begin
        response = 1.0 - (delay * math.exp(-t / delay) - lag * math.exp(-t / lag)) / (delay - lag)
        assert axle(truth)[1] == pytest.approx(-VEHICLE.drawbar_length * step * response, abs=1e-8)


@pytest.mark.parametrize("degrees", [20.0, -20.0, 31.7, 38.0])
def test_straight_line_offset_at_rest(
    build: Build, drive: Drive, ideal: SimulatedMachineSettings, degrees: float
) -> None:
    """+delta_i shifts the trailer to the right by d sin(delta_i), also when pushed against the stop."""
    vehicle = VehicleParameters(trailer_steering_limit=math.radians(40.0))
    machine = build(ideal, vehicle=vehicle)
    end = drive(machine, 300, trailer=math.radians(degrees))[-1]
    reached = math.radians(min(degrees, 31.7))
    assert axle(end)[1] == pytest.approx(-0.2 * math.sin(reached), abs=1e-9)
    assert end.tractor.y == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("tractor", [0.14, -0.2])
@pytest.mark.parametrize("trailer", [0.0, 0.3, -0.3])
def test_trailer_axle_drives_the_circle_of_the_closed_form(
    build: Build, drive: Drive, ideal: SimulatedMachineSettings, tractor: float, trailer: float
) -> None:
    """rho_i = d sin(delta_i) + sqrt(rho² + a² - (L_i + d cos(delta_i))²), for a left curve; mirrored else."""
    end = drive(build(ideal), 600, tractor=tractor, trailer=trailer)[-1]
    radius = VEHICLE.wheelbase / math.tan(tractor)
    yaw = end.tractor.yaw
    centre = np.array([end.tractor.x - radius * math.sin(yaw), end.tractor.y + radius * math.cos(yaw)])
    a, d, inward = VEHICLE.free_joint_offset, VEHICLE.drawbar_length, math.copysign(trailer, trailer * radius)
    reach = VEHICLE.trailer_length + d * math.cos(trailer)
    expected = d * math.sin(inward) + math.sqrt(radius**2 + a**2 - reach**2)
    assert np.linalg.norm(axle(end) - centre) == pytest.approx(expected, abs=1e-9)


def test_integrated_axles_slide_only_by_their_crab_angles() -> None:
    """On the steps of an integrated run, by five-point differences of the positions that RK4 returned."""
    count, step = 100, 0.004
    settings = SimulatedMachineSettings(step=step)
    state = np.array([0.0, 0.0, 0.3, 0.1, 0.05, 0.1, 1.0, 1.0 / 3.0, 0.0, 0.5, 0.0])
    alpha_r, alpha_i = 0.02, -0.03
    inputs = np.array([0.2, 0.15, 1.0, 0.95, 0.92, 0.01, alpha_r, alpha_i, 0.0, 0.0, 0.0])
    x, y, theta, psi, joint = driven(settings, state, inputs, count).T[:5]
    a, d, L_i = VEHICLE.free_joint_offset, VEHICLE.drawbar_length, VEHICLE.trailer_length
    trailer_x = x - a * np.cos(theta) - d * np.cos(psi + joint) - L_i * np.cos(psi)
    trailer_y = y - a * np.sin(theta) - d * np.sin(psi + joint) - L_i * np.sin(psi)
    for east, north, yaw, crab in ((x, y, theta, alpha_r), (trailer_x, trailer_y, psi, alpha_i)):
        vx, vy = (np.convolve(p, np.array([-1, 8, 0, -8, 1]) / (12.0 * step), "valid") for p in (east, north))
        c, s = np.cos(yaw[2:-2]), np.sin(yaw[2:-2])
        assert c * vy - s * vx == pytest.approx((c * vx + s * vy) * math.tan(crab), abs=1e-9)
