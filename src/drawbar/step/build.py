"""Building an autopilot from its configuration: the only place that depends on all components."""

import math

from drawbar.codegen import Unit
from drawbar.config import Configuration, demand_configuration
from drawbar.control.ancillary import ancillary_unit
from drawbar.control.articulated import articulated_tractor_unit, articulated_trailer_unit
from drawbar.control.centralised_articulated import centralised_articulated_unit
from drawbar.control.centralised_tricycle import centralised_tricycle_unit
from drawbar.control.external import ExternalUnit, external_unit
from drawbar.control.lqr import lqr_unit
from drawbar.control.pure_pursuit import pure_pursuit_unit
from drawbar.control.settings import (
    ArticulatedControllerSettings,
    ExternalControllerSettings,
    LqrSettings,
    Nominal,
    PurePursuitSettings,
    TricycleControllerSettings,
)
from drawbar.control.tricycle import tricycle_tractor_unit, tricycle_trailer_unit
from drawbar.control.tube.bodies import OperatingConditions
from drawbar.control.tube.kept_rate import with_kept_rates
from drawbar.control.tube.tube import Tubes, tubes_of
from drawbar.estimation.actuation import actuation_unit
from drawbar.estimation.alignment import alignment_unit
from drawbar.estimation.articulated import ArticulatedEstimation
from drawbar.estimation.dead_time import dead_time_unit, found_dead_time_unit
from drawbar.estimation.description import EstimationModel
from drawbar.estimation.extended_kalman import extended_kalman_unit
from drawbar.estimation.ideal import IDEAL_UNIT
from drawbar.estimation.moving_horizon import moving_horizon_unit
from drawbar.estimation.settings import (
    ArticulatedEstimatorSettings,
    IdealEstimatorSettings,
    TricycleEstimatorSettings,
)
from drawbar.estimation.tricycle import TricycleEstimation
from drawbar.guidance.guidance import look_ahead_unit, preview_unit
from drawbar.optimal.transcription import ESTIMATION_ITERATIONS, STANDARD_HORIZON, control_iterations
from drawbar.safety.gate import PATIENCE, gate_unit
from drawbar.safety.run_monitor import run_monitor_unit
from drawbar.safety.sanity import sanity_unit
from drawbar.step.autopilot import Autopilot
from drawbar.step.library import StepLibrary, StepSettings
from drawbar.vehicle.articulated import articulated
from drawbar.vehicle.tricycle import tricycle

ENDURANCE = 3.0
"""For how long the vehicle may be driven on predictions alone, s; a plan that reaches less far shortens it"""

ITERATIONS, STANDARD_SAMPLE_TIME = 16, 0.2
"""Of interior points in a step, for a horizon up to the standard one and a sample time up to this, s"""
SHIFT = 0.1
"""Part of vehicle.curvature_limit and guidance.curvature_rate_limit that a shift to another line takes"""


def build_autopilot(configuration: Configuration) -> Autopilot:
    """Return a configuration's autopilot.

    Raises:
        TubeError: the declared disturbances leave nothing of a bound.
        ConfigurationError: there is no such controller, or this is no configuration.
        CompilerError: the control step could not be compiled.
    """
    demand_configuration(configuration)
    horizon, units = configuration.controller.horizon, units_of(configuration)
    external = next((unit.external for unit in units if isinstance(unit, ExternalUnit)), None)
    return Autopilot(StepLibrary(units, step_settings(configuration), horizon), horizon, external)


def step_settings(configuration: Configuration) -> StepSettings:
    """Return the step's own settings."""
    preview = configuration.guidance.mode == "preview"
    return StepSettings(
        sample_time=configuration.sample_time,
        speed=configuration.speed,
        planned_speed=configuration.speed if preview else -math.inf,  # the paper's plans take the estimated speed
        acceleration=configuration.acceleration,
        patience=PATIENCE,
        endurance=min(ENDURANCE, configuration.controller.horizon * configuration.sample_time),
        curvature=configuration.vehicle.curvature_limit,
        shift_curvature=SHIFT * configuration.vehicle.curvature_limit,
        shift_rate=SHIFT * configuration.guidance.curvature_rate_limit,
        iterations=float(_iterations(configuration)),
    )


def _iterations(configuration: Configuration) -> int:
    """Return how many iterations all interior points of a step may take together.

    Where nominal states are optimised, their bounds need them in each step. Plans that reach further ahead, in samples
    or in time, have more active bounds.
    """
    horizon = configuration.controller.horizon
    if configuration.tube.nominal is Nominal.OPTIMISED:
        return ESTIMATION_ITERATIONS + 2 * control_iterations(horizon)
    standard = horizon <= STANDARD_HORIZON and configuration.sample_time <= STANDARD_SAMPLE_TIME
    return ITERATIONS if standard else control_iterations(horizon)


def units_of(configuration: Configuration) -> list[Unit]:
    """Return the components' units, in the order of struct autopilot (components.h)."""
    vehicle, tubes = configuration.vehicle, build_tubes(configuration)
    predictor, identified = _predictor(configuration), configuration.actuation.identify
    return [
        alignment_unit(
            vehicle,
            configuration.sensors,
            identifies=not isinstance(configuration.estimator, IdealEstimatorSettings),
        ),
        _estimator(configuration),
        _guidance(configuration),
        *([_actuation(configuration)] if identified else []),
        *([predictor] if predictor else []),
        *_controllers(configuration, tubes),
        ancillary_unit("tractor_law", tubes.tractor if tubes else None, vehicle.tractor_steering_limit),
        ancillary_unit("trailer_law", tubes.trailer if tubes else None, vehicle.trailer_steering_limit),
        gate_unit(vehicle, speed_limit=configuration.speed, sample_time=configuration.sample_time),
        run_monitor_unit(configuration.sanity, vehicle),
        sanity_unit(
            vehicle,
            configuration.sanity,
            position=configuration.sensors.position,
            chain=configuration.estimator.model != "tricycle",
        ),
    ]


def build_tubes(configuration: Configuration) -> Tubes | None:
    """Return the tubes of both bodies, None for a controller that has no nominal state to be held to."""
    settings = configuration.controller
    if not isinstance(settings, ArticulatedControllerSettings | TricycleControllerSettings):
        return None
    return tubes_of(
        configuration.vehicle,
        settings,
        with_kept_rates(settings, operating_conditions(configuration), configuration.tube),
        speed=configuration.speed,
        sample_time=configuration.sample_time,
    )


def operating_conditions(configuration: Configuration) -> OperatingConditions:
    """Return where the errors of both bodies are linearised."""
    return OperatingConditions(
        vehicle=configuration.vehicle,
        ranges=configuration.tube.operating_range,
        speed=configuration.speed,
        sample_time=configuration.sample_time,
    )


def _estimator(configuration: Configuration) -> Unit:
    settings = configuration.estimator
    if isinstance(settings, IdealEstimatorSettings):
        return IDEAL_UNIT
    model = _estimation_model(configuration, settings)
    return extended_kalman_unit(model) if settings.method == "extended_kalman" else moving_horizon_unit(model)


def _estimation_model(
    configuration: Configuration, settings: ArticulatedEstimatorSettings | TricycleEstimatorSettings
) -> EstimationModel:
    vehicle, noise, sample_time = configuration.vehicle, configuration.sensors, configuration.sample_time
    if isinstance(settings, TricycleEstimatorSettings):
        return TricycleEstimation(vehicle, noise, settings, sample_time)
    return ArticulatedEstimation(vehicle, noise, settings, sample_time)


def _controllers(configuration: Configuration, tubes: Tubes | None) -> list[Unit]:
    vehicle, settings, sample_time = configuration.vehicle, configuration.controller, configuration.sample_time
    if isinstance(settings, PurePursuitSettings):
        return [pure_pursuit_unit(vehicle, settings, sample_time)]
    if isinstance(settings, ExternalControllerSettings):
        return [external_unit(vehicle, settings, sample_time)]
    if isinstance(settings, LqrSettings):
        return [lqr_unit(vehicle, settings, sample_time, configuration.speed)]
    assert tubes is not None
    if isinstance(settings, TricycleControllerSettings):
        if settings.structure == "centralised":
            return [centralised_tricycle_unit(vehicle, settings, sample_time, tubes)]
        return [
            tricycle_tractor_unit(vehicle, settings, sample_time, tubes.tractor),
            tricycle_trailer_unit(vehicle, settings, sample_time, tubes.trailer),
        ]
    if settings.structure == "centralised":
        return [centralised_articulated_unit(vehicle, settings, sample_time, tubes)]
    return [
        articulated_tractor_unit(vehicle, settings, sample_time, tubes.tractor),
        articulated_trailer_unit(vehicle, settings, sample_time, tubes.trailer),
    ]


def _actuation(configuration: Configuration) -> Unit:
    return actuation_unit(configuration.vehicle, configuration.actuation, configuration.sample_time)


def _predictor(configuration: Configuration) -> Unit | None:
    estimator = configuration.estimator
    model = tricycle if isinstance(estimator, TricycleEstimatorSettings) else articulated
    vehicle, settings, sample_time = configuration.vehicle, configuration.actuation, configuration.sample_time
    if not settings.identify:
        return dead_time_unit(vehicle, model(vehicle), sample_time)
    return found_dead_time_unit(
        vehicle,
        model(vehicle),
        sample_time,
        body_lag_per_speed=settings.body_lag_per_speed,
        steering_leap=math.inf if isinstance(estimator, IdealEstimatorSettings) else estimator.screening.steering,
    )


def _guidance(configuration: Configuration) -> Unit:
    settings, stages, interval = configuration.guidance, configuration.controller.horizon, configuration.sample_time
    if settings.mode == "look_ahead":
        return look_ahead_unit(settings, stages=stages, interval=interval, speed=configuration.speed)
    return preview_unit(settings, configuration.vehicle, stages=stages, interval=interval)
