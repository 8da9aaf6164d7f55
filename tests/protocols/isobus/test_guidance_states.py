"""Any sequence of requests, frames, silences and faults: never "intended" without an edge, never after a fault."""

from dataclasses import replace

import hypothesis.strategies as st
from hypothesis import given, settings
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule
from isobus_bench import GOOD, NAME, OWN, VALVE, Bench, intention

from drawbar.protocols.isobus.address import CLAIM
from drawbar.protocols.isobus.guidance_messages import (
    MACHINE_INFO,
    SYSTEM_COMMAND,
    Intention,
    MachineInfo,
    SystemCommand,
    encode_command,
    encode_machine_info,
)
from drawbar.transports.base import CanFrame

BAD = st.sampled_from(
    [
        {"locked_out": True},
        {"ready": False},
        {"in_position": None},
        {"reset_required": True},
        {"limit": 1},
        {"limit": 6},
        {"exit_reason": 3},
        {"exit_reason": 5},
        {"exit_reason": 9},
    ]
)
ANGLES = st.floats(-0.5, 0.5) | st.sampled_from([float("nan"), float("inf"), 1.56])


class Steering(RuleBasedStateMachine):
    """Judges the wire by what happened, with rules of its own."""

    def __init__(self) -> None:
        super().__init__()
        self.bench = Bench()
        self.bench.run(2.0)
        self.seen = len(self.bench.sent)
        self.may_begin = True
        """a command "not intended" went out without a request since the last "intended" or fault"""
        self.steering = False
        self.faulty = False
        """a fault has happened since the last tick"""
        self.silent_since: float | None = None

    @rule(ticks=st.integers(1, 15), steer=st.booleans(), angle=ANGLES)
    def pass_time(self, ticks: int, steer: bool, angle: float) -> None:
        for _ in range(ticks):
            quiet = self.silent_since is not None and self.bench.time - self.silent_since > 0.3 + 1e-9
            sayable = abs(angle) < 1.5
            if quiet or self.faulty or (steer and not sayable):
                self.may_begin = self.steering = False
            sent = [message for message in self.bench.tick(steer, angle) if message.pgn == SYSTEM_COMMAND]
            assert len(sent) <= 1
            for message in sent:
                self.judge(steer, intention(message))
            self.faulty = False

    def judge(self, steer: bool, said: Intention) -> None:
        if said is Intention.INTENDED:
            assert steer
            assert self.steering or self.may_begin
            self.steering, self.may_begin = True, False
        else:
            assert said is Intention.NOT_INTENDED
            self.steering = False
            self.may_begin = self.may_begin or not steer

    @rule(change=BAD)
    def valve_tells_a_state_that_forbids(self, change: dict[str, object]) -> None:
        self.bench.tell(**change)
        self.note_fault()

    @rule(change=BAD)
    def valve_goes_on_telling_it(self, change: dict[str, object]) -> None:
        self.bench.info = replace(GOOD, **change)
        self.bench.tell(**change)
        self.note_fault()

    @rule()
    def valve_is_well(self) -> None:
        self.bench.info = GOOD
        self.silent_since = None

    @precondition(lambda self: self.bench.info is not None)
    @rule()
    def valve_falls_silent(self) -> None:
        self.bench.info = None
        self.silent_since = self.bench.time

    @rule(stronger=st.booleans())
    def another_claims_our_address(self, stronger: bool) -> None:
        if stronger and self.bench.node.claim.held:
            self.note_fault()
        self.bench.receive(CLAIM, replace(NAME, identity=1 if stronger else 999).data, self.bench.node.claim.address)

    @rule()
    def another_uses_our_address(self) -> None:
        if self.bench.node.claim.held:
            self.note_fault()
        self.bench.receive(0xFE48, bytes(8), self.bench.node.claim.address)

    @rule()
    def another_steers(self) -> None:
        command = encode_command(SystemCommand(curvature=0.0, intention=Intention.INTENDED))
        self.bench.receive(SYSTEM_COMMAND, command, 0x55)
        self.note_fault()

    @rule(identifier=st.integers(0, (1 << 29) - 1), data=st.binary(max_size=10))
    def anything_comes(self, identifier: int, data: bytes) -> None:
        self.bench.feed(CanFrame(identifier, data))

    def note_fault(self) -> None:
        """A fault ends steering for good; while not steering it only forbids to begin as long as it stands."""
        self.faulty = self.steering
        if self.steering:
            self.may_begin = False

    @invariant()
    def report_agrees_with_the_wire(self) -> None:
        report = self.bench.valve.report(self.bench.time)
        assert not report.engaged or self.steering


TestSteering = Steering.TestCase
TestSteering.settings = settings(derandomize=True, max_examples=60, stateful_step_count=40, deadline=None)


@given(
    frames=st.lists(
        st.tuples(
            st.integers(0, 4).map(lambda n: [MACHINE_INFO, SYSTEM_COMMAND, CLAIM, 0xEA00, 0xCC00][n])
            | st.integers(0, 0x3FFFF),
            st.integers(0, 255) | st.sampled_from([OWN, VALVE]),
            st.binary(max_size=9) | st.just(encode_machine_info(GOOD)) | st.just(encode_machine_info(MachineInfo())),
        ),
        max_size=60,
    ),
    steer=st.booleans(),
)
@settings(derandomize=True, max_examples=150, deadline=None)
def test_no_frame_raises_and_none_makes_it_steer(frames: list[tuple[int, int, bytes]], steer: bool) -> None:
    bench = Bench()
    bench.info = None
    for pgn, source, data in frames:
        bench.feed(CanFrame(6 << 26 | pgn << 8 | source, data))
        bench.tick(steer)
    assert not any(
        intention(message) is Intention.INTENDED for _, message in bench.sent if message.pgn == SYSTEM_COMMAND
    )
