"""A drive that the console steers by hand: other line, nudges, other speed; its log replays bit for bit."""

import sys

import pytest
from console_hand import Hand, in_state
from patience import PATIENT

from drawbar.config import load_configuration
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.driving.evaluation.replay import replay_drive
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.messages import Action, ControllerState, GateState, SupervisorState
from drawbar.recording.drive_records import open_drive

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
WIDTH = 0.2
"""m; the next line is near enough to begin on it"""


def test_a_drive_with_nudges_other_speed_and_other_line_replays_bit_for_bit(tmp_path):
    changes = ["path.radii=[8.0]", f"path.working_width={WIDTH}", *PATIENT]
    configuration = with_stand_ins(load_configuration("articulated", changes))
    (tmp_path / CONFIGURATION_NAME).write_text(configuration.to_toml(), "utf-8")
    with DriveProcesses(configuration, tmp_path, stand_ins=True) as processes:
        hand = Hand(processes, configuration)
        hand.tries_emergency()
        hand.until(lambda gate: gate.line == 1, lambda _: (Action.LINE, 1.0))
        hand.drives(WIDTH)
        hand.engages()
        hand.until(lambda gate: gate.nudge > 0.01, lambda _: (Action.NUDGE, 0.02))
        hand.until(lambda gate: abs(gate.set_speed - 0.8) < 1e-9, lambda _: (Action.SET_SPEED, 0.8))
        moved = WIDTH + hand.link.gate.nudge
        hand.drives(moved)
        hand.drive_on(3.0)
        hand.until(in_state(SupervisorState.STOPPED), lambda _: (Action.STOP,))
        hand.close()
    with open_drive(tmp_path / "log.mcap") as records:
        seen = [record for record in records if isinstance(record, GateState | ControllerState)]
    assert {state.line for state in seen if isinstance(state, GateState)} == {0, 1}
    offsets = {round(state.line_offset, 9) for state in seen if isinstance(state, ControllerState)}
    assert {0.0, WIDTH, round(moved, 9)} <= offsets
    again = replay_drive(tmp_path / "log.mcap")
    assert again.differences == ()
    speeds = [record.command.speed for record in again.records]
    assert min(abs(speed - 0.8) for speed in speeds) < 1e-6
