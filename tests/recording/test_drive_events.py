"""Events of a drive, from its log; in words of the report, of the terminal and of the log's outcome."""

import dataclasses
import sys
from dataclasses import replace
from types import SimpleNamespace

import pytest
from drive_messages import asked, controller_of, gate_of

from drawbar.config import load_configuration
from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.driving.messaging.process_options import GATE, RECORDER
from drawbar.driving.operator.display import headline
from drawbar.driving.operator.requests import Operator, gate_sender
from drawbar.errors import DrawbarError, StorageError
from drawbar.messages import Action, OperatorMessage, SupervisorState
from drawbar.messages.records import decode
from drawbar.recording.drive_events import Became, Loss, Noticed, drive_events
from drawbar.recording.drive_log import DriveLog
from drawbar.recording.header import run_header
from drawbar.recording.log import read_log
from drawbar.recording.scene import Scene
from drawbar.report.events import event_rows
from drawbar.report.folder import write_report
from drawbar.safety.causes import Cause
from drawbar.simulation import build_path
from drawbar.statuses import Status

ENDED = "the drive was ended before the end of the path"
STEERED = replace(gate_of(SupervisorState.ACTIVE), steers=1)


@pytest.fixture(scope="module")
def header_and_scene():
    configuration = load_configuration("articulated")
    path, _ = build_path(configuration)
    return run_header(configuration, path, None, seed=0), Scene(path=path, vehicle=configuration.vehicle, frame=None)


@pytest.fixture
def log_of(tmp_path, header_and_scene):
    def write(*messages):
        with DriveLog(tmp_path / "log.mcap", *header_and_scene) as log:
            for second, message in enumerate(messages):
                log.add_message(replace(message, time=second * 10**9, sequence=second))
        return tmp_path / "log.mcap"

    return write


def test_an_end_of_the_controllers_run_is_reported_with_its_status_and_another_cause_without(log_of):
    log = log_of(
        gate_of(SupervisorState.ACTIVE),
        controller_of(Status.HITCH),
        gate_of(SupervisorState.STOPPING, Cause.CONTROLLER_STOPS),
        gate_of(SupervisorState.FAULT, Cause.STEERING_LOST),
    )
    active, stopping, fault = drive_events(log)
    assert isinstance(active, Became)
    assert active.cause is None
    assert (stopping.status, fault.status) == (Status.HITCH, None)
    assert list(event_rows([active, stopping, fault])) == [
        ("0.0 s", ["ACTIVE: steering", ""]),
        ("2.0 s", [f"STOPPING: {Cause.CONTROLLER_STOPS.sentence}: {Status.HITCH.text}", Cause.CONTROLLER_STOPS.advice]),
        ("3.0 s", [f"FAULT: {Cause.STEERING_LOST.sentence}", Cause.STEERING_LOST.advice]),
    ]


def noticing(*causes):
    codes = [cause.value for cause in causes]
    return replace(controller_of(Status.OK), notices=(*codes, *[0] * (8 - len(codes))))


def test_a_notice_is_reported_once_each_time_the_vehicle_is_steered_and_not_before(log_of):
    silent, drift = Cause.RECEIVER_SILENT, Cause.POSITIONS_DRIFT
    standby = gate_of(SupervisorState.STANDBY)
    log = log_of(
        *(standby, noticing(drift), STEERED, noticing(silent), noticing(silent, drift), noticing(silent)),
        *(standby, noticing(silent), STEERED, noticing(silent)),
    )
    told = [each for each in drive_events(log, is_on=True) if isinstance(each, Noticed)]
    first, second = ([each.sentence, each.advice] for each in (silent, drift))
    assert event_rows(told) == [("0.0 s", first), ("1.0 s", second), ("6.0 s", first)]


def test_the_end_of_a_drive_is_no_fault(log_of):
    log = log_of(STEERED, gate_of(SupervisorState.FAULT, Cause.ENDED))
    assert [cells for _, cells in event_rows(drive_events(log))][-1] == ["the drive was ended", ""]


def test_what_was_asked_for_is_reported_once_with_its_value(log_of):
    wish = asked(Action.SET_SPEED, 0.8)
    rows = event_rows(drive_events(log_of(gate_of(SupervisorState.READY), asked(Action.PRESENT), wish, wish)))
    assert [cells[0] for _, cells in rows] == ["READY: ready to engage", "the operator asked for a speed of 0.8 m/s"]


def test_what_is_asked_for_again_before_anything_else_happens_is_reported_once_but_for_shifts(log_of):
    stop, state = asked(Action.STOP), gate_of(SupervisorState.STOPPING)
    asks = [asked(Action.NUDGE, 0.05)] * 2 + [asked(Action.SET_SPEED, each) for each in (1.0, 1.0, 1.1)]
    messages = [stop, stop, state, stop, stop, *asks]
    log = log_of(*(each if each is state else replace(each, nonce=i) for i, each in enumerate(messages)))
    told = [cells[0].removeprefix("the operator asked ") for _, cells in event_rows(drive_events(log))]
    shifts, speeds = ["to shift the line by 0.05 m"] * 2, ["for a speed of 1 m/s", "for a speed of 1.1 m/s"]
    assert told == ["for a stop", "STOPPING: stopping", "for a stop", *shifts, *speeds]


def _answer(nonce, answer, *refusals, state=SupervisorState.STANDBY):
    state = gate_of(state)
    codes = [each.value for each in refusals] + [0] * (8 - len(refusals))
    return replace(state, answered=nonce, answer=answer.value if answer else 0, refusals=tuple(codes))


@pytest.mark.parametrize(
    ("answer", "standing", "told"),
    [
        (Cause.STATE_NOT_READY, (Cause.TOO_SLOW, Cause.WIGGLE_UNTRIED), (Cause.TOO_SLOW, Cause.WIGGLE_UNTRIED)),
        (Cause.STATE_NOT_READY, (), (Cause.STATE_NOT_READY,)),
        (Cause.LEASE_HELD, (Cause.TOO_SLOW,), (Cause.LEASE_HELD,)),
        (None, (Cause.TOO_SLOW,), ()),
    ],
)
def test_a_refused_request_is_reported_once_with_what_stood_against_it(log_of, answer, standing, told):
    arm = [replace(asked(Action.ARM), nonce=nonce) for nonce in (7, 8)]
    answers = [_answer(nonce, answer, *standing) for nonce in (0, 7, 7, 8)]
    log = log_of(answers[0], arm[0], *answers[1:3], arm[1], answers[3])
    rows = [cells for _, cells in event_rows(drive_events(log))]
    assert rows[:2] == [["STANDBY: not ready to engage", ""], ["the operator asked to arm", ""]]
    assert rows[2:] == [[f"refused: {each.sentence}", each.advice] for each in told]


def test_a_request_in_a_state_that_waits_is_told_to_acknowledge(log_of):
    arm, waiting = replace(asked(Action.ARM), nonce=7), SupervisorState.STOPPED
    answers = [_answer(nonce, Cause.STATE_NOT_READY, Cause.TOO_SLOW, state=waiting) for nonce in (0, 7)]
    rows = [cells for _, cells in event_rows(drive_events(log_of(answers[0], arm, answers[1])))]
    assert rows[-1] == [f"refused: {Cause.STATE_NOT_READY.sentence}", Cause.STATE_NOT_READY.advice]


def test_a_refusal_of_presence_is_no_event(log_of):
    present = replace(asked(Action.PRESENT), nonce=7)
    log = log_of(_answer(0, None), present, _answer(7, Cause.SEEN_OLD))
    assert [cells[0] for _, cells in event_rows(drive_events(log))] == ["STANDBY: not ready to engage"]


def test_a_state_that_is_recorded_late_is_no_event_of_its_own(tmp_path, header_and_scene):
    states = [SupervisorState.READY, SupervisorState.READY, SupervisorState.ESTOP, SupervisorState.ESTOP]
    messages = [replace(gate_of(state), time=each * 10**9, sequence=each) for each, state in enumerate(states)]
    with DriveLog(tmp_path / "log.mcap", *header_and_scene) as log:
        for each in (0, 2, 1, 3):
            log.add_message(messages[each])
    assert [event.state for event in drive_events(tmp_path / "log.mcap")] == [states[0], states[2]]


def test_a_record_that_ends_while_it_steers_is_an_event_of_a_log_that_does_not_grow(log_of):
    log = log_of(replace(gate_of(SupervisorState.ACTIVE), steers=1))
    assert [cells[0] for _, cells in event_rows(drive_events(log))] == ["ACTIVE: steering", Loss.ENDS.value]
    assert len(drive_events(log, is_on=True)) == 1


def test_a_log_with_a_state_that_there_is_not_is_refused_and_its_report_says_so(log_of, tmp_path):
    log = log_of(gate_of(99))
    with pytest.raises(DrawbarError, match=r"log\.mcap: cannot be read \(99 is not a valid"):
        drive_events(log)
    (said,) = write_report(tmp_path).losses
    assert said.startswith(f"what happened cannot be told: {log}: cannot be read (99 is not a valid")
    assert "what happened cannot be told" in (tmp_path / "report.html").read_text("utf-8")


@pytest.mark.skipif(sys.platform == "win32", reason="an open file is not removed there")
def test_a_log_that_is_removed_is_reported_and_one_that_is_renamed_goes_on(tmp_path, header_and_scene):
    log = DriveLog(tmp_path / "log.mcap", *header_and_scene)
    assert log.is_in_place
    (tmp_path / "log.mcap").rename(tmp_path / "renamed.mcap")
    log.flush()
    assert not log.is_in_place
    (tmp_path / "log.mcap").write_bytes(b"another")
    assert not log.is_in_place
    (tmp_path / "renamed.mcap").unlink()
    with pytest.raises(StorageError, match=r"log\.mcap: the log was removed"):
        log.flush()
    log.give_up()


@pytest.mark.parametrize(
    ("messages", "reason"),
    [
        ((STEERED,), ENDED),
        ((gate_of(SupervisorState.STANDBY),), f"{ENDED}; drawbar never steered"),
        ((STEERED, gate_of(SupervisorState.STOPPED, Cause.POSITION_LOST), gate_of(SupervisorState.STANDBY)), ENDED),
        ((STEERED, gate_of(SupervisorState.FAULT, Cause.ENDED)), ENDED),
        ((gate_of(SupervisorState.FAULT, Cause.ENDED),), f"{ENDED}; drawbar never steered"),
        (
            (
                STEERED,
                gate_of(SupervisorState.STOPPED, Cause.POSITION_LOST),
                gate_of(SupervisorState.FAULT, Cause.ENDED),
            ),
            f"{ENDED}; STOPPED: {Cause.POSITION_LOST.sentence}",
        ),
        (
            (STEERED, controller_of(Status.ROLL), gate_of(SupervisorState.STOPPED, Cause.CONTROLLER_STOPS)),
            f"{ENDED}; STOPPED: {Cause.CONTROLLER_STOPS.sentence}: {Status.ROLL.text}",
        ),
    ],
)
def test_the_outcome_says_what_had_stopped_the_drive(log_of, messages, reason):
    assert read_log(log_of(*messages)).outcome.reason == reason


def test_the_report_of_a_drive_says_what_happened(log_of, tmp_path):
    log_of(gate_of(SupervisorState.FAULT, Cause.STEERING_STUCK))
    write_report(tmp_path)
    page = (tmp_path / "report.html").read_text("utf-8")
    assert f"<td>FAULT: {Cause.STEERING_STUCK.sentence}</td><td>{Cause.STEERING_STUCK.advice}</td>" in page


@pytest.mark.parametrize(
    ("bits", "names"), [(1, ": front wheels"), (2, ": joint"), (7, ": front wheels, joint, speed"), (0, "")]
)
def test_report_and_terminal_name_the_actuators_that_reported_the_cause(log_of, tmp_path, bits, names):
    state = dataclasses.replace(gate_of(SupervisorState.FAULT, Cause.SILENT), concerned=bits)
    log_of(state)
    write_report(tmp_path)
    assert f"<td>FAULT: {Cause.SILENT.sentence}{names}</td>" in (tmp_path / "report.html").read_text("utf-8")
    assert f"({Cause.SILENT.sentence}{names})" in headline(state).plain


def test_the_terminal_says_how_the_controllers_run_has_ended():
    state = gate_of(SupervisorState.STOPPED, Cause.CONTROLLER_STOPS)
    assert Status.OSCILLATION.text in headline(state, controller_of(Status.OSCILLATION)).plain
    assert Status.OK.text not in headline(state, controller_of(Status.OK)).plain
    assert Cause.CONTROLLER_STOPS.sentence in headline(state).plain


def test_what_an_operator_asks_for_is_recorded_and_that_one_is_there_is_not(tmp_path):
    options = SimpleNamespace(socket=lambda name: str(tmp_path / name))
    ours, gate, recorder = (Endpoint(str(tmp_path / name)) for name in ("front", GATE, RECORDER))
    operator = Operator(1, gate_sender(ours, options))
    for action in (Action.PRESENT, Action.STOP):
        operator.ask(action, 10**9)
    heard = [[decode(data, OperatorMessage).action for data in each.receive()] for each in (gate, recorder)]
    assert heard == [[Action.PRESENT, Action.STOP], [Action.STOP]]
    for each in (ours, gate, recorder):
        each.close()
