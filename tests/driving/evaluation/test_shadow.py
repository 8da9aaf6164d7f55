"""A drive in which drawbar only looks on: nothing is said to the actuators, and what it would have done is told."""

import math
import socket
from itertools import pairwise

import numpy as np
import pytest
from isobus_devices import isobus_devices
from recorded_rehearsal import recorded_rehearsal

from drawbar.config import load_configuration
from drawbar.driving.devices.actuators import gate_wires
from drawbar.driving.messaging.process_options import GateOptions
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.machine.stand_in.can_machine import CanMachine
from drawbar.messages import Action, SupervisorState
from drawbar.protocols.actuator import Readiness, SteeringRequest
from drawbar.protocols.speed_actuator import SpeedRequest
from drawbar.report.folder import write_report
from drawbar.report.path_errors import Bodies
from drawbar.safety.causes import Cause
from drawbar.safety.wires import Wires
from drawbar.transports.open import open_can

SEED = 3
STEER = SteeringRequest(steer=True, angle=0.1, speed=1.0)
DRIVE = SpeedRequest(drive=True, speed=1.0, deceleration=0.5)


def options(**devices):
    vehicle = {"wheelbase": 1.4, "tractor_limit": 0.6, "trailer_limit": 0.35}
    none = dict.fromkeys(("tractor_board", "trailer_board", "isobus"))
    safety = load_configuration("articulated").safety
    return GateOptions(folder="", safety=safety, **vehicle, **(none | devices), drives=True, shadow=True, controller=0)


def test_boards_are_heard_and_are_sent_nothing():
    board = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    free = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    for each in (board, free):
        each.bind(("127.0.0.1", 0))
    listen = free.getsockname()
    free.close()
    settings = SteerBoardSettings(
        address=f"127.0.0.1:{board.getsockname()[1]}", listen=f"127.0.0.1:{listen[1]}", max_angle=0.35
    )
    (wire,) = gate_wires(options(tractor_board=settings))
    actuators = Wires([wire])
    reply = bytes.fromhex("80817EFD08") + round(-5.0 * 100).to_bytes(2, "little", signed=True) + bytes(4) + b"\x07\x00"
    board.sendto(reply[:13] + bytes((sum(reply[2:13]) % 256,)), listen)
    board.settimeout(0.3)
    for tick in range(20):
        actuators.receive()
        assert actuators.send(tick * 0.05, (STEER, STEER), DRIVE)
    with pytest.raises(TimeoutError):
        board.recv(100)
    assert wire.tractor.report(1.0).angle == pytest.approx(math.radians(5.0))
    assert wire.tractor.report(1.0).readiness is Readiness.SHADOW
    actuators.close()
    board.close()


def test_valves_are_heard_and_nothing_is_said_on_their_bus():
    devices = isobus_devices(bus="can:virtual:shadow")
    far, witness = open_can("can:virtual:shadow"), open_can("can:virtual:shadow")
    machine = CanMachine(far, devices.isobus, takes_speed=True)
    actuators = Wires(gate_wires(options(isobus=devices.isobus)))
    for tick in range(100):
        machine.step(tick * 0.02, {"tractor": 0.2, "trailer": -0.1}, 1.0)
        actuators.receive()
        assert actuators.send(tick * 0.02, (STEER, STEER), DRIVE)
    said = {frame.identifier & 0xFF for _, frame in witness.read()}
    assert said == {38, 39, 0xA2, 0xFE}
    tractor, trailer = actuators.steering(2.0)
    assert (tractor.angle, trailer.angle) == (pytest.approx(0.2, abs=3e-4), pytest.approx(-0.1, abs=3e-4))
    assert actuators.speed(2.0) is None
    for bus in (far, witness, actuators):
        bus.close()


def test_it_is_never_engaged_and_its_report_tells_what_it_would_have_done(tmp_path):
    changes = ["path.radii=[8.0]", "safety.engage.wiggle_test=false"]
    configuration = load_configuration("articulated", changes).model_copy(update={"devices": isobus_devices()})
    with recorded_rehearsal(configuration, tmp_path / "log.mcap", SEED, shadow=True) as (rehearsal, _):
        records = [record for record, _ in rehearsal.run(18.0)]
        for action in (Action.ARM, Action.ENGAGE):
            rehearsal.ask(action)
            records += [record for record, _ in rehearsal.run(1.0)]
            assert not rehearsal.gate_state.steers
        assert rehearsal.gate_state.state is SupervisorState.STANDBY
        assert Cause.SHADOW.value in rehearsal.gate_state.refusals
    shadow = write_report(tmp_path).shadow
    free = shadow.judged_s * shadow.engageable_share
    refused = shadow.judged_s - free
    assert 17.0 < shadow.judged_s < 20.0
    assert set(shadow.refused_s) >= {"FIX_TOO_NEW", "UNPROVED"}
    assert not set(shadow.refused_s) & {"SHADOW", "EMERGENCY_UNTRIED", "WIGGLE_UNTRIED"}
    assert max(shadow.refused_s.values()) <= refused + 1e-6 <= sum(shadow.refused_s.values())
    amounts = [
        abs(before.tractor_steering.command - after.measurement.tractor_steering)
        for before, after in pairwise(records)
        if after.measurement.time > records[-1].measurement.time - free
    ]
    assert shadow.angle_measured == Bodies(tractor=True, trailer=True)
    assert abs(shadow.compared_steps.tractor - len(amounts)) <= 2
    assert shadow.compared_steps.tractor > 30
    assert shadow.difference_rad.tractor.mean == pytest.approx(np.mean(amounts), rel=0.1)
    assert shadow.difference_rad.trailer.max > 0.01
    assert 0.0 < shadow.driver_error_m.tractor.mean < shadow.driver_error_m.tractor.max < 1.0
