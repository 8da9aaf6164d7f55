"""Forces on the multibody during one integration step: both steerings, the drive, and six tyres."""

from functools import cache
from typing import Any

import casadi as ca
import numpy as np

from drawbar.codegen.recurrence import CompiledRecurrence
from drawbar.geometry import GRAVITY, Floats
from drawbar.machine.actuators import hydrostat_rates, steering_rate
from drawbar.machine.physics.model import CONTROLS, DRIVE_DAMPING, WHEELS
from drawbar.machine.physics.settings import PhysicsMachineSettings
from drawbar.machine.physics.statics import static_loads
from drawbar.machine.physics.tyres import Tyre, Wheel, contact
from drawbar.machine.symbols import numbers, symbolic
from drawbar.vehicle.parameters import VehicleParameters

COMMANDS = 3
"""delta_t, joint, wheel speed"""
_ACTUATORS = 8
"""delta_t, joint, the drive's wheel speed and four inner states, the angle that the drive asks of the rear axle"""
_COUNT = len(WHEELS)


class Forces:
    """The compiled step. Fill the inputs, call, read controls and wrenches; all are views, nothing is allocated."""

    def __init__(self, vehicle: VehicleParameters, settings: PhysicsMachineSettings) -> None:
        """Begin at rest, with the wheels straight. vehicle: as it truly is."""
        self._step = CompiledRecurrence(_forces_step(), 1)
        self._step.constants[:] = [*numbers(vehicle), *numbers(settings), settings.step / settings.substeps]
        inputs, after = self._step.inputs[0], self._step.states[0]
        cuts = np.cumsum([COMMANDS, 3, 3 * _COUNT, 3 * _COUNT, 6 * _COUNT])
        commands, root, centres, axes, velocities, planes = np.split(inputs, cuts)
        self.commands: Floats = commands
        """(3,) rad, rad, m/s"""
        self.root: Floats = root
        """(3,) centre of all mass, m"""
        self.centres: Floats = centres.reshape(_COUNT, 3)
        """of the wheels, m"""
        self.axes: Floats = axes.reshape(_COUNT, 3)
        """unit vectors to the left"""
        self.velocities: Floats = velocities.reshape(_COUNT, 6)
        """angular, rad/s, and linear of the wheel's point in the centre of all mass, m/s"""
        self.planes: Floats = planes.reshape(_COUNT, 3)
        """of the ground beneath each wheel: height at the origin, m, slopes to the east and to the north"""
        cuts = np.cumsum([_ACTUATORS + 2 * _COUNT, len(CONTROLS)])
        _, controls, wrenches = np.split(after, cuts)
        self.controls: Floats = controls
        """(4,) of the actuators"""
        self.wrenches: Floats = wrenches.reshape(_COUNT, 6)
        """force, N, and torque, Nm, on the centre of each wheel"""

    def __call__(self) -> None:
        """Take one step."""
        self._step()
        self._step.state[:] = self._step.states[0]


@cache
def _forces_step() -> ca.Function:
    """Return the step F(state, inputs, constants) -> state; all numbers of both sections are data."""
    stated = VehicleParameters(), PhysicsMachineSettings()
    constants = ca.SX.sym("c", sum(1 for section in stated for _ in numbers(section)) + 1)
    symbols = iter(ca.vertsplit(constants))
    vehicle, settings = symbolic(stated[0], symbols), symbolic(stated[1], symbols)
    step = next(symbols)
    sizes = (COMMANDS, 3, 3 * _COUNT, 3 * _COUNT, 6 * _COUNT, 3 * _COUNT)
    inputs = ca.SX.sym("i", sum(sizes))
    commands, root, centres, axes, velocities, planes = _split(inputs, sizes)
    outputs = (_ACTUATORS, 2 * _COUNT, len(CONTROLS), 6 * _COUNT)
    state = ca.SX.sym("x", sum(outputs))
    actuators, bristles, *_ = _split(state, outputs)
    moved = _moved(vehicle, settings, actuators, commands, step)
    tyres, radii = _tyres(vehicle, settings), _radii(settings)
    bent, wrenches = [], []
    for index in range(_COUNT):
        of3, of6 = slice(3 * index, 3 * index + 3), slice(6 * index, 6 * index + 6)
        turning, centre = velocities[of6][:3], centres[of3]
        velocity = velocities[of6][3:] + ca.cross(turning, centre - root)
        wheel = Wheel(centre, axes[of3], velocity, turning, planes[of3], radii[index])
        after, force, torque = contact(wheel, tyres[index], bristles[2 * index : 2 * index + 2], step)
        bent.append(after)
        wrenches += [force, torque]
    end = ca.vertcat(moved, *bent, _controls(vehicle, settings, moved), *wrenches)
    return ca.Function("forces", [state, inputs, constants], [ca.cse(end)])


def _moved(
    vehicle: VehicleParameters, settings: PhysicsMachineSettings, state: ca.SX, command: ca.SX, step: ca.SX
) -> ca.SX:
    """Return what steerings and drive ask of the multibody after a step, by RK4."""
    actuators, lag = settings.actuators, settings.actuators.lag_factor * vehicle.steering_lag

    def rates(now: ca.SX) -> ca.SX:
        wheels = steering_rate(now[0], command[0], lag=lag, rate=actuators.tractor_rate, stop=actuators.tractor_stop)
        joint = steering_rate(now[1], command[1], lag=lag, rate=actuators.trailer_rate, stop=actuators.trailer_stop)
        drive = hydrostat_rates(settings.hydrostat, now[2:7], command[2])
        return ca.vertcat(wheels, joint, drive, now[2] / settings.tractor.radius)

    k1 = rates(state)
    k2 = rates(state + 0.5 * step * k1)
    k3 = rates(state + 0.5 * step * k2)
    k4 = rates(state + step * k3)
    return state + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


def _controls(vehicle: VehicleParameters, settings: PhysicsMachineSettings, moved: ca.SX) -> ca.SX:
    """Return what the actuators are to reach, (4,) rad; both front wheels turn about one point (Ackermann)."""
    tangent, share = ca.tan(moved[0]), 0.5 * settings.tractor.front_track / vehicle.wheelbase
    left, right = (ca.atan(tangent / (1.0 - side * share * tangent)) for side in (1.0, -1.0))
    return ca.vertcat(left, right, moved[1], moved[7] + DRIVE_DAMPING * moved[2] / settings.tractor.radius)


def _tyres(vehicle: VehicleParameters, settings: PhysicsMachineSettings) -> list[Tyre]:
    """Return the tyre of each wheel, in the order of WHEELS."""
    tyres = settings.tyres
    return [
        Tyre(
            stiffness=load / tyres.deflection,
            damping=2.0 * tyres.damping * load / ca.sqrt(GRAVITY * tyres.deflection),
            cornering=tyres.cornering,
            creep=settings.terrain.creep,
            creep_speed=settings.terrain.creep_speed,
            friction=tyres.friction,
            relaxation=tyres.relaxation,
            rolling_resistance=tyres.rolling_resistance,
        )
        for load in static_loads(vehicle, settings)
        for _ in range(2)
    ]


def _radii(settings: PhysicsMachineSettings) -> list[Any]:
    """Return the radius of each wheel, in the order of WHEELS."""
    tractor = settings.tractor
    return [each for each in (tractor.radius, tractor.front_radius, settings.trailer.radius) for _ in range(2)]


def _split(vector: ca.SX, sizes: tuple[int, ...]) -> list[ca.SX]:
    return ca.vertsplit(vector, [0, *np.cumsum(sizes).tolist()])
