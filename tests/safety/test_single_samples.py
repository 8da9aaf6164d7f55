"""One false sample of a sensor ends no run and takes neither body aside: whole runs, on a side slope with masts."""

import math
from dataclasses import replace

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.experiment.alteration import InterceptedMachine
from drawbar.geometry import Floats
from drawbar.report.path_errors import true_path_errors
from drawbar.signals import Measurement
from drawbar.simulation import Simulation

SETTINGS = (
    "path.radii=[8.0]",
    "machine.attitude={tractor={present=true},trailer={present=true},yaw={present=true}}",
    "machine.terrain={slope=0.05}",
    "vehicle.masts={tractor={up=2.5},trailer={up=2.0}}",
)
FALSE = {
    "hitch_angle": (85.0, -85.0, 20.0),
    "tractor_steering": (85.0, -85.0, 30.0),
    "trailer_steering": (85.0, -85.0, 30.0),
    "tractor_yaw_rate": (300.0, -300.0, 30.0),
    "tractor_yaw": (85.0,),
    "tractor_roll": (60.0, 25.0),
    "tractor_pitch": (25.0,),
    "trailer_roll": (25.0,),
    "trailer_pitch": (25.0,),
    "speed": (math.degrees(-20.0), 0.0, math.degrees(20.0)),
}
"""sensors, and what they falsely report, degrees (of the speed, as if it were radians)"""
APART = 14.0
"""way from one false sample to the next, m: on straights, in curves to both sides, and where one begins"""
SEED = 4


def errors(speed: float, name: str = "", false: float = math.nan) -> tuple[bool, list[Floats]]:
    """Return whether a run came to its end, and the distance of both bodies from the line at each sample, m."""

    def change(m: Measurement) -> Measurement:
        sample, every = round(m.time / 0.2), round(APART / speed / 0.2)
        return replace(m, **{name: false}) if name and sample % every == every - 1 else m

    with Simulation(load_configuration("articulated", [*SETTINGS, f"speed={speed}"]), seed=SEED) as simulation:
        simulation.machine = InterceptedMachine(simulation.machine, change)
        log = simulation.log()
    found = true_path_errors(log)
    return log.outcome.finished, [np.abs(each.error) for each in (found.tractor, found.trailer)]


@pytest.fixture(scope="module", params=[1.0, 2.0])
def sound(request: pytest.FixtureRequest) -> tuple[float, list[Floats]]:
    """Return a speed, m/s, and the distances of a run at it whose sensors are sound."""
    finished, distances = errors(request.param)
    assert finished
    return request.param, distances


@pytest.mark.parametrize(("name", "false"), [(name, value) for name, values in FALSE.items() for value in values])
def test_single_false_samples_cost_little(sound: tuple[float, list[Floats]], name: str, false: float) -> None:
    speed, without = sound
    finished, distances = errors(speed, name, math.radians(false))
    assert finished
    for false_ones, sound_ones in zip(distances, without, strict=True):
        assert np.nanmax(false_ones) < np.nanmax(sound_ones) + 0.02
        assert np.nanmean(false_ones) < np.nanmean(sound_ones) + 0.002
