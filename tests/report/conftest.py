"""A made-up run of the figure-eights: no machine, no controller, only signals that look like one."""

from datetime import UTC, datetime

import numpy as np
import pytest

from drawbar.autopilot.log import Outcome, PathTable, RunHeader, RunLog
from drawbar.guidance.figure_eight import figure_eights
from drawbar.signals import (
    BodyPlan,
    BodyReference,
    BodySteering,
    Command,
    Estimate,
    Measurement,
    Plan,
    Pose,
    Reference,
    SolverStatus,
    SolveTimes,
    StepRecord,
    Truth,
)
from drawbar.vehicle.parameters import VehicleParameters

DT = 0.2
VEHICLE = VehicleParameters()
TRAILER_BEHIND = 2.15
NOTHING = np.zeros((2, 4))


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


def pose_of(row):
    return Pose(x=float(row[0]), y=float(row[1]), yaw=float(row[2]))


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
        estimate_bounds={
            "longitudinal_slip": (0.25, 1.0),
            "tractor_slip": (0.5, 1.1),
            "steering_offset": (-0.15, 0.15),
            "tractor_crab": (-0.15, 0.15),
            "trailer_crab": (-0.15, 0.15),
        },
    )


def fake_run(*, seed=0, truth=True, steps=None, outcome=None):
    rng = np.random.default_rng(seed)
    header = fake_header(seed)
    path = header.path.path()
    progress = np.arange(0.0, path.length, 0.95 * DT)[:steps]
    count = len(progress)
    tractor, tractor_error, curvature = body_signals(path, progress, rng, 0.016)
    trailer, trailer_error, _ = body_signals(path, progress - TRAILER_BEHIND, rng, 0.011)
    mu, kappa = 0.95 + slow_noise(rng, count, 0.02, 20), 0.92 + slow_noise(rng, count, 0.03, 20)
    crab = np.radians(0.4) * np.column_stack([slow_noise(rng, count, 1.0, 5) for _ in range(4)])
    steer = np.arctan(VEHICLE.wheelbase * curvature) / 0.92
    ancillary = slow_noise(rng, count, np.radians(0.2), 0.6), slow_noise(rng, count, np.radians(0.7), 0.6)
    nominal = steer + slow_noise(rng, count, 0.01, 1.0), curvature * 1.8 + slow_noise(rng, count, 0.02, 1.0)
    limits = VEHICLE.tractor_steering_limit, VEHICLE.trailer_steering_limit
    asked = [n + a for n, a in zip(nominal, ancillary, strict=True)]
    commands = [np.clip(a, -limit, limit) for a, limit in zip(asked, limits, strict=True)]
    lagged = [np.concatenate([[0.0], c[:-1]]) * 0.6 + c * 0.4 for c in commands]
    times = rng.lognormal(np.log([14e-6, 5e-6, 3e-6, 1e-6, 4e-6, 1.4e-6]), 0.15, size=(count, 6))

    def record(k):
        t = k * DT
        bodies = {"tractor": pose_of(tractor[k]), "trailer": pose_of(trailer[k])}
        steerings = {"tractor_steering": float(lagged[0][k]), "trailer_steering": float(lagged[1][k])}
        noise = rng.normal(size=6)
        lost = 300 < k < 315
        gps = np.nan if lost else 0.03
        measurement = Measurement(
            time=t,
            tractor_x=tractor[k, 0] + gps * noise[0],
            tractor_y=tractor[k, 1] + gps * noise[1],
            trailer_x=trailer[k, 0] + gps * noise[2],
            trailer_y=trailer[k, 1] + gps * noise[3],
            hitch_angle=0.0,
            speed=1.0,
            **steerings,
        )
        estimate = Estimate(
            time=t,
            tractor=Pose(x=bodies["tractor"].x, y=bodies["tractor"].y, yaw=bodies["tractor"].yaw + 0.008 * noise[4]),
            trailer=Pose(x=bodies["trailer"].x, y=bodies["trailer"].y, yaw=bodies["trailer"].yaw + 0.006 * noise[5]),
            hitch_angle=0.0,
            speed=1.0,
            **steerings,
            longitudinal_slip=min(mu[k] + 0.006 * noise[0], 1.0),
            tractor_slip=kappa[max(k - 8, 0)],
            trailer_slip=1.0,
            steering_offset=0.002,
            tractor_crab=0.7 * crab[max(k - 4, 0), 0],
            trailer_crab=0.7 * crab[max(k - 4, 0), 1],
            status=SolverStatus.SOLVED,
        )
        real = Truth(
            time=t,
            **bodies,
            speed=1.0,
            **steerings,
            longitudinal_slip=mu[k],
            tractor_slip=kappa[k],
            steering_offset=0.0,
            tractor_crab=crab[k, 0],
            trailer_crab=crab[k, 1],
        )
        plan = BodyPlan(steering=0.0, poses=NOTHING[:, :3], steerings=NOTHING[0, :1], status=SolverStatus.SOLVED)
        steering = [
            BodySteering(
                nominal=float(nominal[i][k]),
                ancillary=float(ancillary[i][k]),
                command=float(commands[i][k]),
                saturated=bool(commands[i][k] != asked[i][k]),
            )
            for i in (0, 1)
        ]
        solve = [SolveTimes(prepare=float(a), feedback=float(b)) for a, b in times[k].reshape(3, 2)]
        return StepRecord(
            step=k,
            measurement=measurement,
            estimate=estimate,
            reference=Reference(
                time=t,
                tractor=BodyReference(
                    progress=float(progress[k]),
                    lateral_error=tractor_error[k] + 0.005 * noise[2],
                    samples=NOTHING,
                ),
                trailer=BodyReference(
                    progress=float(progress[k] - TRAILER_BEHIND),
                    lateral_error=trailer_error[k] + 0.005 * noise[3],
                    samples=NOTHING,
                ),
            ),
            plan=Plan(time=t, tractor=plan, trailer=plan),
            tractor_steering=steering[0],
            trailer_steering=steering[1],
            command=Command(
                time=t, tractor_steering=steering[0].command, trailer_steering=steering[1].command, speed=1.0
            ),
            truth=real if truth else None,
            estimator_times=solve[0],
            tractor_times=solve[1],
            trailer_times=solve[2],
            solver_failures=0,
            command_refused=False,
        )

    return RunLog(
        header=header,
        records=tuple(record(k) for k in range(count)),
        wall_time=1.8e9 + np.arange(count) * DT / 700,
        outcome=outcome or Outcome(finished=True, reason="the path was driven to its end"),
    )


@pytest.fixture(scope="session")
def run():
    return fake_run()


@pytest.fixture(scope="session")
def make_run():
    return fake_run
