"""What every machine promises, whatever it is: one suite for all."""

import math
from collections.abc import Callable
from itertools import pairwise

import pytest

from drawbar.config import load_configuration
from drawbar.machine.base import EndOfMeasurements, Machine
from drawbar.machine.replayed import ReplayedMachine
from drawbar.signals import Command, Measurement
from drawbar.simulation import Simulation

SAMPLE = 0.2
STAND = Command(time=0.0, tractor_steering=0.0, trailer_steering=0.0, speed=0.0)
GO = Command(time=0.0, tractor_steering=0.1, trailer_steering=-0.05, speed=1.0)


class RecordingMachine(Machine):
    """Passes everything on to another machine, and keeps the measurements and what it was told."""

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self.measurements: list[Measurement] = []
        self.received: list[Command | str] = []

    def read(self) -> Measurement:
        self.measurements.append(self._machine.read())
        return self.measurements[-1]

    def write(self, command: Command) -> None:
        self._machine.write(command)
        self.received.append(command)

    def stop(self) -> None:
        self._machine.stop()
        self.received.append("stop")

    def close(self) -> None:
        self._machine.close()
        self.received.append("close")


def simulated() -> Machine:
    return Simulation(load_configuration("articulated")).machine


def physics() -> Machine:
    pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install 'drawbar[physics]'")
    return Simulation(load_configuration("articulated", ["machine.kind=physics"])).machine


def replayed() -> Machine:
    machine = simulated()
    return ReplayedMachine([machine.read() for _ in range(60)])


def recording() -> Machine:
    return RecordingMachine(simulated())


@pytest.fixture(params=[simulated, physics, replayed, recording], ids=lambda make: make.__name__)
def machine(request: pytest.FixtureRequest) -> Machine:
    make: Callable[[], Machine] = request.param
    return make()


def test_the_machine_owns_the_clock(machine: Machine) -> None:
    times = [machine.read().time for _ in range(20)]
    assert all(b - a == pytest.approx(SAMPLE) for a, b in pairwise(times))


def test_reading_needs_no_writing_and_writing_no_reading(machine: Machine) -> None:
    machine.read()
    for _ in range(5):
        machine.write(STAND)
    first = machine.read().time
    for _ in range(3):
        machine.read()
    assert machine.read().time == pytest.approx(first + 4 * SAMPLE)


def test_a_stop_is_possible_at_any_time_and_again(machine: Machine) -> None:
    machine.stop()
    machine.read()
    machine.stop()
    machine.write(GO)
    machine.stop()
    machine.stop()
    assert math.isfinite(machine.read().time)


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit, ValueError])
def test_whatever_leaves_the_context_it_ends_with_a_stop(error: type[BaseException]) -> None:
    machine = RecordingMachine(simulated())

    def fail() -> None:
        with machine:
            machine.read()
            machine.write(GO)
            raise error

    with pytest.raises(error):
        fail()
    assert machine.received[-2:] == ["stop", "close"]


def test_a_machine_whose_stop_fails_is_closed_nevertheless() -> None:
    machine = RecordingMachine(simulated())

    def broken() -> None:
        raise OSError("the cable is out")

    machine.stop = broken  # type: ignore[method-assign]
    with pytest.raises(OSError, match="cable"), machine:
        machine.read()
    assert machine.received == ["close"]


@pytest.mark.parametrize("signal", [KeyboardInterrupt, SystemExit])
def test_a_machine_that_is_interrupted_while_it_is_told_to_stop_is_told_again(signal: type[BaseException]) -> None:
    machine = RecordingMachine(simulated())
    stop, interrupts = machine.stop, iter([signal])

    def slow() -> None:
        for interrupt in interrupts:
            raise interrupt
        stop()

    machine.stop = slow  # type: ignore[method-assign]
    with pytest.raises(signal), machine:
        raise ValueError
    assert machine.received == ["stop", "close"]


def test_what_was_recorded_is_replayed() -> None:
    recorder = RecordingMachine(simulated())
    with recorder:
        for _ in range(30):
            recorder.read()
            recorder.write(GO)
    again = ReplayedMachine(recorder.measurements)
    for measurement in recorder.measurements:
        assert again.read() == measurement
        again.write(STAND)
    with pytest.raises(EndOfMeasurements):
        again.read()
