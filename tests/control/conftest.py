"""Both pairs of controllers, and situations to put them in: any pose, path and slip, turned, shifted or mirrored."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from controllers import (
    ArticulatedTractor,
    ArticulatedTrailer,
    DecentralisedController,
    TricycleTractor,
    TricycleTrailer,
)

from drawbar.codegen import Workspace, build
from drawbar.control.settings import (
    ArticulatedControllerSettings,
    Coupling,
    SharingSettings,
    TricycleControllerSettings,
    TubeSettings,
)
from drawbar.control.tube.tube import Tubes, tubes_of
from drawbar.geometry import Floats
from drawbar.signals import BodyReference, Estimate, Pose, Reference, SolverStatus
from drawbar.vehicle.parameters import VehicleParameters

SAMPLE_TIME = 0.2
HORIZON = 20
VEHICLE = VehicleParameters()
NOMINAL_STATES = """
#include "nominal_state.h"
#include "fields.h"
struct states { double given[4], other[4], result[4]; int32_t count; };
int64_t drawbar_size = sizeof(struct states);
const struct drawbar_field drawbar_fields[] = {
    FIELD(states, given, 0, 4, 0, 0) FIELD(states, other, 0, 4, 0, 0) FIELD(states, result, 0, 4, 0, 0)
    FIELD(states, count, 1, 1, 0, 0) END_OF_FIELDS
};
int beside(struct states *s)
{
    for (int i = 0; i < 4; ++i)
        s->result[i] = s->given[i];
    move_beside(s->result, s->other);
    return 0;
}
int of_pose(struct states *s) { pose_deviation(s->given, s->other, s->count, s->result); return 0; }
int of_angles(struct states *s) { plain_deviation(s->given, s->other, s->count, s->result); return 0; }
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class NominalStates:
    """The arithmetic of nominal_state.h."""

    workspace: Workspace

    def beside(self, state: Floats, closest: Floats) -> Floats:
        """Return a state (n,) moved along the path to the estimate's closest point (4,)."""
        return self._call("beside", state, closest)[: len(state)]

    def pose_deviation(self, estimated: Floats, nominal: Floats) -> Floats:
        """Return the deviation (n - 1,) of two states (n,) that begin with a pose."""
        return self._call("of_pose", estimated, nominal)[: len(estimated) - 1]

    def plain_deviation(self, estimated: Floats, nominal: Floats) -> Floats:
        """Return the deviation (n,) of two states (n,) that are angles."""
        return self._call("of_angles", estimated, nominal)[: len(estimated)]

    def _call(self, function: str, given: Floats, other: Floats) -> Floats:
        array = self.workspace.array
        array("given")[: len(given)], array("other")[: len(other)], array("count")[:] = given, other, len(given)
        self.workspace.function(function)()
        result: Floats = array("result").copy()
        return result


@pytest.fixture(scope="session")
def nominal_states() -> NominalStates:
    return NominalStates(workspace=Workspace(build("nominal_states", NOMINAL_STATES)))


@pytest.fixture(scope="session")
def untightened() -> Callable[..., Tubes]:
    """Return a function that makes the tubes of a controller's settings when no bounds are declared."""

    def untightened(
        settings: ArticulatedControllerSettings | TricycleControllerSettings, vehicle: VehicleParameters = VEHICLE
    ) -> Tubes:
        return tubes_of(vehicle, settings, TubeSettings(), speed=1.0, sample_time=SAMPLE_TIME)

    return untightened


@pytest.fixture(scope="session", params=["articulated", "tricycle"])
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="session")
def make(untightened: Callable[..., Tubes]) -> Callable[..., DecentralisedController]:
    """Return a function that makes a new pair of controllers of a model."""

    def make(name: str, coupling: str = "measured") -> DecentralisedController:
        if name == "tricycle":
            paper = TricycleControllerSettings(model="tricycle", horizon=HORIZON, coupling=Coupling(coupling))
            tubes = untightened(paper)
            return DecentralisedController(
                TricycleTractor(VEHICLE, paper, SAMPLE_TIME, tubes.tractor),
                TricycleTrailer(VEHICLE, paper, SAMPLE_TIME, tubes.trailer),
            )
        settings = ArticulatedControllerSettings(
            model="articulated",
            horizon=HORIZON,
            coupling=Coupling(coupling),
            sharing=SharingSettings(share=0.0, widening=0.0),
        )
        tubes = untightened(settings)
        return DecentralisedController(
            ArticulatedTractor(VEHICLE, settings, SAMPLE_TIME, tubes.tractor),
            ArticulatedTrailer(VEHICLE, settings, SAMPLE_TIME, tubes.trailer),
        )

    return make


@dataclass(frozen=True, slots=True, kw_only=True)
class Situation:
    estimate: Estimate
    reference: Reference

    def nowhere(self) -> "Situation":
        """Return the same estimate with references that no solver takes."""

        def body(old: BodyReference) -> BodyReference:
            return replace(old, samples=np.full_like(old.samples, math.nan))

        r = self.reference
        return replace(self, reference=replace(r, tractor=body(r.tractor), trailer=body(r.trailer)))

    def _moved(self, position: Callable[[Floats], Floats], sign: float, turn: float) -> "Situation":
        def pose(old: Pose) -> Pose:
            x, y = position(np.array([old.x, old.y])).tolist()
            return Pose(x=x, y=y, yaw=sign * old.yaw + turn)

        def body(old: BodyReference) -> BodyReference:
            samples = old.samples.copy()
            samples[:, :2] = position(samples[:, :2])
            samples[:, 2] = sign * samples[:, 2] + turn
            samples[:, 3] *= sign
            return replace(old, closest=samples[0], samples=samples, lateral_error=sign * old.lateral_error)

        e, r = self.estimate, self.reference
        angles = (
            "hitch_angle",
            "tractor_steering",
            "trailer_steering",
            "steering_offset",
            "tractor_crab",
            "trailer_crab",
        )
        estimate = replace(
            e, tractor=pose(e.tractor), trailer=pose(e.trailer), **{a: sign * getattr(e, a) for a in angles}
        )
        return Situation(estimate=estimate, reference=replace(r, tractor=body(r.tractor), trailer=body(r.trailer)))

    def turned(self, angle: float, shift: tuple[float, float]) -> "Situation":
        c, s = math.cos(angle), math.sin(angle)
        return self._moved(lambda p: p @ np.array([[c, s], [-s, c]]) + shift, 1.0, angle)

    def mirrored(self) -> "Situation":
        return self._moved(lambda p: p * np.array([1.0, -1.0]), -1.0, 0.0)


def arc(curvature: float, arc_length: Floats) -> Floats:
    """Return samples (n, 4) of a circle (or straight) that leaves the origin eastwards."""
    half = 0.5 * curvature * arc_length
    chord = arc_length * np.sinc(half / math.pi)
    return np.stack(
        [chord * np.cos(half), chord * np.sin(half), 2.0 * half, np.full_like(arc_length, curvature)], axis=1
    )


def chain_trailer(tractor: Pose, hitch: float, joint: float) -> Pose:
    """Return the trailer antenna's pose behind a tractor at given joint angles."""
    phi = tractor.yaw - hitch
    psi = phi - joint
    lengths = (VEHICLE.free_joint_offset, VEHICLE.drawbar_length, VEHICLE.trailer_length - VEHICLE.trailer_antenna)
    x = tractor.x - sum(r * math.cos(a) for r, a in zip(lengths, (tractor.yaw, phi, psi), strict=True))
    y = tractor.y - sum(r * math.sin(a) for r, a in zip(lengths, (tractor.yaw, phi, psi), strict=True))
    return Pose(x=x, y=y, yaw=psi)


@pytest.fixture(scope="session")
def situation() -> Callable[..., Situation]:
    """Return a function that places the vehicle near a circle (or straight) through the origin.

    `ahead` (m) of the origin along the path, everything else as the keywords say; no slip and 1 m/s by default.
    """

    def situation(
        *,
        curvature: float = 0.0,
        ahead: float = 0.0,
        left: float = 0.0,
        yaw: float = 0.0,
        hitch: float = 0.0,
        **values: float,
    ) -> Situation:
        x, y, heading, _ = arc(curvature, np.array([ahead]))[0].tolist()
        tractor = Pose(x=x - left * math.sin(heading), y=y + left * math.cos(heading), yaw=heading + yaw)
        slips = {"longitudinal_slip": 1.0, "tractor_slip": 1.0, "trailer_slip": 1.0}
        angles = dict.fromkeys(
            ("tractor_steering", "trailer_steering", "steering_offset", "tractor_crab", "trailer_crab"), 0.0
        )
        numbers = {"speed": 1.0} | slips | angles | values
        trailer = chain_trailer(tractor, hitch, numbers["trailer_steering"])
        pace = numbers["speed"] * numbers["longitudinal_slip"] * SAMPLE_TIME * np.arange(HORIZON + 1)
        behind = math.hypot(trailer.x - tractor.x, trailer.y - tractor.y)
        if curvature:
            behind = 2.0 / abs(curvature) * math.asin(0.5 * behind * abs(curvature))
        tractor_samples, trailer_samples = (arc(curvature, start + pace) for start in (ahead, ahead - behind))
        return Situation(
            estimate=Estimate(
                time=0.0, tractor=tractor, trailer=trailer, hitch_angle=hitch, status=SolverStatus.SOLVED, **numbers
            ),
            reference=Reference(
                time=0.0,
                tractor=BodyReference(
                    progress=ahead, lateral_error=left, closest=tractor_samples[0], samples=tractor_samples
                ),
                trailer=BodyReference(
                    progress=ahead - behind, lateral_error=left, closest=trailer_samples[0], samples=trailer_samples
                ),
            ),
        )

    return situation


@pytest.fixture(scope="session")
def random_situations(situation: Callable[..., Situation]) -> list[Situation]:
    """Return situations off the path in every respect, so little that no bound is in the way; seed 21."""
    rng = np.random.default_rng(21)

    def one() -> Situation:
        curvature = float(rng.uniform(-0.02, 0.02))
        return situation(
            curvature=curvature,
            left=float(rng.normal(0.0, 0.01)),
            yaw=float(rng.normal(0.0, 0.01)),
            hitch=float(rng.normal(1.8 * curvature, 0.01)),
            speed=float(rng.uniform(0.7, 1.3)),
            longitudinal_slip=float(rng.uniform(0.8, 1.0)),
            tractor_slip=float(rng.uniform(0.9, 1.0)),
            trailer_slip=float(rng.uniform(0.9, 1.0)),
            tractor_steering=float(rng.normal(1.4 * curvature, 0.01)),
            trailer_steering=float(rng.normal(0.0, 0.01)),
            steering_offset=float(rng.normal(0.0, 0.005)),
            tractor_crab=float(rng.normal(0.0, 0.005)),
            trailer_crab=float(rng.normal(0.0, 0.005)),
        )

    return [one() for _ in range(10)]
