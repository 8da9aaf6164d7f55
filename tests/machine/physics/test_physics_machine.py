"""The whole physics machine: sensors on leaning masts, randomness, how a configuration chooses it, refusals."""

import math
import re
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from drawbar.config import Configuration, load_configuration, recorded_configuration
from drawbar.errors import ConfigurationError, HardwareError
from drawbar.geometry import Floats
from drawbar.machine.base import MachineWithTruth
from drawbar.machine.physics.machine import PhysicsMachine
from drawbar.machine.physics.settings import PhysicsMachineSettings
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.machine.simulated import SimulatedMachine
from drawbar.signals import Command, Measurement, Pose, Truth
from drawbar.simulation import Simulation
from drawbar.vehicle.parameters import Mast, Masts, VehicleParameters

Build = Callable[..., PhysicsMachine]
Drive = Callable[..., list[Truth]]
MASTS = VehicleParameters(
    masts=Masts(tractor=Mast(forward=0.6, left=-0.2, up=2.5), trailer=Mast(forward=-0.1, left=0.3, up=2.0))
)
ALL_SENSORS = {"tractor": {"present": True}, "trailer": {"present": True}}


def weave(machine: MachineWithTruth, samples: int) -> list[tuple[Measurement, Truth]]:
    run = []
    for k in range(samples):
        run.append((machine.read(), machine.truth()))
        steering = 0.3 * math.sin(0.1 * k)
        machine.write(Command(time=0.2 * k, tractor_steering=steering, trailer_steering=-0.1, speed=1.5))
    return run


def frame(machine: PhysicsMachine, body: str) -> tuple[Floats, Floats]:
    """Return MuJoCo's own frame of a body: origin (3,) in m, and axes (3, 3) in columns."""
    data = machine.multibody._data.body(body)
    return np.array(data.xpos), np.array(data.xmat).reshape(3, 3)


def test_antennas_ride_on_both_bodies(build: Build) -> None:
    """The receivers' positions are those of points fixed to MuJoCo's bodies, however these lean."""
    machine = build(vehicle=MASTS, terrain={"slope": 0.1, "unevenness": 0.04})
    for k in range(60):
        seen = machine.read()
        for body, point, arm in (
            ("tractor", (0.0, 0.0, -(0.45 - 0.012)), (0.6, -0.2, 2.5)),
            ("trailer", (0.25 - 1.3, 0.0, -(0.4 - 0.012)), (-0.1, 0.3, 2.0)),
        ):
            origin, axes = frame(machine, body)
            antenna = origin + axes @ (np.array(point) + np.array(arm))
            assert (getattr(seen, f"{body}_x"), getattr(seen, f"{body}_y")) == pytest.approx(antenna[:2], abs=1e-9)
        machine.write(Command(time=0.2 * k, tractor_steering=0.2, trailer_steering=0.1, speed=1.0))


@pytest.mark.parametrize(
    ("yaw", "roll", "pitch"),
    [(0.0, 1.0, 0.0), (math.pi, -1.0, 0.0), (0.5 * math.pi, 0.0, 1.0), (-0.5 * math.pi, 0.0, -1.0)],
)
def test_signs_of_roll_and_pitch(build: Build, drive: Drive, yaw: float, roll: float, pitch: float) -> None:
    """The ground falls to the south: facing east the right side is down, facing north the nose is up."""
    slope = 0.1
    machine = build(vehicle=MASTS, yaw=yaw, terrain={"slope": slope}, attitude=ALL_SENSORS)
    truth, seen = drive(machine, 10, speed=0.0)[-1], machine.read()
    for body in ("tractor", "trailer"):
        assert getattr(truth, f"{body}_roll") == pytest.approx(roll * slope, abs=0.006)
        assert getattr(truth, f"{body}_pitch") == pytest.approx(pitch * slope, abs=0.006)
        assert getattr(seen, f"{body}_roll") == pytest.approx(roll * slope, abs=0.03)
        assert getattr(seen, f"{body}_pitch") == pytest.approx(pitch * slope, abs=0.03)


def test_points_of_both_bodies_stay_on_the_ground(build: Build) -> None:
    """Where the vehicle rolls over bumps slowly, they are where the ground is, but for what lies between its wheels."""
    machine = build(terrain={"slope": 0.05, "unevenness": 0.02, "shortest": 4.0})
    for _, truth in weave(machine, 150):
        for body in ("tractor", "trailer"):
            pose: Pose = getattr(truth, body)
            ground = float(machine.terrain.height(np.array([pose.x]), np.array([pose.y]))[0])
            assert getattr(truth, f"{body}_height") == pytest.approx(ground, abs=0.02)


def test_yaw_rate_and_steering_are_those_of_the_motion(build: Build, drive: Drive) -> None:
    exact = {body: {"present": True, "noise": 0.0, "yaw_rate_noise": 0.0} for body in ("tractor", "trailer")}
    machine = build(attitude=exact)
    before, *_ = drive(machine, 61, tractor=0.2, trailer=0.1)[-1:]
    machine.write(Command(time=0.0, tractor_steering=0.2, trailer_steering=0.1, speed=1.0))
    seen, after = machine.read(), machine.truth()
    assert seen.tractor_yaw_rate == pytest.approx((after.tractor.yaw - before.tractor.yaw) / 0.2, abs=1e-4)
    assert seen.trailer_yaw_rate == pytest.approx((after.trailer.yaw - before.trailer.yaw) / 0.2, abs=1e-4)
    assert (seen.tractor_steering, seen.trailer_steering) == pytest.approx((0.2, 0.1), abs=2e-3)
    beta = after.tractor.yaw - after.trailer.yaw - after.trailer_steering
    assert seen.hitch_angle == pytest.approx(beta, abs=1e-6)
    assert seen.speed == pytest.approx(1.0, abs=0.01)


def test_same_seed_same_run_bit_for_bit(build: Build) -> None:
    sections: dict[str, Any] = {
        "terrain": {"slope": 0.05, "unevenness": 0.03},
        "attitude": ALL_SENSORS,
        "sensors": {},
        "delays": {"fix": {"latency": 0.1, "jitter": 0.05}},
        "events": [{"kind": "gps_float", "start": 5.0, "duration": 5.0}],
    }
    one, again, other = (repr(weave(build(vehicle=MASTS, seed=seed, **sections), 80)) for seed in (3, 3, 4))
    assert one == again
    assert one != other


def test_ground_is_that_of_the_simulated_machine(build: Build) -> None:
    terrain = {"slope": 0.05, "unevenness": 0.03}
    simulated = SimulatedMachine(
        vehicle=VehicleParameters(),
        settings=SimulatedMachineSettings.model_validate({"terrain": terrain}),
        sample_time=0.2,
        start=Pose(x=0.0, y=0.0, yaw=0.0),
        seed=7,
    )
    x, y = np.random.default_rng(0).uniform(-50.0, 50.0, (2, 20))
    assert build(terrain=terrain, seed=7).terrain.height(x, y) == pytest.approx(
        simulated._terrain.height(x, y), abs=0.0
    )


def test_lost_fix_and_dead_time(build: Build, drive: Drive) -> None:
    loss = {"kind": "gps_loss", "start": 1.0, "duration": 1.0, "antenna": "trailer"}
    machine = build(events=[loss], actuators={"dead_time": 0.4})
    seen = [(seen.trailer_x, truth.tractor_steering) for seen, truth in weave(machine, 12)]
    assert [math.isnan(x) for x, _ in seen] == [5 <= k < 10 for k in range(12)]
    machine = build(actuators={"dead_time": 0.4})
    steered = [truth.tractor_steering for truth in drive(machine, 4, tractor=0.3, speed=0.0)]
    assert steered[:2] == pytest.approx([0.0, 0.0], abs=1e-4)
    assert steered[2] > 0.05


@pytest.mark.parametrize(
    "command",
    [
        {"tractor_steering": math.nan, "trailer_steering": 0.0, "speed": 1.0},
        {"tractor_steering": 0.0, "trailer_steering": 0.5, "speed": 1.0},
        {"tractor_steering": 0.0, "trailer_steering": 0.0, "speed": 5.0},
    ],
)
def test_refused_commands_leave_the_last_one(build: Build, drive: Drive, command: dict[str, float]) -> None:
    machine = build()
    drive(machine, 20)
    with pytest.raises(HardwareError, match="accepts finite values"):
        machine.write(Command(time=0.0, **command))
    machine.read()
    assert machine.truth().speed == pytest.approx(1.0, abs=0.02)


def test_configuration_chooses_the_machine() -> None:
    plain = load_configuration("articulated")
    assert isinstance(plain.machine, SimulatedMachineSettings)
    changes = ["machine.sensors.position=0.05", "machine.kind=physics", "machine.tyres.friction=0.5"]
    physics = load_configuration("articulated", changes)
    assert isinstance(physics.machine, PhysicsMachineSettings)
    assert (physics.machine.tyres.friction, physics.machine.sensors.position) == (0.5, 0.05)
    assert recorded_configuration(physics.to_toml(), [], "log") == physics
    assert isinstance(Simulation(physics).machine, PhysicsMachine)


def test_configurations_of_before_are_the_simulated_machine() -> None:
    plain = load_configuration("articulated")
    recorded = plain.model_dump(mode="json")
    del recorded["machine"]["kind"]
    assert Configuration.model_validate(recorded) == plain


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        (["machine.kind=iron"], "'simulated', 'physics'"),
        (["machine.kind=physics", "machine.ground.steering_offset=0.1"], "has no key ground"),
        (["machine.kind=physics", "machine.events=[{kind='bump', start=1.0}]"], "'gps_loss', 'gps_jump', 'gps_float'"),
        (["machine.kind=physics", "machine.actuators.dead_time=0.005"], "not a multiple"),
        (["machine.kind=physics", "machine.trailer.track=1200"], "1200 mm"),
        (["machine.kind=physics", "machine.tractor.mass=100.0"], "leaves nothing for its frame"),
        (["machine.kind=physics", "bounded_errors.ground.tractor_crab=0.01"], "bounded_errors.ground needs"),
        (["machine.kind=physics", "speed=3.5"], "or raise the other where the machine is faster"),
    ],
)
def test_impossible_configurations_are_refused(changes: list[str], reason: str) -> None:
    with pytest.raises(ConfigurationError, match=re.escape(reason)):
        load_configuration("articulated", changes)


def test_machine_that_tips_over_is_refused(build: Build) -> None:
    with pytest.raises(ConfigurationError, match="would tip over"):
        build(tractor={"ahead": 0.02})


def test_bodies_that_mujoco_refuses_are_reported(build: Build) -> None:
    with pytest.raises(ConfigurationError, match=r"inertia must satisfy .*; give them lengths"):
        build(tractor={"track": 1e-6})


def test_diverged_physics_is_refused(build: Build, drive: Drive) -> None:
    machine = build()
    machine.multibody._data.qvel[:] = 1e12
    with pytest.raises(ConfigurationError, match="diverged"):
        drive(machine, 50)


def test_missing_engine_is_named(build: Build, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(ConfigurationError, match=r"-m pip install .*mujoco"):
        build()


def test_settings_refuse_what_no_tyre_has() -> None:
    with pytest.raises(ValidationError, match="deflection"):
        PhysicsMachineSettings.model_validate({"tyres": {"deflection": 0.0}})
