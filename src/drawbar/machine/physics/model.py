"""The multibody as MJCF, MuJoCo's own language, built from the vehicle's lengths and the machine's settings.

Frames are forward, left, up. The tractor's frame sits in the middle of its rear axle, the drawbar's in the free joint
RJ1, the trailer's in the actuated joint RJ2. Wheels have no geometry here: tyres.py is their contact with the ground.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from drawbar.geometry import GRAVITY
from drawbar.machine.physics.settings import FRONT_AXLE, PhysicsMachineSettings
from drawbar.vehicle.parameters import VehicleParameters

WHEELS = ("rear_left", "rear_right", "front_left", "front_right", "trailer_left", "trailer_right")
CONTROLS = ("steer_left", "steer_right", "joint", "drive")
JOINTS = ("hitch", "joint", "steer_left", "steer_right")
"""beta, phi - psi, and the angles of both front wheels, as their signs are everywhere else"""

DRIVE_DAMPING = 0.1
"""of the drive per its stiffness, s"""
_SERVO_DAMPING = 0.01
"""of both steerings per their stiffness, s"""
_HITCH_DAMPING = 20.0
"""of each axis of the free joint, Nm s/rad"""
_SWING_DAMPING = 50.0
"""of the front axle's swing, Nm s/rad"""

Vector = tuple[float, float, float]


class _Mass(NamedTuple):
    """A mass at a place."""

    mass: float
    place: Vector


def mjcf(vehicle: VehicleParameters, settings: PhysicsMachineSettings) -> str:
    """Return the model's text. vehicle: as it truly is."""
    timestep = settings.step / settings.substeps
    return f"""<mujoco model="drawbar">
<compiler angle="radian" inertiafromgeom="false"/>
<option timestep="{timestep:.9g}" integrator="implicitfast" gravity="0 0 {-GRAVITY}"><flag contact="disable"/></option>
<worldbody>{_tractor(vehicle, settings)}</worldbody>
<tendon><fixed name="differential"><joint joint="rear_left" coef="0.5"/><joint joint="rear_right" coef="0.5"/></fixed>
</tendon>
<actuator>{_actuators(settings)}</actuator>
</mujoco>"""


def _tractor(vehicle: VehicleParameters, settings: PhysicsMachineSettings) -> str:
    tractor, base = settings.tractor, vehicle.wheelbase
    radius, front_radius, half, front_half = (
        tractor.radius,
        tractor.front_radius,
        0.5 * tractor.track,
        0.5 * tractor.front_track,
    )
    wheels = [_Mass(tractor.wheel_mass, (0.0, side, 0.0)) for side in (half, -half)]
    front = (base, 0.0, front_radius - radius)
    front_mass = FRONT_AXLE + 2.0 * tractor.front_wheel_mass
    whole = _Mass(tractor.mass, (tractor.ahead, 0.0, tractor.height - radius))
    frame = _without(whole, [*wheels, _Mass(front_mass, front)])
    beam = _inertial(_Mass(FRONT_AXLE, (0.0, 0.0, 0.0)), (0.1, tractor.front_track, 0.1))
    swing = _hinge("swing", "1 0 0", damping=_SWING_DAMPING, limit=tractor.axle_swing)
    steered = "".join(
        _wheel(
            f"front_{name}", (0.0, side, 0.0), tractor.front_wheel_mass, front_radius, _hinge(f"steer_{name}", "0 0 1")
        )
        for name, side in (("left", front_half), ("right", -front_half))
    )
    return _body(
        "tractor",
        (0.0, 0.0, 0.0),
        '<freejoint name="tractor"/>',
        _inertial(frame, (base + 0.6, 0.7 * tractor.track, 0.8)),
        _wheel("rear_left", (0.0, half, 0.0), tractor.wheel_mass, radius),
        _wheel("rear_right", (0.0, -half, 0.0), tractor.wheel_mass, radius),
        _body("front_axle", front, swing, beam, steered),
        _drawbar(vehicle, settings),
    )


def _drawbar(vehicle: VehicleParameters, settings: PhysicsMachineSettings) -> str:
    """Return drawbar and trailer: RJ1 turns about three axes, RJ2 about one.

    Both yaw axes point down, so that their angles are beta = theta - phi and phi - psi.
    """
    tractor, trailer, length = settings.tractor, settings.trailer, vehicle.drawbar_length
    place = (-vehicle.free_joint_offset, 0.0, tractor.hitch_height - tractor.radius)
    axes = (("hitch", "0 0 -1"), ("hitch_pitch", "0 1 0"), ("hitch_roll", "1 0 0"))
    return _body(
        "drawbar",
        place,
        *(_hinge(name, axis, damping=_HITCH_DAMPING) for name, axis in axes),
        _inertial(_Mass(trailer.drawbar_mass, (-0.5 * length, 0.0, 0.0)), (length + 0.2, 0.2, 0.2)),
        _trailer(vehicle, settings),
    )


def _trailer(vehicle: VehicleParameters, settings: PhysicsMachineSettings) -> str:
    trailer, hitch = settings.trailer, settings.tractor.hitch_height
    axle, half = -vehicle.trailer_length, 0.5 * trailer.track
    wheels = {name: (axle, side, trailer.radius - hitch) for name, side in (("left", half), ("right", -half))}
    whole = _Mass(trailer.mass, (axle + trailer.ahead, 0.0, trailer.height - hitch))
    frame = _without(whole, [_Mass(trailer.wheel_mass, place) for place in wheels.values()])
    return _body(
        "trailer",
        (-vehicle.drawbar_length, 0.0, 0.0),
        _hinge("joint", "0 0 -1"),
        _inertial(frame, (vehicle.trailer_length + 0.6, 0.8 * trailer.track, 0.6)),
        *(_wheel(f"trailer_{name}", place, trailer.wheel_mass, trailer.radius) for name, place in wheels.items()),
    )


def _actuators(settings: PhysicsMachineSettings) -> str:
    servos = settings.servos
    steering = (("steer_left", servos.wheel), ("steer_right", servos.wheel), ("joint", servos.joint))
    held = [_servo(name, f'joint="{name}"', stiffness, _SERVO_DAMPING) for name, stiffness in steering]
    return "".join([*held, _servo("drive", 'tendon="differential"', servos.drive, DRIVE_DAMPING)])


def _servo(name: str, moved: str, stiffness: float, damping: float) -> str:
    """Return an actuator with the force stiffness (control - position - damping velocity)."""
    bias = f"0 {-stiffness:.9g} {-stiffness * damping:.9g}"
    return f'<general name="{name}" {moved} gainprm="{stiffness:.9g}" biastype="affine" biasprm="{bias}"/>'


def _body(name: str, place: Vector, *inner: str) -> str:
    return f'<body name="{name}" pos="{_numbers(place)}">{"".join(inner)}</body>\n'


def _wheel(name: str, place: Vector, mass: float, radius: float, steering: str = "") -> str:
    """Return a wheel that spins about its left axis, steered where it is."""
    across, along = 0.25 * mass * radius**2, 0.5 * mass * radius**2
    inertial = f'<inertial pos="0 0 0" mass="{mass:.9g}" diaginertia="{_numbers((across, along, across))}"/>'
    return _body(name, place, steering, _hinge(name, "0 1 0"), inertial)


def _hinge(name: str, axis: str, *, damping: float = 0.0, limit: float = 0.0) -> str:
    stops = f' limited="true" range="{-limit:.9g} {limit:.9g}"' if limit else ""
    return f'<joint name="{name}" type="hinge" axis="{axis}" damping="{damping:.9g}"{stops}/>'


def _inertial(mass: _Mass, size: Vector) -> str:
    """Return the inertia of a box (length, width, height, m) of even density around its centre."""
    length, width, height = size
    squares = (width**2 + height**2, length**2 + height**2, length**2 + width**2)
    inertia = tuple(mass.mass / 12.0 * square for square in squares)
    return f'<inertial pos="{_numbers(mass.place)}" mass="{mass.mass:.9g}" diaginertia="{_numbers(inertia)}"/>'


def _without(whole: _Mass, parts: Iterable[_Mass]) -> _Mass:
    """Return what is left of a mass when parts of it are taken separately."""
    taken = list(parts)
    mass = whole.mass - math.fsum(part.mass for part in taken)
    x, y, z = (
        (whole.mass * centre - math.fsum(part.mass * part.place[axis] for part in taken)) / mass
        for axis, centre in enumerate(whole.place)
    )
    return _Mass(mass, (x, y, z))


def _numbers(values: Sequence[float]) -> str:
    return " ".join(f"{value:.9g}" for value in values)
