"""A drive that the console steers by hand: other line, nudges, other speed; its log replays bit for bit."""

import select
import sys
import time

import pytest
from patience import PATIENT

from drawbar.config import load_configuration
from drawbar.console.audit import Audit
from drawbar.console.link import Link
from drawbar.console.visitors import Rank, Visitor
from drawbar.driving.crew import CONFIGURATION_NAME, Crew
from drawbar.driving.demonstration import with_stand_ins
from drawbar.driving.mail import Mailbox
from drawbar.driving.orders import CONSOLE, GATE
from drawbar.driving.replay import replay_drive
from drawbar.messages import Action, ControllerState, GateState, SupervisorState, encode
from drawbar.recording.drive_records import open_drive

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
LONGEST = 90.0
"""time until something happens on a busy machine, s"""
WIDTH = 0.2
"""m; the next line is near enough to begin on it"""


class Hand:
    """The console's end of a drive, with a browser that draws at once and somebody at it."""

    def __init__(self, crew, configuration):
        self._mailbox, gate = Mailbox(crew.orders.socket(CONSOLE)), crew.orders.socket(GATE)
        mast = configuration.vehicle.masts.tractor
        self.link = Link(
            lambda message: self._mailbox.send(gate, encode(message)), Audit(None), time.monotonic_ns, mast
        )
        self._visitor = Visitor(token="one", number=1, name="one", rank=Rank.MAINTAINER)

    def until(self, condition, does=None):
        """Look and be present until a condition of the gate's state holds; ask for what `does` says each second."""
        end, again = time.monotonic() + LONGEST, 0.0
        while not (self.link.gate is not None and condition(self.link.gate)):
            assert time.monotonic() < end, self.link.gate
            select.select([self._mailbox], [], [], 0.05)
            for data in self._mailbox.receive():
                self.link.hear(data)
            self.link.pass_time()
            if self.link.gate is not None:
                self.link.drawn(self._visitor, self.link.gate.sequence)
            if does is not None and self.link.gate is not None and time.monotonic() > again:
                again = time.monotonic() + 1.0
                self.link.ask(self._visitor, *does(self.link.gate))

    def drives(self, offset):
        """Wait until the line so far to the left is driven, m."""
        self.until(lambda _: self.link.controller is not None and abs(self.link.controller.line_offset - offset) < 1e-9)

    def drive_on(self, duration):
        end = time.monotonic() + duration
        self.until(lambda _: time.monotonic() > end)

    def close(self):
        self._mailbox.close()


def in_state(*states):
    return lambda gate: gate.state in states


def test_a_drive_with_nudges_other_speed_and_other_line_replays_bit_for_bit(tmp_path):
    changes = ["path.radii=[8.0]", f"path.working_width={WIDTH}", *PATIENT]
    configuration = with_stand_ins(load_configuration("articulated", changes))
    (tmp_path / CONFIGURATION_NAME).write_text(configuration.to_toml(), "utf-8")
    with Crew(configuration, tmp_path, stand_ins=True) as crew:
        hand = Hand(crew, configuration)
        hand.until(in_state(SupervisorState.STANDBY))
        hand.until(in_state(SupervisorState.ESTOP), lambda _: (Action.EMERGENCY,))
        hand.until(in_state(SupervisorState.STANDBY, SupervisorState.READY), lambda _: (Action.ACKNOWLEDGE,))
        hand.until(lambda gate: gate.line == 1, lambda _: (Action.LINE, 1.0))
        hand.drives(WIDTH)
        hand.until(in_state(SupervisorState.READY))
        hand.until(in_state(SupervisorState.ACTIVE), lambda gate: (Action.ENGAGE if gate.armed else Action.ARM,))
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
