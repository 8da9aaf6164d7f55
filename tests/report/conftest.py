"""A made-up run of the figure-eights: no machine, no controller, only signals that look like one."""

import dataclasses
from datetime import UTC, datetime

import numpy as np
import pytest

from drawbar.guidance.figure_eight import figure_eights
from drawbar.recording.log import Outcome, RunHeader, RunLog
from drawbar.recording.path_table import PathTable
from drawbar.signals import (
    BodyPlan,
    BodySteering,
    Command,
    Estimate,
    Flag,
    GateVerdict,
    Measurement,
    Places,
    Plan,
    Pose,
    RecordedPlace,
    SolverStatus,
    SolveTimes,
    Status,
    StepRecord,
    Truth,
)
from drawbar.vehicle.parameters import VehicleParameters

DT = 0.2
VEHICLE = VehicleParameters()
TRAILER_BEHIND = 2.15
NOTHING = np.zeros((2, 4))
NO_PLAN = BodyPlan(steering=0.0, poses=NOTHING[:, :3], steerings=NOTHING[0, :1], status=SolverStatus.SOLVED)


def slow_noise(rng, count, deviation, seconds):
    keep = np.exp(-DT / seconds)
    steps = rng.normal(size=count) * deviation * np.sqrt(1.0 - keep**2)
    values = [0.0]
    for step in steps[1:]:
        values.append(keep * values[-1] + step)
    return np.array(values)


def body_signals(path, progress, rng, deviation):
    """Return pose (n, 3), lateral error (n,) and curvature (n,) of a body that follows the path almost."""
    samples = path.sample(progress)
    error = slow_noise(rng, len(progress), deviation, 2.0) + 0.05 * samples[:, 3]
    normal = np.column_stack([-np.sin(samples[:, 2]), np.cos(samples[:, 2])])
    pose = samples[:, :3].copy()
    pose[:, :2] += error[:, None] * normal
    return pose, error, samples[:, 3]


def fake_header(seed=0):
    return RunHeader(
        configuration_name="articulated",
        configuration="[vehicle]\n",
        seed=seed,
        started=datetime(2026, 5, 4, 13, 2, 1, tzinfo=UTC),
        vehicle=VEHICLE,
        path=PathTable.of(figure_eights([10.0, 8.0, 20.0 / 3.0], 20.0)),
        path_name="three figure-eights",
        path_note="",
        recorded=None,
        estimate_bounds={
            "longitudinal_slip": (0.25, 1.0),
            "tractor_slip": (0.5, 1.1),
            "steering_offset": (-0.15, 0.15),
            "tractor_crab": (-0.15, 0.15),
            "trailer_crab": (-0.15, 0.15),
        },
    )


@dataclasses.dataclass(frozen=True, kw_only=True)
class Body:
    """What one body does: n steps."""

    pose: np.ndarray
    progress: np.ndarray
    error: np.ndarray
    nominal: np.ndarray
    ancillary: np.ndarray
    command: np.ndarray
    steering: np.ndarray

    @classmethod
    def along(cls, path, progress, rng, *, deviation, feed_forward, restless, limit):
        """Follow the path almost; the steering is feed_forward times its curvature, and restless (rad)."""
        pose, error, curvature = body_signals(path, progress, rng, deviation)
        nominal = feed_forward * curvature + slow_noise(rng, len(progress), 0.02, 1.0)
        ancillary = slow_noise(rng, len(progress), restless, 0.6)
        command = np.clip(nominal + ancillary, -limit, limit)
        steering = 0.6 * np.concatenate([[0.0], command[:-1]]) + 0.4 * command
        return cls(
            pose=pose,
            progress=progress,
            error=error,
            nominal=nominal,
            ancillary=ancillary,
            command=command,
            steering=steering,
        )

    def pose_at(self, k, turned=0.0):
        x, y, yaw = self.pose[k].tolist()
        return Pose(x=x, y=y, yaw=yaw + turned)

    def reference_at(self, k, noise):
        error = float(self.error[k] + 0.005 * noise)
        return RecordedPlace(progress=float(self.progress[k]), lateral_error=error, closest=NOTHING[0])

    def steering_at(self, k):
        nominal, ancillary, command = (float(each[k]) for each in (self.nominal, self.ancillary, self.command))
        saturated = command != nominal + ancillary
        margin = 1.0 - abs(ancillary) / 0.05
        return BodySteering(nominal=nominal, ancillary=ancillary, command=command, saturated=saturated, margin=margin)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Drive:
    """Everything that a made-up run is made of: n steps."""

    tractor: Body
    trailer: Body
    mu: np.ndarray
    kappa: np.ndarray
    crab: np.ndarray
    noise: np.ndarray
    times: np.ndarray

    @classmethod
    def along(cls, path, rng, steps):
        progress = np.arange(0.0, path.length, 0.95 * DT)[:steps]
        count = len(progress)
        front = {"deviation": 0.016, "feed_forward": 1.5, "restless": np.radians(0.2)}
        back = {"deviation": 0.011, "feed_forward": 1.8, "restless": np.radians(0.7)}
        return cls(
            tractor=Body.along(path, progress, rng, limit=VEHICLE.tractor_steering_limit, **front),
            trailer=Body.along(path, progress - TRAILER_BEHIND, rng, limit=VEHICLE.trailer_steering_limit, **back),
            mu=0.95 + slow_noise(rng, count, 0.02, 20),
            kappa=0.92 + slow_noise(rng, count, 0.03, 20),
            crab=np.radians(0.4) * np.column_stack([slow_noise(rng, count, 1.0, 5) for _ in range(2)]),
            noise=rng.normal(size=(count, 6)),
            times=rng.lognormal(np.log([14e-6, 5e-6, 3e-6, 1e-6, 4e-6, 1.4e-6]), 0.15, size=(count, 6)),
        )

    def motion_at(self, k):
        """Return what truth, estimate and measurement agree on."""
        steerings = {
            "tractor_steering": float(self.tractor.steering[k]),
            "trailer_steering": float(self.trailer.steering[k]),
        }
        return {"time": k * DT, "speed": 1.0, **steerings}

    def measurement_at(self, k):
        gps = np.nan if 300 < k < 315 else 0.03  # the fix is lost for a while
        fixes = np.concatenate([self.tractor.pose[k, :2], self.trailer.pose[k, :2]]) + gps * self.noise[k, :4]
        names = ("tractor_x", "tractor_y", "trailer_x", "trailer_y")
        return Measurement(hitch_angle=0.0, **dict(zip(names, fixes.tolist(), strict=True)), **self.motion_at(k))

    def estimate_at(self, k):
        return Estimate(
            tractor=self.tractor.pose_at(k, turned=0.008 * self.noise[k, 4]),
            trailer=self.trailer.pose_at(k, turned=0.006 * self.noise[k, 5]),
            hitch_angle=0.0,
            longitudinal_slip=min(self.mu[k] + 0.006 * self.noise[k, 0], 1.0),
            tractor_slip=self.kappa[max(k - 8, 0)],
            trailer_slip=1.0,
            steering_offset=0.002,
            tractor_crab=0.7 * self.crab[max(k - 4, 0), 0],
            trailer_crab=0.7 * self.crab[max(k - 4, 0), 1],
            status=SolverStatus.SOLVED,
            **self.motion_at(k),
        )

    def truth_at(self, k):
        return Truth(
            tractor=self.tractor.pose_at(k),
            trailer=self.trailer.pose_at(k),
            longitudinal_slip=self.mu[k],
            tractor_slip=self.kappa[k],
            steering_offset=0.0,
            tractor_crab=self.crab[k, 0],
            trailer_crab=self.crab[k, 1],
            **self.motion_at(k),
        )

    def record_at(self, k, truth):
        time, tractor, trailer = k * DT, self.tractor.steering_at(k), self.trailer.steering_at(k)
        wheels = {"tractor_steering": tractor.command, "trailer_steering": trailer.command}
        solve = [SolveTimes(prepare=float(a), feedback=float(b)) for a, b in self.times[k].reshape(3, 2)]
        return StepRecord(
            step=k,
            measurement=self.measurement_at(k),
            estimate=self.estimate_at(k),
            reference=Places(
                time=time,
                tractor=self.tractor.reference_at(k, self.noise[k, 2]),
                trailer=self.trailer.reference_at(k, self.noise[k, 3]),
            ),
            plan=Plan(time=time, tractor=NO_PLAN, trailer=NO_PLAN),
            tractor_steering=tractor,
            trailer_steering=trailer,
            command=Command(time=time, speed=1.0, **wheels),
            truth=self.truth_at(k) if truth else None,
            estimator_times=solve[0],
            tractor_times=solve[1],
            trailer_times=solve[2],
            solver_failures=0,
            gate=GateVerdict.PASSED,
            status=Status.OK,
            flags=Flag(0),
        )


def fake_run(*, seed=0, truth=True, steps=None, outcome=None):
    header = fake_header(seed)
    drive = Drive.along(header.path.path(), np.random.default_rng(seed), steps)
    count = len(drive.times)
    return RunLog(
        header=header,
        records=tuple(drive.record_at(k, truth) for k in range(count)),
        wall_time=1.8e9 + np.arange(count) * DT / 700,
        outcome=outcome or Outcome(finished=True, reason="the path was driven to its end"),
    )


@pytest.fixture(scope="session")
def run():
    return fake_run()


@pytest.fixture(scope="session")
def make_run():
    return fake_run


@pytest.fixture(scope="session")
def never_steered():
    """Return a drive on a real machine with the driver at the wheel all the time."""
    log = fake_run(truth=False)
    return dataclasses.replace(log, records=tuple(dataclasses.replace(r, flags=Flag.RELEASED) for r in log.records))
