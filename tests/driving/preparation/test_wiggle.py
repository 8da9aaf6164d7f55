"""The wiggle test of `drawbar check`: what it passes, what ends it at once, and how long it holds."""

import math
import sys
import threading
import time
from types import SimpleNamespace

import pytest
from board_server import BoardServer
from typer.testing import CliRunner
from waiting import PatientClock

from drawbar.cli.main import app
from drawbar.config import load_configuration
from drawbar.driving.preparation import check, wiggle, wiggle_record
from drawbar.driving.preparation.finding import Finding
from drawbar.driving.preparation.wiggle import TRAVEL, Phase, WiggleRun, carry_out
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.errors import StorageError
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.machine.stand_in.aio_v4 import AioV4
from drawbar.machine.stand_in.wheel import HeldWheel, MotorWheel
from drawbar.protocols.agopengps.steer_board import SteerBoard
from drawbar.safety.wires import Wire, Wires
from drawbar.transports.open import open_transport

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
RATE = math.radians(60.0)
"""of the wheel at full PWM, of which the board gives a fourth"""
SOURCE = "192.168.5.126:8888"


def tried(wheel=None, *, change=lambda now, board: None, speed=lambda now: 0.5, pause=(0.0, 0.0), **sensor):
    """Wiggle a stand-in board's wheel in virtual time; return the run, and the farthest that the wheel was.

    Within `pause`, s, the computer runs nothing.
    """
    wheel = wheel or MotorWheel(rate=RATE)
    board, actuator, run = AioV4(wheel, **sensor), SteerBoard(board=SOURCE, max_angle=0.5), WiggleRun()
    farthest, now = 0.0, 0.0
    while run.phase is not Phase.ENDED or now < 0.5:
        now += 0.01
        change(now, board)
        replies = board.advance(now)
        if round(now * 100) % 5 == 0 and not pause[0] < now < pause[1]:
            for frame in actuator.send(now, run.tick(now, actuator.report(now), speed(now))):
                replies += board.receive(now, frame, 9999)
        for reply in replies:
            actuator.receive(now, reply.data, SOURCE)
        farthest = max(farthest, abs(wheel.angle))
        assert now < 40.0, "it ends by itself"
    assert not run.tick(now, actuator.report(now), 0.5).steer
    return run, farthest


def refusal(run):
    found = run.judged()
    assert not found.passed
    return found.refusals[0]


def test_a_sound_steering_passes_and_moves_by_two_degrees():
    run, farthest = tried()
    found = run.judged()
    assert found.passed, found
    assert found.gain == pytest.approx(1.0, abs=0.1)
    assert 0.0 < found.delay < 0.5
    assert math.radians(1.5) < farthest < math.radians(3.0)


def test_a_sensor_that_counts_the_other_way_ends_it_as_a_runaway():
    run, farthest = tried(sensor_counts=-30.0)
    assert "runaway" in refusal(run)
    assert farthest < TRAVEL + math.radians(4.0)


def test_wheels_that_do_not_move_are_reported():
    run, farthest = tried(HeldWheel())
    assert "does not move" in refusal(run)
    assert farthest == 0.0


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda now, board: board.override() if 4.0 < now < 4.02 else None, "operator took over"),
        (lambda now, board: board.restart(now, outage=3.0) if 4.0 < now < 4.02 else None, "reports nothing"),
    ],
)
def test_what_happens_meanwhile_ends_it(change, words):
    run, _ = tried(change=change)
    assert words in refusal(run)


@pytest.mark.parametrize(("ends", "told"), [(4.19, False), (4.4, True)])
def test_a_pause_of_the_computer_is_reported_where_it_ended_the_test(ends, told):
    run, _ = tried(pause=(4.0, ends))
    assert run.judged().passed is not told
    assert ("This computer had paused for 0.4 s" in run.reason) is told


def test_a_motor_that_is_too_slow_is_reported():
    run, _ = tried(MotorWheel(rate=math.radians(25.0)))
    assert "delay" in refusal(run)


@pytest.mark.parametrize("speed", [lambda now: 0.0, lambda now: math.nan, lambda now: 0.5 if now < 4.0 else 2.0])
def test_it_moves_nothing_unless_the_vehicle_rolls(speed):
    run, farthest = tried(speed=speed)
    assert "roll straight ahead" in refusal(run)
    assert farthest == 0.0 or speed(0.0) == 0.5


def test_it_waits_until_the_vehicle_rolls():
    run, _ = tried(speed=lambda now: 0.0 if now < 20.0 else 0.5)
    assert run.judged().passed


def test_it_passes_over_a_real_socket(monkeypatch):
    clock = PatientClock()
    monkeypatch.setattr(wiggle, "time", SimpleNamespace(monotonic=clock, sleep=time.sleep))
    server = BoardServer(AioV4(MotorWheel(rate=RATE), start=clock()), port=0, clock=clock)
    host, port = server.address
    settings = SteerBoardSettings(address=f"{host}:{port}", listen="127.0.0.1:0", max_angle=0.5)
    wires = Wires([Wire(transport=open_transport(settings.transport, clock), tractor=settings.actuator())])
    stop = threading.Event()
    thread = threading.Thread(target=server.run, args=(stop,))
    thread.start()
    try:
        found = carry_out(wires, 0, lambda now: 0.5)
    finally:
        stop.set()
        thread.join()
        wires.close()
        server.close()
    assert found.passed, found
    assert not server.board.driving


@pytest.fixture
def machine(tmp_path, monkeypatch):
    monkeypatch.delenv("STATE_DIRECTORY", raising=False)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return with_stand_ins(load_configuration("articulated", ["path.radii=[8.0]"]))


def test_a_pass_holds_for_these_actuators_this_run_of_the_computer_and_a_day(machine, tmp_path, monkeypatch):
    assert not wiggle_record.has_passed(machine)
    wiggle_record.keep_passed(machine)
    assert wiggle_record.has_passed(machine)
    boards = machine.devices.model_copy(update={"trailer_board": machine.devices.tractor_board})
    assert not wiggle_record.has_passed(machine.model_copy(update={"devices": boards}))
    assert not wiggle_record.has_passed(machine.model_copy(update={"devices": None}))
    later = wiggle_record._running() + wiggle_record.LONGEST + 1.0
    with monkeypatch.context() as patch:
        patch.setattr(wiggle_record, "_running", lambda: later)
        assert not wiggle_record.has_passed(machine)
    other = tmp_path / "boot"
    other.write_text("another")
    with monkeypatch.context() as patch:
        patch.setattr(wiggle_record, "_BOOT", other)
        assert not wiggle_record.has_passed(machine)
    wiggle_record._file().write_text("{")
    assert not wiggle_record.has_passed(machine)
    wiggle_record.forget_passed()
    wiggle_record.forget_passed()
    assert not wiggle_record.has_passed(machine)


def test_a_service_without_a_home_keeps_it_in_the_folder_that_systemd_gives_it(machine, tmp_path, monkeypatch):
    monkeypatch.setenv("STATE_DIRECTORY", f"{tmp_path / 'lib'}:{tmp_path / 'other'}")
    monkeypatch.setenv("XDG_STATE_HOME", "/proc/nowhere")
    wiggle_record.forget_passed()
    assert not wiggle_record.has_passed(machine)
    wiggle_record.keep_passed(machine)
    assert wiggle_record.has_passed(machine)
    assert (tmp_path / "lib" / "wiggled.json").is_file()


@pytest.mark.usefixtures("at_a_terminal")
def test_nothing_is_moved_where_a_pass_cannot_be_kept(machine, tmp_path, monkeypatch):
    file = tmp_path / "my.toml"
    file.write_text(machine.to_toml(), "utf-8")
    monkeypatch.setattr(check, "check", lambda *arguments, **names: [Finding(device="all", received=True)])
    monkeypatch.setattr(wiggle, "wiggle_both", lambda configuration: pytest.fail("it was moved"))
    monkeypatch.setenv("XDG_STATE_HOME", "/proc/nowhere")
    result = CliRunner().invoke(app, ["check", str(file), "--wiggle"], input="y\ny\n")
    assert isinstance(result.exception, StorageError), result.output
    assert "set STATE_DIRECTORY" in str(result.exception)


@pytest.mark.parametrize("answers", ["n\n", "y\nn\n", "y\n", "y\ny\n"])
@pytest.mark.usefixtures("at_a_terminal")
def test_the_command_asks_twice(machine, tmp_path, monkeypatch, answers):
    file, moved = tmp_path / "my.toml", []
    file.write_text(machine.to_toml(), "utf-8")
    monkeypatch.setattr(check, "check", lambda *arguments, **names: [Finding(device="all", received=True)])

    def both(configuration):
        moved.append(configuration)
        run, _ = tried()
        yield "front wheels", run.judged()

    monkeypatch.setattr(wiggle, "wiggle_both", both)
    wiggle_record.keep_passed(machine)
    result = CliRunner().invoke(app, ["check", str(file), "--wiggle"], input=answers)
    agreed = answers.count("y") == 2
    assert (len(moved) == 1, result.exit_code) == (agreed, 0 if agreed else 1), result.output
    assert agreed or result.output.endswith("nothing was moved\n")
    assert wiggle_record.has_passed(machine)


def test_a_program_that_answers_yes_moves_nothing(machine, tmp_path, monkeypatch):
    file = tmp_path / "my.toml"
    file.write_text(machine.to_toml(), "utf-8")
    monkeypatch.setattr(check, "check", lambda *arguments, **names: [Finding(device="all", received=True)])
    monkeypatch.setattr(wiggle, "wiggle_both", lambda configuration: pytest.fail("it was moved"))
    result = CliRunner().invoke(app, ["check", str(file), "--wiggle"], input="y\n" * 9)
    assert result.exit_code == 1, result.output
    assert result.output.endswith("ssh -t)\nnothing was moved\n")


@pytest.mark.parametrize("receivers", [1, 2])
def test_both_steerings_are_wiggled_with_one_receiver_or_two(monkeypatch, receivers):
    configuration = with_stand_ins(load_configuration("articulated"))
    if receivers == 1:
        devices = configuration.devices.model_copy(update={"trailer_receiver": None})
        configuration = configuration.model_copy(update={"devices": devices})
    asked = []

    def carried_out(wires, body, speed):
        asked.append((body, speed(0.0)))
        return tried()[0].judged()

    monkeypatch.setattr(wiggle, "carry_out", carried_out)
    assert len(list(wiggle.wiggle_both(configuration))) == 2
    assert [body for body, _ in asked] == [0, 1]
    assert all(math.isnan(speed) for _, speed in asked)


def test_the_joint_is_not_moved_after_the_operator_took_over_at_the_front_wheels(monkeypatch):
    asked = []

    def taken_over(wires, body, speed):
        asked.append(body)
        return tried(change=lambda now, board: board.override() if 2.5 < now < 2.6 else None)[0].judged()

    monkeypatch.setattr(wiggle, "carry_out", taken_over)
    ((name, found),) = wiggle.wiggle_both(with_stand_ins(load_configuration("articulated")))
    assert (name, found.refusals, asked) == ("front wheels", ("the operator took over",), [0])
