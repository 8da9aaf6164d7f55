"""A whole drive by ISOBUS and NMEA 2000, with the real frames and a clock of its own."""

import math

import numpy as np
import pytest
from isobus_devices import isobus_devices
from rehearsals import drive_until, errors, rehearse, released_after

from drawbar.messages import Action, SupervisorState


@pytest.fixture(scope="module")
def on_the_bus():
    rehearsal, path = rehearse(devices=isobus_devices())
    return rehearsal, path, list(rehearsal.run(40.0))


def test_isobus_steers_and_drives_by_nmea_2000(on_the_bus):
    rehearsal, path, steps = on_the_bus
    assert rehearsal.gate_state.state is SupervisorState.ACTIVE
    assert rehearsal.gate_state.engaged == 7
    assert steps[-1][1].speed == pytest.approx(steps[-1][0].command.speed, abs=0.02)
    driven = errors(steps, path)
    assert len(driven) > 120
    assert driven.mean() < 0.02
    assert driven.max() < 0.06
    assert all(not valve.exits for valve in rehearsal.machine.can.valves.values())


@pytest.mark.parametrize("phase", [0.0, 0.05, 0.1, 0.15])
def test_a_tractor_that_is_engaged_while_it_rolls_is_not_braked(phase):
    rehearsal, _ = rehearse("safety.engage.fixed=1.0", devices=isobus_devices())
    asked, send = [], rehearsal.gate.wires.send

    def watched(time, steering, speed):
        asked.append(speed.speed if speed.drive else math.nan)
        return send(time, steering, speed)

    rehearsal.gate.wires.send = watched
    rehearsal._look += phase
    while rehearsal.gate_state is None or rehearsal.gate_state.state is not SupervisorState.ACTIVE:
        rehearsal.advance()
        assert rehearsal.time < 30.0
    list(rehearsal.run(1.0))
    assert np.nanmin(asked) > 0.1


def test_the_tractor_stops_by_the_bus_when_asked_to_and_stays(on_the_bus):
    rehearsal, _, _ = on_the_bus
    drive_until(rehearsal, SupervisorState.ACTIVE)
    rehearsal.ask(Action.STOP)
    assert 1.0 < released_after(rehearsal, 12.0) < 12.0
    assert rehearsal.gate_state.state is SupervisorState.STOPPED
    assert rehearsal.machine.can.tractor.commanded(rehearsal.time) == 0.0
    assert rehearsal.machine.world.truth.speed == pytest.approx(0.0, abs=0.02)


def test_an_operator_at_the_tractors_pedal_takes_over():
    rehearsal, _ = rehearse(devices=isobus_devices())
    drive_until(rehearsal, SupervisorState.ACTIVE)
    rehearsal.machine.can.tractor.operator_drives = True
    assert released_after(rehearsal, 1.0) < 0.3
    assert rehearsal.gate_state.state is SupervisorState.OVERRIDE
    for _ in rehearsal.run(1.0):
        assert not any(valve.engaged for valve in rehearsal.machine.can.valves.values())
