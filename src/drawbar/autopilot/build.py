"""Put the parts together from a configuration: the only place that knows all of them."""

import math
from pathlib import Path as FilePath

import numpy as np

from drawbar.autopilot.autopilot import Autopilot
from drawbar.autopilot.gate import CommandGate
from drawbar.config import Configuration
from drawbar.control.ancillary import AncillaryLaw
from drawbar.control.articulated import ArticulatedTractor, ArticulatedTrailer
from drawbar.control.decentralised import DecentralisedController
from drawbar.control.nominal import NominalController
from drawbar.control.settings import ArticulatedControllerSettings, TricycleControllerSettings
from drawbar.control.tricycle import TricycleTractor, TricycleTrailer
from drawbar.errors import PathError
from drawbar.estimation.articulated import ArticulatedEstimation
from drawbar.estimation.description import EstimationModel
from drawbar.estimation.estimator import Estimator
from drawbar.estimation.moving_horizon import MovingHorizonEstimator
from drawbar.estimation.settings import ArticulatedEstimatorSettings, TricycleEstimatorSettings
from drawbar.estimation.tricycle import TricycleEstimation
from drawbar.guidance.figure_eight import figure_eights
from drawbar.guidance.guidance import Guidance
from drawbar.guidance.importers.load import load_line
from drawbar.guidance.look_ahead import LookAhead
from drawbar.guidance.path import Path
from drawbar.guidance.preview import Preview
from drawbar.guidance.smoothing import DrivablePath, make_drivable
from drawbar.machine.base import Machine
from drawbar.machine.simulated import SimulatedMachine
from drawbar.signals import Measurement, Pose


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
    )


def build_autopilot(configuration: Configuration, path: Path, machine: Machine) -> Autopilot:
    """Return the control step for this machine; it starts from the machine's first measurement.

    Raises:
        HardwareError: the first measurement lacks a position.
        PathError: the vehicle stands too far from the start of the path.
        CompilerError: a solver could not be compiled.
    """
    vehicle, tube = configuration.vehicle, configuration.tube
    first = machine.read()
    estimator = _estimator(configuration, machine, first)
    return Autopilot(
        machine=machine,
        estimator=estimator,
        guidance=_guidance(configuration, path, first),
        controller=_controller(configuration),
        tractor_law=AncillaryLaw(tube.tractor, vehicle.tractor_steering_limit),
        trailer_law=AncillaryLaw(tube.trailer, vehicle.trailer_steering_limit),
        gate=CommandGate(
            tractor_limit=vehicle.tractor_steering_limit,
            trailer_limit=vehicle.trailer_steering_limit,
            speed_limit=configuration.speed,
        ),
        speed=configuration.speed,
    )


def _estimator(configuration: Configuration, machine: Machine, first: Measurement) -> Estimator:
    return MovingHorizonEstimator(_estimation_model(configuration), first)


def _estimation_model(configuration: Configuration) -> EstimationModel:
    vehicle, noise, sample_time = configuration.vehicle, configuration.sensors, configuration.sample_time
    settings = configuration.estimator
    if isinstance(settings, TricycleEstimatorSettings):
        return TricycleEstimation(vehicle, noise, settings, sample_time)
    assert isinstance(settings, ArticulatedEstimatorSettings)
    return ArticulatedEstimation(vehicle, noise, settings, sample_time)


def _controller(configuration: Configuration) -> NominalController:
    vehicle, settings, sample_time = (
        configuration.vehicle,
        configuration.controller,
        configuration.sample_time,
    )
    if isinstance(settings, TricycleControllerSettings):
        return DecentralisedController(
            TricycleTractor(vehicle, settings, sample_time), TricycleTrailer(vehicle, settings, sample_time)
        )
    assert isinstance(settings, ArticulatedControllerSettings)
    return DecentralisedController(
        ArticulatedTractor(vehicle, settings, sample_time), ArticulatedTrailer(vehicle, settings, sample_time)
    )


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
    return Preview(path, settings, stages=stages, interval=interval, tractor=tractor, trailer=trailer)
