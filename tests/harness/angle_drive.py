"""Drives whose angles between both bodies are measured wrongly, and what finds their errors, by itself."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from alone import Alone
from c_signals import Real

from drawbar.codegen import Unit
from drawbar.geometry import Floats, wrap
from drawbar.vehicle.articulated import trailer_antenna, trailer_yaw_rate
from drawbar.vehicle.lengths import length_values
from drawbar.vehicle.parameters import VehicleParameters

UNIT = """
#include "angle_errors.h"
#include "unit.h"
struct component { struct angle_errors errors; double points[4]; };
#define COMPONENT_FIELDS FIELD(component, errors.latency, 0, 1, 0, 0) FIELD(component, points, 0, 4, 0, 0) \\
    FIELD(component, errors.scales, 0, ANGLES, 0, 0) FIELD(component, errors.state, 0, ANGLE_STATES, 0, 0) \\
    FIELD(component, errors.covariance, 0, ANGLE_STATES, ANGLE_STATES, 0)
int UNIT(taken)(struct component *component, double yaw, double hitch, double joint, double bent, double swung,
                double creep, double sways, double ahead, double elapsed)
{
    struct angle_sample sample = {.yaw = yaw, .angles = {hitch, joint}, .bent = bent, .swung = swung, .creep = creep,
                                  .sways = sways > 0.0};

    memcpy(sample.points, component->points, sizeof sample.points);
    angle_errors_take(&component->errors, &sample, ahead, elapsed);
    return 0;
}
"""
SAMPLE, PARTS = 0.2, 20
DEGREE = math.pi / 180.0
VEHICLE = VehicleParameters()
LENGTHS = length_values(VEHICLE)


class Angles(Alone):
    """What finds the errors, by itself."""

    def __init__(self, *, sways: bool = False) -> None:
        """sways: the antennas stand on masts whose roll is not measured."""
        self._sways = float(sways)
        super().__init__(Unit(name="angle_errors", source=UNIT, configure=lambda workspace: None))

    def take(
        self,
        points: Floats,
        yaw: float,
        angles: tuple[float, float],
        bent: float,
        *,
        swung: float = 0.0,
        creep: float = 0.0,
    ) -> None:
        """Take in positions (4,) of both bodies, m, yaw, angles, and the expected changes of hitch and joint, rad."""
        self.live.array("points")[:] = points
        self.call("taken", *map(Real, (yaw, *angles, bent, swung, creep, self._sways, VEHICLE.trailer_antenna, SAMPLE)))

    @property
    def found(self) -> Floats:
        """Unexplained distance, m; constant error, rad; scale errors of hitch and joint; latency, s."""
        return self.live.array("errors.state").copy()

    @property
    def deviations(self) -> Floats:
        """Of the same."""
        deviations: Floats = np.sqrt(np.diag(self.live.array("errors.covariance")))
        return deviations

    @property
    def latency(self) -> float:
        """Corrected for, s."""
        return float(self.live.array("errors.latency").item())

    @property
    def scales(self) -> Floats:
        """Of hitch and joint: true per measured angle, less 1, as corrected for."""
        return self.live.array("errors.scales").copy()


@dataclass(frozen=True)
class Drive:
    """A drive of tractor and trailer, at parts of a sample each: what is true."""

    points: Floats
    """(n, 4): x, y of the rear axle and of the trailer's point, m"""
    yaw: Floats
    """(n,) rad"""
    hitch: Floats
    """(n,) rad"""
    joint: Floats
    """(n,) rad"""

    def hitch_at(self, k: int, age: float) -> float:
        """Return the hitch angle at a sample, so long ago (s), rad."""
        return float(np.interp((k - age / SAMPLE) * PARTS, np.arange(self.hitch.size), self.hitch))


def drive(samples: int, speed: float = 2.0, creep: float = 0.0, curve: float = 0.25, weave: float = 0.1) -> Drive:
    """Return a drive along an eight on which the tractor and the joint weave.

    Args:
        samples: their number.
        speed: m/s.
        creep: side-slip by lateral acceleration, rad/g.
        curve: yaw rate on the circles, rad/s.
        weave: yaw rate on top, rad/s; the joint's angle, rad.
    """
    x = y = yaw = psi = turn = 0.0
    points, yaws, hitches, joints = [], [], [], []
    step = SAMPLE / PARTS
    for k in range(samples * PARTS):
        time = k * step
        lap = (time + 30.0) % 40.0
        rate = weave * math.sin(0.9 * time) + (curve if lap < 15.0 else -curve if 20.0 <= lap < 35.0 else 0.0)
        joint, joint_rate = weave * math.sin(0.5 * time), 0.5 * weave * math.cos(0.5 * time)
        crab, trailer_crab = -creep * speed * rate / 9.81, -creep * speed * turn / 9.81
        points.append([x, y, *map(float, trailer_antenna(LENGTHS, x, y, yaw, psi, joint))])
        yaws.append(yaw)
        hitches.append(yaw - psi - joint)
        joints.append(joint)
        turn = float(trailer_yaw_rate(LENGTHS, speed, rate, yaw - psi, joint, joint_rate, crab, trailer_crab))
        x += step * speed * math.cos(yaw + 0.5 * step * rate + crab) / math.cos(crab)
        y += step * speed * math.sin(yaw + 0.5 * step * rate + crab) / math.cos(crab)
        yaw, psi = yaw + step * rate, psi + step * turn
    return Drive(np.array(points), np.array(yaws), np.array(hitches), np.array(joints))


def follow(
    angles: Angles,
    driven: Drive,
    latency: float,
    *,
    offset: float = 0.0,
    scale: float = 1.0,
    joint_scale: float = 1.0,
    fix_latency: float = 0.0,
    creep: float = 0.0,
    every: int = 1,
    seen: Callable[[int, Floats, float], tuple[Floats, float]] = lambda k, points, angle: (points, angle),
    seed: int = 3,
) -> list[float]:
    """Drive with angles that are corrected by what is found; return the latency that is, at each sample, s.

    Args:
        angles: finds the errors.
        driven: the true drive.
        latency: of the hitch angle, s.
        offset: constant error of the hitch angle, rad.
        scale: measured hitch angle per true one.
        joint_scale: the same of the joint's.
        fix_latency: of the fixes, s.
        creep: that is known, rad/g.
        every: a new fix comes with each so manieth sample; the last one is repeated in between.
        seen: from index, positions and hitch angle to those that are measured.
        seed: of the noise.
    """
    rng, reckoned, shown = np.random.default_rng(seed), [], np.zeros(4)
    for k in range(2, len(driven.yaw) // PARTS):
        now, before = driven.hitch_at(k, 0.0), driven.hitch_at(k, SAMPLE)
        noisy = driven.points[round((k - fix_latency / SAMPLE) * PARTS)] + rng.normal(0.0, 0.02, 4)
        shown = noisy if k % every == 0 else shown
        angle = scale * driven.hitch_at(k, latency) + offset + rng.normal(0.0, 0.5 * DEGREE)
        points, angle = seen(k, shown, angle)
        hitch = angle * (1.0 + angles.scales[0]) + angles.latency / SAMPLE * (now - before)
        joint = joint_scale * driven.joint[k * PARTS] * (1.0 + angles.scales[1])
        yaw = wrap(driven.yaw[k * PARTS] + rng.normal(0.0, 0.5 * DEGREE))
        angles.take(points, yaw, (hitch, joint), now - before, creep=creep)
        reckoned.append(angles.latency)
    return reckoned
