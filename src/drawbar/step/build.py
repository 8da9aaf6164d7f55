"""Put the parts together from a configuration: the only place that knows all of them."""

import math
from collections.abc import Callable
from pathlib import Path as FilePath

import numpy as np

from drawbar.bounded import BoundedSequence, Draw
from drawbar.config import Configuration
from drawbar.control.ancillary import AncillaryLaw
from drawbar.control.articulated import ArticulatedTractor, ArticulatedTrailer
from drawbar.control.centralised_articulated import CentralisedArticulated
from drawbar.control.centralised_tricycle import CentralisedTricycle
from drawbar.control.decentralised import DecentralisedController
from drawbar.control.lqr import LinearQuadraticRegulator
from drawbar.control.nominal import NominalController
from drawbar.control.pure_pursuit import PurePursuit
from drawbar.control.settings import (
    ArticulatedControllerSettings,
    LqrSettings,
    PurePursuitSettings,
    TricycleControllerSettings,
)
from drawbar.control.tricycle import TricycleTractor, TricycleTrailer
from drawbar.control.tube.adversary import worst_signs
from drawbar.control.tube.tube import Tubes, tubes_of
from drawbar.errors import ConfigurationError, PathError
from drawbar.estimation.articulated import ArticulatedEstimation
from drawbar.estimation.dead_time import DeadTimePredictor
from drawbar.estimation.description import EstimationModel
from drawbar.estimation.estimator import Estimator
from drawbar.estimation.extended_kalman import ExtendedKalmanFilter
from drawbar.estimation.ideal import IdealEstimator
from drawbar.estimation.moving_horizon import MovingHorizonEstimator
from drawbar.estimation.settings import (
    ArticulatedEstimatorSettings,
    IdealEstimatorSettings,
    TricycleEstimatorSettings,
)
from drawbar.estimation.tricycle import TricycleEstimation
from drawbar.geometry import Floats
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.guidance import Guidance
from drawbar.guidance.importers.load import load_line
from drawbar.guidance.look_ahead import LookAhead
from drawbar.guidance.path import Path
from drawbar.guidance.preview import Preview
from drawbar.guidance.smoothing import DrivablePath, make_drivable
from drawbar.machine.base import Machine
from drawbar.machine.simulated import SimulatedMachine
from drawbar.safety.gate import CommandGate
from drawbar.signals import Measurement, Pose
from drawbar.step.autopilot import Autopilot
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.tricycle import tricycle


def build_path(configuration: Configuration) -> tuple[Path, DrivablePath | None]:
    """Return the path to drive and, for a recorded line, how it was made drivable.

    Raises:
        PathError: the line cannot be read or driven.
    """
    settings, limit = configuration.path, configuration.vehicle.curvature_limit
    if not settings.file:
        for radius in settings.radii:
            if not 1.0 / radius <= limit:
                raise PathError(
                    f"path.radii holds {radius} m; the vehicle turns no tighter than {1.0 / limit:.2f} m, "
                    f"by vehicle.curvature_limit = {limit} 1/m"
                )
        return figure_eights(settings.radii, settings.straight_length), None
    line = load_line(FilePath(settings.file), settings.track or None)
    drivable = make_drivable(
        line,
        curvature_limit=limit,
        curvature_rate_limit=configuration.guidance.curvature_rate_limit,
        tolerance=configuration.guidance.path_tolerance,
    )
    return drivable.path, drivable


def build_machine(configuration: Configuration, path: Path, seed: int) -> SimulatedMachine:
    """Return the simulated machine, standing where the configuration's start says."""
    x, y, yaw, _ = path.sample(np.zeros(1))[0].tolist()
    start = configuration.start
    return SimulatedMachine(
        vehicle=configuration.vehicle,
        settings=configuration.machine,
        sample_time=configuration.sample_time,
        start=Pose(
            x=x + start.ahead * math.cos(yaw) - start.left * math.sin(yaw),
            y=y + start.ahead * math.sin(yaw) + start.left * math.cos(yaw),
            yaw=yaw + start.yaw,
        ),
        seed=seed,
        unknown=_bounded_errors(configuration, "ground", seed),
    )


def build_autopilot(configuration: Configuration, path: Path, machine: Machine, seed: int = 0) -> Autopilot:
    """Return the control step for this machine; it starts from the machine's first measurement.

    The seed is that of an ideal estimate's errors, where the configuration asks for any.

    Raises:
        HardwareError: the first measurement lacks a position.
        PathError: the vehicle stands too far from the start of the path.
        CompilerError: a solver could not be compiled.
    """
    vehicle, tubes = configuration.vehicle, build_tubes(configuration)
    first = machine.read()
    estimator = _estimator(configuration, machine, first, seed)
    return Autopilot(
        machine=machine,
        estimator=estimator,
        predictor=_predictor(configuration),
        guidance=_guidance(configuration, path, first),
        controller=_controller(configuration, tubes),
        tractor_law=AncillaryLaw(tubes.tractor if tubes else None, vehicle.tractor_steering_limit),
        trailer_law=AncillaryLaw(tubes.trailer if tubes else None, vehicle.trailer_steering_limit),
        gate=CommandGate(vehicle, first, speed_limit=configuration.speed, sample_time=configuration.sample_time),
        speed=configuration.speed,
        planned_speed=planned_speed(configuration),
    )


def planned_speed(configuration: Configuration) -> float:
    """Return the least speed that plans reckon with, m/s: the set speed along a preview, else (the paper's) none."""
    return configuration.speed if configuration.guidance.mode == "preview" else -math.inf


def _estimator(configuration: Configuration, machine: Machine, first: Measurement, seed: int) -> Estimator:
    settings = configuration.estimator
    if isinstance(settings, IdealEstimatorSettings):
        return IdealEstimator(machine.truth, _bounded_errors(configuration, "estimate", seed))
    kind = ExtendedKalmanFilter if settings.method == "extended_kalman" else MovingHorizonEstimator
    return kind(_estimation_model(configuration, settings), first)


def _estimation_model(
    configuration: Configuration, settings: ArticulatedEstimatorSettings | TricycleEstimatorSettings
) -> EstimationModel:
    vehicle, noise, sample_time = configuration.vehicle, configuration.sensors, configuration.sample_time
    if isinstance(settings, TricycleEstimatorSettings):
        return TricycleEstimation(vehicle, noise, settings, sample_time)
    return ArticulatedEstimation(vehicle, noise, settings, sample_time)


def _controller(configuration: Configuration, tubes: Tubes | None) -> NominalController:
    vehicle, settings, sample_time = (
        configuration.vehicle,
        configuration.controller,
        configuration.sample_time,
    )
    if isinstance(settings, PurePursuitSettings):
        return PurePursuit(vehicle, settings, sample_time)
    if isinstance(settings, LqrSettings):
        return LinearQuadraticRegulator(vehicle, settings, sample_time, configuration.speed)
    assert tubes is not None
    if settings.structure == "centralised":
        return _centralised(configuration, settings, tubes)
    if isinstance(settings, TricycleControllerSettings):
        return DecentralisedController(
            TricycleTractor(vehicle, settings, sample_time, tubes.tractor),
            TricycleTrailer(vehicle, settings, sample_time, tubes.trailer),
        )
    return DecentralisedController(
        ArticulatedTractor(vehicle, settings, sample_time, tubes.tractor),
        ArticulatedTrailer(vehicle, settings, sample_time, tubes.trailer),
    )


def _centralised(
    configuration: Configuration, settings: ArticulatedControllerSettings | TricycleControllerSettings, tubes: Tubes
) -> NominalController:
    if isinstance(settings, TricycleControllerSettings):
        return CentralisedTricycle(configuration.vehicle, settings, configuration.sample_time, tubes)
    return CentralisedArticulated(configuration.vehicle, settings, configuration.sample_time, tubes)


def build_tubes(configuration: Configuration) -> Tubes | None:
    """Return the tubes of both bodies, None for a controller that has no nominal state to be held to."""
    settings = configuration.controller
    if not isinstance(settings, ArticulatedControllerSettings | TricycleControllerSettings):
        return None
    return tubes_of(
        configuration.vehicle,
        settings,
        configuration.tube,
        speed=configuration.speed,
        sample_time=configuration.sample_time,
    )


def _bounded_errors(configuration: Configuration, kind: str, seed: int) -> Callable[[], Floats] | None:
    """Return what draws the errors of the ground or of the estimate, None where all their bounds are zero."""
    errors = configuration.bounded_errors
    bounds = errors.scale * np.array([bound for _, bound in getattr(errors, kind)])
    if not bounds.any():
        return None
    worst = np.ones((1, len(bounds)))
    if errors.draw is Draw.ADVERSARIAL:
        tubes = build_tubes(configuration)
        if tubes is None:
            raise ConfigurationError(
                f'bounded_errors.draw = "adversarial" needs tubes to attack, which controller.model = '
                f'"{configuration.controller.model}" does not have; use "random" or "vertices"'
            )
        worst = dict(zip(("ground", "estimate"), worst_signs(tubes), strict=True))[kind]
    return BoundedSequence(errors.draw, bounds, seed=seed, worst=worst).draw


def _predictor(configuration: Configuration) -> DeadTimePredictor:
    tricycles = isinstance(configuration.estimator, TricycleEstimatorSettings)
    model = tricycle if tricycles else articulated
    return DeadTimePredictor(configuration.vehicle, model(configuration.vehicle), configuration.sample_time)


def _guidance(configuration: Configuration, path: Path, first: Measurement) -> Guidance:
    settings, interval = configuration.guidance, configuration.sample_time
    stages = configuration.controller.horizon
    tractor, trailer = (first.tractor_x, first.tractor_y), (first.trailer_x, first.trailer_y)
    if settings.mode == "look_ahead":
        return LookAhead(
            path,
            settings,
            stages=stages,
            interval=interval,
            speed=configuration.speed,
            tractor=tractor,
            trailer=trailer,
        )
    return Preview(
        path,
        settings,
        vehicle=configuration.vehicle,
        stages=stages,
        interval=interval,
        tractor=tractor,
        trailer=trailer,
    )
