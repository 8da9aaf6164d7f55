"""The steps that are timed in C are those of the run: every command is the recorded one."""

from itertools import islice

from drawbar.benchmark.step_in_c import step_times
from drawbar.config import load_configuration
from drawbar.simulation import Simulation


def test_commands_are_those_of_the_run() -> None:
    simulation = Simulation(load_configuration("articulated"))
    records = list(islice(simulation.steps(), 60))
    times = step_times(simulation.autopilot, simulation.path, [record.measurement for record in records])
    assert list(times.commands) == [record.command for record in records]
    assert times.feedback.shape == times.preparation.shape == (60,)
    assert (times.feedback > 0.0).all()
    assert (times.preparation > 0.0).all()
