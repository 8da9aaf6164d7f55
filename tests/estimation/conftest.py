"""Measurements that the estimators' own models make, with and without noise, and what moves the world under them."""

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from itertools import islice

import casadi as ca
import numpy as np
import pytest
from alone import Alone
from c_signals import given, room, taken
from estimators import MovingHorizonEstimator

from drawbar.codegen import Unit
from drawbar.codegen.emit import emit_indices
from drawbar.config import load_configuration
from drawbar.estimation.articulated import ArticulatedEstimation
from drawbar.estimation.description import EstimationModel
from drawbar.estimation.settings import (
    ArticulatedEstimatorSettings,
    ScreeningSettings,
    SlideSettings,
    SlipBounds,
    TricycleDrift,
    TricycleEstimatorSettings,
)
from drawbar.estimation.tricycle import TricycleEstimation
from drawbar.geometry import Floats
from drawbar.optimal.transcription import transcribe
from drawbar.settings import Settings
from drawbar.signals import Command, Estimate, Measurement
from drawbar.simulation import Simulation
from drawbar.vehicle.integrators import integrate
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.sensors import SensorNoise

SAMPLE_TIME = 0.2
OPEN = ScreeningSettings(
    lateral=1e9, longitudinal=1e9, shift=1e9, release=1e9, repetition=1e9, hitch=math.pi, single_growth=1.0
)
"""Lets every fix pass: what the estimators themselves do is tested without it."""
UNKNOWN_SLIDE = SlideSettings(prior=0.0)
"""Nothing is learned beside the estimators' states: they themselves are tested."""
DEVIATIONS = np.array([0.03, 0.03, 0.03, 0.03, 0.0175, 0.1, 0.0175, 0.0175])


UNIT = """
#define NX {states}
#define NY {outputs}
#define CONSTANTS {constants}
{indices}#include "{name}_estimation.h"
struct component {{ struct estimation_model model; double state[NX], y[NY]; }};
#define COMPONENT_FIELDS MODEL_FIELDS(component, model.) \\
    FIELD(component, state, 0, NX, 0, 0) FIELD(component, y, 0, NY, 0, 0)
int UNIT(first_guess)(struct component *component, const struct drawbar_measurement *first)
{{
    return model_first_guess(&component->model, first, component->state);
}}
int UNIT(outputs)(struct component *component, const struct drawbar_measurement *measurement)
{{
    model_outputs(&component->model, measurement, component->y);
    return 0;
}}
int UNIT(told)(struct component *component, const struct drawbar_command *command)
{{
    model_commanded_outputs(&component->model, component->state, command, component->y);
    return 0;
}}
int UNIT(estimate)(struct component *component, const struct drawbar_measurement *measurement,
                   struct drawbar_estimate *estimate)
{{
    model_estimate(&component->model, component->state, measurement, 0, estimate);
    return 0;
}}
"""


class CompiledModel(Alone):
    """What a model's header offers to the estimators, by itself."""

    def __init__(self, model: EstimationModel) -> None:
        constants = {f"model.{name}": value for name, value in model.constants.items()}
        names = transcribe(model.problem).names
        count = len(transcribe(model.problem).constants)
        sizes = {"states": len(names["X"]), "outputs": len(names["Y"]), "constants": count}
        source = UNIT.format(name=model.name, **sizes, indices=emit_indices(names))
        super().__init__(Unit(name="model", source=source, configure=lambda workspace: workspace.write(constants)))
        self._outputs = names["Y"]
        self.state = self.live.array("state")

    def first_guess(self, measurement: Measurement) -> Floats | None:
        """Return the state (nx,), which is kept; None where there is no guess."""
        return self.state.copy() if self.call("first_guess", given(measurement)) else None

    def outputs(self, measurement: Measurement) -> Floats:
        """Return the outputs (ny,)."""
        self.call("outputs", given(measurement))
        return self.live.array("y").copy()

    def steering_rates(self, command: Command) -> list[float]:
        """Return the rates that a command gives in the state that is kept."""
        self.call("told", given(command))
        values = dict(zip(self._outputs, self.live.array("y").tolist(), strict=True))
        return [values[name] for name in self._outputs if name.endswith("steering_rate")]

    def estimate(self, measurement: Measurement) -> Estimate:
        """Return the estimate of the state that is kept."""
        estimate = room(Estimate)
        self.call("estimate", given(measurement), estimate)
        return taken(Estimate, estimate)


@pytest.fixture(scope="session")
def compiled() -> type[CompiledModel]:
    return CompiledModel


def estimation(name: str, **tricycle: Settings) -> EstimationModel:
    if name == "tricycle":
        paper = TricycleEstimatorSettings.model_validate(
            {"model": name, "weighting": "statistical", "screening": OPEN} | tricycle
        )
        return TricycleEstimation(VehicleParameters(), SensorNoise(), paper, SAMPLE_TIME)
    # nothing is believed of crab angles, nor of steering rates, of which no command tells here
    settings = ArticulatedEstimatorSettings(
        model="articulated", screening=OPEN, crab=3.0, steering_rate=1.5, slide=UNKNOWN_SLIDE
    )
    return ArticulatedEstimation(VehicleParameters(), SensorNoise(), settings, SAMPLE_TIME)


@pytest.fixture(scope="session", params=["articulated", "tricycle"])
def model(request: pytest.FixtureRequest) -> EstimationModel:
    return estimation(request.param)


@pytest.fixture(scope="session", params=["articulated", "tricycle"])
def free_model(request: pytest.FixtureRequest) -> EstimationModel:
    """Return a model whose slips reach no bound: what a bound holds is only as exact as the interior point."""
    wide, slow = SlipBounds(lower=0.0, upper=3.0), TricycleDrift(slip=0.01)
    return estimation(request.param, slip_bounds=wide, drift=slow)


@pytest.fixture(scope="session")
def travel() -> Callable[..., tuple[Floats, Floats]]:
    """Return a function that integrates a model: states (n+1, nx) and outputs (n+1, ny) under inputs (n, nu)."""

    def travel(model: EstimationModel, start: Floats, p: Floats, inputs: Floats) -> tuple[Floats, Floats]:
        declared = model.problem.model.numeric()
        step = ca.Function("step", [declared.x, declared.u, declared.p], [integrate(declared, SAMPLE_TIME)])
        output = ca.Function("output", [declared.x, declared.u, declared.p], [declared.output])
        states = [start]
        for u in inputs:
            states.append(np.array(step(states[-1], u, p)).ravel())
        held = np.vstack([inputs, inputs[-1:]])
        return np.array(states), np.array(
            [np.array(output(x, u, p)).ravel() for x, u in zip(states, held, strict=True)]
        )

    return travel


def as_measurements(outputs: Floats) -> list[Measurement]:
    names = ("tractor_x", "tractor_y", "trailer_x", "trailer_y", "hitch_angle", "speed")
    names = (*names, "tractor_steering", "trailer_steering")
    return [
        Measurement(time=k * SAMPLE_TIME, **dict(zip(names, row[:8].tolist(), strict=True)))
        for k, row in enumerate(outputs)
    ]


@pytest.fixture(scope="session")
def measure() -> Callable[..., list[Measurement]]:
    """Return a function that turns outputs (n, ny) into measurements, with noise of the given seed or without."""

    def measure(outputs: Floats, seed: int | None = None) -> list[Measurement]:
        noise = np.zeros((len(outputs), 8))
        if seed is not None:
            noise = DEVIATIONS * np.random.default_rng(seed).normal(size=noise.shape)
        return as_measurements(outputs[:, :8] + noise)

    return measure


@pytest.fixture(scope="session")
def follow() -> Callable[..., list[Estimate]]:
    """Return a function that estimates along measurements."""

    def follow(model: EstimationModel, measurements: Iterable[Measurement]) -> list[Estimate]:
        measurements = list(measurements)
        estimator = MovingHorizonEstimator(model, measurements[0])
        estimates = []
        for measurement in measurements:
            estimates.append(estimator.update(measurement))
            estimator.prepare()
        return estimates

    return follow


@pytest.fixture(scope="session")
def recording() -> list[Measurement]:
    """Return 60 s of a real drive: the simulated machine's own noise, slips and rounding on the first curve.

    Its controller is all given, so that the recording stays what it is when the product's weights change.
    """
    weights = "tractor={steering=0.1,steering_rate=0.7},trailer={steering_rate=0.3}"
    controller = f"controller={{model='articulated',coupling='measured',{weights}}}"
    plain = load_configuration("articulated", ["actuation.identify=false", "estimator.slide.prior=0.0", controller])
    with Simulation(plain, seed=5) as simulation:
        return [record.measurement for record in islice(simulation.steps(), 300)]


def rotated(measurement: Measurement, angle: float, shift: tuple[float, float] = (0.0, 0.0)) -> Measurement:
    c, s = math.cos(angle), math.sin(angle)

    def turn(x: float, y: float) -> tuple[float, float]:
        return c * x - s * y + shift[0], s * x + c * y + shift[1]

    tractor = turn(measurement.tractor_x, measurement.tractor_y)
    trailer = turn(measurement.trailer_x, measurement.trailer_y)
    return replace(measurement, tractor_x=tractor[0], tractor_y=tractor[1], trailer_x=trailer[0], trailer_y=trailer[1])


def mirrored(measurement: Measurement) -> Measurement:
    return replace(
        measurement,
        tractor_y=-measurement.tractor_y,
        trailer_y=-measurement.trailer_y,
        hitch_angle=-measurement.hitch_angle,
        tractor_steering=-measurement.tractor_steering,
        trailer_steering=-measurement.trailer_steering,
    )


@pytest.fixture(scope="session")
def rotate() -> Callable[..., Measurement]:
    return rotated


@pytest.fixture(scope="session")
def mirror() -> Callable[[Measurement], Measurement]:
    return mirrored
