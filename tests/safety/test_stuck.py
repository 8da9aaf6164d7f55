"""Sensors that get stuck while driving: how soon a run ends, how far from the line, and that it names the sensor.

Run as a program it prints the table of docs/faults.md.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from ordinary import believed, measured
from sanity import Sanity

from drawbar.config import load_configuration
from drawbar.experiment.alteration import InterceptedMachine
from drawbar.recording.log import RunLog
from drawbar.report.path_errors import true_path_errors
from drawbar.signals import BodyReference, Measurement, Pose, Status
from drawbar.simulation import Simulation

DEGREE = math.pi / 180.0
FINE = ("machine.sensors.steering=0.0005", "machine.sensors.steering_resolution=0.0005")
"""a wheel-angle sensor with noise and digits of 0.03°; the usual one has digits of 1° and no noise"""
SENSORS = {
    "tractor_steering": "the sensor of the front wheels shows the very same",
    "trailer_steering": "the sensor of the trailer's joint shows the very same",
    "hitch_angle": "it is stuck",
}


def drive(speed: float, change: Callable[[Measurement], Measurement], *settings: str, seed: int = 0) -> RunLog:
    """Drive figure-eights whose measurements pass through a function."""
    radius = 8.0 if speed < 2.5 else 12.0
    configuration = load_configuration("articulated", [f"path.radii=[{radius}]", f"speed={speed}", *settings])
    with Simulation(configuration, seed=seed) as simulation:
        simulation.machine = InterceptedMachine(simulation.machine, change)
        return simulation.log()


def stuck(sensor: str, speed: float, settings: tuple[str, ...]) -> tuple[list[float], list[float]]:
    """Return how soon six runs end whose sensor gets stuck somewhere, s, and how far off either body has been, m."""
    times, distances = [], []
    for seed in range(6):
        begins, held = round((28.0 + 3.3 * seed) / speed / 0.2) * 0.2, []

        def fail(m: Measurement, begins: float = begins, held: list[float] = held) -> Measurement:
            if m.time < begins - 0.01:
                return m
            held.append(getattr(m, sensor))
            return replace(m, **{sensor: held[0]})

        log = drive(speed, fail, *settings, seed=seed)
        assert SENSORS[sensor] in log.outcome.reason
        errors = true_path_errors(log)
        times.append(log.records[-1].measurement.time - begins)
        distances += [float(np.nanmax(np.abs(each.error))) for each in (errors.tractor, errors.trailer)]
    return times, distances


def told(sensor: str, speed: float, times: list[float], distances: list[float]) -> str:
    """Return the line that says so."""
    return f"{sensor} {speed:g} m/s: {np.median(times):.1f} ({max(times):.1f}) s; {100.0 * max(distances):.0f} cm"


@pytest.mark.parametrize(
    ("sensor", "speed", "settings", "usually", "at_most", "distance"),
    [
        ("tractor_steering", 0.5, (), 4.5, 9.0, 0.06),  # seen when the wheels should next have turned by 4 degrees
        ("tractor_steering", 1.0, (), 3.0, 4.0, 0.07),
        ("tractor_steering", 2.0, (), 1.7, 3.0, 0.13),
        ("tractor_steering", 1.0, FINE, 1.8, 3.0, 0.07),
        ("tractor_steering", 2.0, FINE, 1.4, 2.0, 0.12),
        ("trailer_steering", 3.0, FINE, 1.8, 4.0, 0.12),
        ("hitch_angle", 0.5, (), 2.8, 4.0, 0.06),
        ("hitch_angle", 1.0, (), 3.0, 4.0, 0.07),
        ("hitch_angle", 2.0, (), 1.4, 2.0, 0.13),
    ],
)
def test_a_stuck_sensor_ends_the_run_and_is_named(
    sensor: str, speed: float, settings: tuple[str, ...], usually: float, at_most: float, distance: float
) -> None:
    times, distances = stuck(sensor, speed, settings)
    print(told(sensor, speed, times, distances))
    assert np.median(times) <= usually
    assert max(times) <= at_most
    assert max(distances) <= distance


@pytest.mark.parametrize("late", ["machine.actuators.dead_time=0.4", "machine.actuators.lag_factor=2.5"])
@pytest.mark.parametrize(("resolution", "hitch"), [(0.1, 2.0), (0.02, 0.5), (2.0, 0.1)])
@pytest.mark.parametrize("speed", [0.5, 2.0])
def test_sound_sensors_of_any_resolution_are_not_taken_for_stuck(
    late: str, resolution: float, hitch: float, speed: float
) -> None:
    def rounded(m: Measurement) -> Measurement:
        return replace(m, hitch_angle=hitch * DEGREE * round(m.hitch_angle / (hitch * DEGREE)))

    settings = (
        f"machine.sensors.steering_resolution={resolution * DEGREE}",
        "machine.sensors.hitch_angle=0.0003",
        late,
    )
    assert drive(speed, rounded, *settings, seed=1).outcome.finished


def statuses(resolution: float, turned: float, count: int = 80, stuck: int = 60) -> list[int]:
    """Return what is said of a hitch angle of a resolution, rad, that weaves; from sample `stuck` on the sensor rests
    while the estimate turns away by so much (rad) within a second and stays there."""
    sanity, seen = Sanity(), []
    nothing = BodyReference(progress=0.0, lateral_error=0.0, closest=np.zeros(4), samples=np.zeros((2, 4)))
    pose, told = Pose(x=0.0, y=0.0, yaw=0.0), 0.0
    for k in range(count):
        angle = 0.2 * math.sin(0.4 * min(k, stuck)) + turned * min(max(k - stuck, 0) / 5.0, 1.0)
        told = resolution * round(angle / resolution) if k <= stuck else told
        moment = measured(0.2 * k, 0.0, 0.2 * k - 2.0, 0.0, time=0.2 * k, speed=1.0, hitch_angle=told)
        seen.append(sanity.look(moment, replace(believed(pose, pose), hitch_angle=angle), nothing, nothing)[0])
    return seen


def test_of_a_fine_hitch_sensor_few_repetitions_in_motion_are_enough() -> None:
    said = statuses(0.001, 1.5 * DEGREE)
    assert said.index(Status.HITCH) - 60 == 7  # it has repeated itself once, at the crest of a wave: 2 * 1 + 5
    assert set(statuses(0.001, 0.5 * DEGREE)) == {0}  # it hardly moves
    assert set(statuses(1.5 * DEGREE, 1.5 * DEGREE)) == {0}  # it moves within the sensor's resolution
    assert set(statuses(0.001, 1.5 * DEGREE, count=45, stuck=30)) == {0}  # the sensor is not known yet


if __name__ == "__main__":
    for which, how in (("tractor_steering", FINE), ("trailer_steering", FINE), ("hitch_angle", ())):
        for fineness in dict.fromkeys(((), how)):
            for fast in (0.5, 1.0, 2.0, 3.0):
                print("fine" if fineness else "usual", told(which, fast, *stuck(which, fast, fineness)), flush=True)
