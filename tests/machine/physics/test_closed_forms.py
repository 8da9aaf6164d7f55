"""The physics against what can be computed by hand: loads, circles, crabs, stopping distances, rest."""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drawbar.geometry import Floats
from drawbar.machine.physics.machine import PhysicsMachine
from drawbar.machine.physics.settings import TractorBodySettings, TrailerBodySettings, TyreSettings
from drawbar.machine.settings import HydrostatSettings
from drawbar.signals import Truth
from drawbar.vehicle.parameters import VehicleParameters

Build = Callable[..., PhysicsMachine]
Drive = Callable[..., list[Truth]]
G = 9.81
SLOPE = math.radians(5.0)
VEHICLE, TRACTOR, TRAILER, TYRES = VehicleParameters(), TractorBodySettings(), TrailerBodySettings(), TyreSettings()
TOTAL = TRACTOR.mass + TRAILER.mass + TRAILER.drawbar_mass
BEHIND = VEHICLE.drawbar_length + VEHICLE.trailer_length
"""from the free joint RJ1 to the trailer's axle, m"""


def axle_shares() -> tuple[float, float, float]:
    """Return what rear, front and trailer axle carry on level ground, kg, by moments about RJ1 and the rear axle."""
    trailer = TRAILER.mass * (BEHIND - TRAILER.ahead) + TRAILER.drawbar_mass * 0.5 * VEHICLE.drawbar_length
    trailer /= BEHIND
    hitch = TRAILER.mass + TRAILER.drawbar_mass - trailer
    front = (TRACTOR.mass * TRACTOR.ahead - hitch * VEHICLE.free_joint_offset) / VEHICLE.wheelbase
    return TOTAL - trailer - front, front, trailer


def test_static_wheel_loads_on_level_ground(build: Build, drive: Drive) -> None:
    machine = build()
    drive(machine, 10, speed=0.0)
    expected = [0.5 * G * share for share in axle_shares() for _ in range(2)]
    assert machine.multibody.loads == pytest.approx(expected, rel=5e-3)


def test_static_wheel_loads_on_a_side_slope(build: Build, drive: Drive) -> None:
    """Facing east on ground that falls to the south, the right wheels carry more.

    The trailer hangs on a ball joint: its loads follow from moments about RJ1. What it leans onto its tyres adds 0.1°
    to the slope.
    """
    machine = build(terrain={"slope": SLOPE})
    drive(machine, 25, speed=0.0)
    assert machine.multibody.loads.sum() == pytest.approx(TOTAL * G, rel=1e-3)
    _, _, trailer = axle_shares()
    side = trailer * G * math.sin(SLOPE)  # of the trailer's tyres, by moments about the upright through RJ1
    hitch, half_track = TRACTOR.hitch_height, 0.5 * TRAILER.track
    overturning = TRAILER.mass * G * math.sin(SLOPE) * (TRAILER.height - hitch) + side * hitch
    transfer = overturning / (2.0 * half_track)
    left = 0.5 * trailer * G * math.cos(SLOPE) - transfer
    right = 0.5 * trailer * G * math.cos(SLOPE) + transfer
    normal = np.array(machine.multibody._forces.wrenches[:, :3]) @ (0.0, -math.sin(SLOPE), math.cos(SLOPE))
    assert (normal[4], normal[5]) == pytest.approx((left, right), rel=0.02)


def radius(truths: list[Truth], body: str) -> float:
    """Fit a circle to a body's track and return its radius, m."""
    poses = [getattr(truth, body) for truth in truths]
    x, y = np.array([(pose.x, pose.y) for pose in poses]).T
    columns = np.column_stack((x, y, np.ones_like(x)))
    east, north, rest = np.linalg.lstsq(columns, x**2 + y**2)[0].tolist()
    return math.sqrt(rest + 0.25 * (east**2 + north**2))


@pytest.mark.parametrize("steering", [0.25, -0.4])
@pytest.mark.parametrize("joint", [0.0, 0.2])
def test_circles_of_both_bodies(build: Build, drive: Drive, steering: float, joint: float) -> None:
    machine = build(tyres={"rolling_resistance": 0.0})
    truths = drive(machine, 300, tractor=steering, trailer=joint, speed=0.3)[150:]
    rear = VEHICLE.wheelbase / math.tan(abs(steering))
    inward = math.copysign(joint, joint * steering)
    ahead, aside = (
        VEHICLE.trailer_length + VEHICLE.drawbar_length * math.cos(inward),
        VEHICLE.drawbar_length * math.sin(inward),
    )
    # RJ1 runs on one circle, whichever body it is seen from
    axle = aside + math.sqrt(rear**2 + VEHICLE.free_joint_offset**2 - ahead**2)
    assert radius(truths, "tractor") == pytest.approx(rear, rel=0.003)
    assert radius(truths, "trailer") == pytest.approx(math.hypot(axle, VEHICLE.trailer_antenna), rel=0.003)


def test_inner_wheels_steer_more_and_spin_slower(build: Build, drive: Drive) -> None:
    machine = build()
    drive(machine, 60, tractor=0.4, speed=0.5)
    data, model = machine.multibody._data, machine.multibody._model
    left, right = (float(data.qpos[model.joint(name).qposadr[0]]) for name in ("steer_left", "steer_right"))
    assert 1.0 / math.tan(right) - 1.0 / math.tan(left) == pytest.approx(
        TRACTOR.front_track / VEHICLE.wheelbase, rel=1e-2
    )
    slow, fast = (float(data.qvel[model.joint(name).dofadr[0]]) for name in ("rear_left", "rear_right"))
    rear, half = VEHICLE.wheelbase / math.tan(0.4), 0.5 * TRACTOR.track
    assert fast / slow == pytest.approx((rear + half) / (rear - half), rel=0.01)


@pytest.mark.parametrize("downhill", [-1.0, 1.0])
@pytest.mark.parametrize(
    ("ground", "speed", "share"),
    [
        ({}, 1.0, 1.0 / TYRES.cornering),
        ({"creep": 0.36}, 1.0, 0.36),
        ({"creep": 0.36}, 2.0, 0.36),
        ({"creep": 0.36, "creep_speed": 1.0}, 0.5, 0.72),
        ({"creep": 0.36, "creep_speed": 1.0}, 2.0, 0.18),
        ({"creep": 0.05, "creep_speed": 1.0}, 2.0, 1.0 / TYRES.cornering),
    ],
)
def test_crab_on_a_side_slope(
    build: Build, drive: Drive, ground: dict[str, float], speed: float, share: float, downhill: float
) -> None:
    """Side force and load of every axle are the same shares of the weight: tan(crab) = share tan(slope).

    On soil the share is the ground's creep at any speed, and 1 / c where that is more; in a contact with viscous
    friction it is the creep at one speed, and falls with the speed, but not below 1 / c.
    """
    terrain = {"slope": SLOPE, "downhill": 0.5 * math.pi * downhill, **ground}
    machine = build(terrain=terrain, tyres={"rolling_resistance": 0.0})
    truths = drive(machine, 110, speed=speed)[80:]  # the truth averages over 2 s
    expected = downhill * math.atan(math.tan(SLOPE) * share)
    assert np.mean([truth.tractor_crab for truth in truths]) == pytest.approx(expected, rel=0.02)
    assert np.mean([truth.trailer_crab for truth in truths]) == pytest.approx(expected, rel=0.02)
    assert machine.slide(speed).across(truths[-1].tractor.yaw, speed, 0.0) == pytest.approx(expected, rel=0.02)
    if share == 0.36:
        assert abs(math.degrees(expected)) == pytest.approx(1.8, abs=0.01)  # the soft ground of the validation


@pytest.mark.parametrize("creep", [0.0, 0.36])
def test_a_curve_draws_the_trailers_axle_outwards_as_the_slide_tells(build: Build, drive: Drive, creep: float) -> None:
    machine = build(terrain={"creep": creep})
    *_, before, last = drive(machine, 100, speed=2.0, tractor=0.2)
    turn = (last.trailer.yaw - before.trailer.yaw) / 0.2
    told = machine.slide(2.0).across(last.trailer.yaw, 2.0, turn)
    assert told < (-0.01 if creep else -0.001)
    assert last.trailer_crab == pytest.approx(told, rel=0.1, abs=1e-3)


def test_a_vehicle_at_rest_slides_where_the_contact_creeps_at_a_speed(build: Build, drive: Drive) -> None:
    machine = build(terrain={"slope": SLOPE, "creep": 0.36, "creep_speed": 0.5})
    first, *_, last = drive(machine, 50, speed=0.0)[20:]
    slid = 0.36 * 0.5 * math.sin(SLOPE) * (last.time - first.time)  # the drive lets no wheel turn
    assert first.tractor.y - last.tractor.y == pytest.approx(slid, rel=0.02)
    assert first.trailer.y - last.trailer.y == pytest.approx(slid, rel=0.02)


@pytest.mark.parametrize("creep", [0.0, 0.36])
def test_the_carcass_is_as_stiff_on_soft_ground(build: Build, drive: Drive, creep: float) -> None:
    """A vehicle at rest that is pushed with a tenth of its weight moves aside by 0.1 s / c, whatever it stands on."""
    machine = build(terrain={"creep": creep})
    before = drive(machine, 5, speed=0.0)[-1]
    machine.multibody._model.opt.gravity[1] = 0.1 * G
    after = drive(machine, 10, speed=0.0)[-1]
    for body in ("tractor", "trailer"):
        aside = getattr(after, body).y - getattr(before, body).y
        assert aside == pytest.approx(0.1 * TYRES.relaxation / TYRES.cornering, rel=0.08)  # it leans as well


@pytest.mark.parametrize(
    ("creep", "creep_speed", "speed"), [(0.36, 0.0, 0.3), (0.36, 0.0, 3.0), (1.0, 0.0, 3.0), (0.36, 1.0, 3.0)]
)
def test_a_push_aside_dies(build: Build, drive: Drive, creep: float, creep_speed: float, speed: float) -> None:
    """The ground's creep takes the momentum M v over a way of creep V v / g, and nothing swings on."""
    machine = build(terrain={"creep": creep, "creep_speed": creep_speed}, tyres={"rolling_resistance": 0.0})
    before, push = drive(machine, 40, speed=speed)[-1], 0.1
    machine.multibody._data.qvel[1] += push  # of the tractor; all other bodies move relative to it
    after = drive(machine, 25, speed=speed)[-1]
    way = creep * (creep_speed or speed) * push / G - push * machine.multibody._model.opt.timestep  # of the first step
    for body in ("tractor", "trailer"):
        assert getattr(after, body).y - getattr(before, body).y == pytest.approx(way, abs=1e-4)
    assert abs(machine.multibody._data.qvel[1]) < 1e-4 * push


def test_stopping_distance_of_the_hydrostat(build: Build, drive: Drive) -> None:
    """The vehicle stops as its drive alone would, and slips meanwhile: M v² / 2 = c N (way slipped)."""
    machine, speed = build(tyres={"rolling_resistance": 0.0}), 0.5
    before = drive(machine, 125, speed=speed)[-1]
    after = drive(machine, 100, speed=0.0)[-1]
    slipped = TOTAL * speed**2 / (2.0 * TYRES.cornering * axle_shares()[0] * G)
    distance = after.tractor.x - before.tractor.x
    assert distance == pytest.approx(hydrostat_distance(speed, 20.0) + slipped, rel=0.02)


def hydrostat_distance(speed: float, duration: float) -> float:
    """Return how far the drive rolls when it is told to stop, m: the cascade of two PIDs, written out."""
    hydrostat = HydrostatSettings()
    outer, inner = hydrostat.speed_loop, hydrostat.pedal_loop

    def rates(_: float, state: Floats) -> list[float]:
        v, pedal, motion, outer_sum, inner_sum, _way = state
        acceleration = (hydrostat.full_speed * pedal - v) / hydrostat.speed_lag
        wanted = -outer.proportional * v + outer.integral * outer_sum - outer.derivative * acceleration
        target = min(max(wanted, -1.0), 1.0)
        push = inner.proportional * (target - pedal) + inner.integral * inner_sum - inner.derivative * motion
        motor = min(max(push, -hydrostat.pedal_rate), hydrostat.pedal_rate)
        return [
            acceleration,
            motion,
            (motor - motion) / hydrostat.pedal_lag,
            -v - (wanted - target) / outer.proportional,
            target - pedal - (push - motor) / inner.proportional,
            v,
        ]

    pedal = speed / hydrostat.full_speed
    start = [speed, pedal, 0.0, pedal / outer.integral, 0.0, 0.0]
    return float(solve_ivp(rates, (0.0, duration), start, max_step=0.01).y[-1, -1])


def test_stopping_distance_on_slippery_ground(build: Build, drive: Drive) -> None:
    """Locked rear wheels slide: friction times what they carry is all that brakes the whole mass."""
    friction = 0.05
    machine = build(tyres={"friction": friction, "rolling_resistance": 0.0})
    speed = [(b.tractor.x - a.tractor.x) / 0.2 for a, b in pairwise(drive(machine, 100, speed=2.0))][-1]
    loads, run = [], []
    for _ in range(10):
        run += drive(machine, 1, speed=0.0)
        loads.append(machine.multibody.loads[:2].sum())
    first, last = run[4], run[-1]
    assert last.speed == pytest.approx(0.0, abs=0.15)
    deceleration = friction * float(np.mean(loads[5:])) / TOTAL
    elapsed = last.time - first.time
    early, late = ((run[i].tractor.x - run[i - 1].tractor.x) / 0.2 for i in (4, 9))
    assert late < early < speed
    assert (early - late) / elapsed == pytest.approx(deceleration, rel=0.05)


@pytest.mark.parametrize("yaw", [0.0, 0.5 * math.pi, -0.5 * math.pi])
def test_stands_still_when_told_on_any_slope(build: Build, drive: Drive, yaw: float) -> None:
    machine = build(terrain={"slope": math.radians(8.0), "creep": 0.36}, yaw=yaw)
    drive(machine, 30, tractor=0.1)
    first, *_, last = drive(machine, 200, tractor=0.1, speed=0.0)[100:]  # the drive settles with a time constant of 2 s
    for body in ("tractor", "trailer"):
        old, new = getattr(first, body), getattr(last, body)
        assert math.hypot(new.x - old.x, new.y - old.y) < 1e-3
        assert abs(new.yaw - old.yaw) < 1e-4


def test_kinetic_energy_dies_at_rest(build: Build, drive: Drive) -> None:
    machine = build(terrain={"unevenness": 0.04})
    drive(machine, 40, speed=2.0)
    drive(machine, 100, speed=0.0)
    assert float(np.abs(machine.multibody._data.qvel).max()) < 1e-3


def test_the_drive_overcomes_the_rolling_resistance_of_the_whole_weight(build: Build, drive: Drive) -> None:
    machine = build(tyres={"rolling_resistance": 0.05})
    drive(machine, 60, speed=1.0)
    torque = float(machine.multibody._data.actuator("drive").force[0])
    force = 0.05 * TOTAL * G
    # the drive turns the mean of both wheels; undriven wheels pass on their resistance as a force on the frame
    assert torque == pytest.approx(force * TRACTOR.radius, rel=0.03)
