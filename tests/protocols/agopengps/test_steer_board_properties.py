"""The adapter of a steer board under anything: random sequences of replies, silences, requests, and arbitrary bytes."""

import math
import struct

from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule
from steer_bench import BOARDS, HOST, Bench

from drawbar.protocols.actuator import Readiness, SteeringRequest
from drawbar.protocols.agopengps.frame import COMPUTER, PREFIX, STEER_BOARD, Frame, Pgn, checksum, pack, parse
from drawbar.protocols.agopengps.steer_board import SteerBoard
from drawbar.protocols.agopengps.steering import SteerCommand, decode_steer

FLOATS = st.floats(allow_nan=True, allow_infinity=True)
ANGLES = st.one_of(st.floats(-0.5, 0.5), st.sampled_from([math.nan, math.inf, 1e300]))
SPEEDS = st.one_of(st.floats(-6.0, 6.0), st.sampled_from([math.nan, -math.inf, 7.5, 1e300]))
RELEASE_TIME = 0.026
"""of a board that hears status 0, s"""


class AnySequence(RuleBasedStateMachine):
    """Adapter and stand-in, and everything that can happen between them."""

    firmware = "v4"

    def __init__(self) -> None:
        super().__init__()
        self.bench = Bench(self.firmware)
        self.seen = 0
        self.edge_open = False
        """a request has risen since the last release, and status 1 may be sent for it"""
        self.taken_over = False
        self.asked = False
        self.quiet_since = -math.inf
        """end of the last own gap"""
        self.last_sent = -math.inf
        self.bench.run(2.5)
        self.check_sent()

    def check_sent(self) -> None:
        """Look at each frame that was sent since the last look, and at the motor."""
        bench = self.bench
        for time, command in bench.sent[self.seen :]:
            if time - self.last_sent >= 1.0:
                self.quiet_since = time
            self.last_sent = time
            if command.steer:
                assert bench.request.steer
                assert self.edge_open
                assert not self.taken_over
                assert time >= self.quiet_since + 1.0 - 1e-9
                assert abs(command.angle) <= math.radians(35.01)
                assert abs(command.speed) <= 25.05 / 3.6
            else:
                self.edge_open = False  # whatever released, only a new edge may steer
        self.seen = len(bench.sent)

    def ticks(self, count: int) -> None:
        """Call the adapter at 20 Hz, so that a call with an edge sends a frame at once."""
        for _ in range(count):
            rising = self.bench.request.steer and not self.asked
            if rising:
                self.edge_open, self.taken_over = True, False
            self.asked = self.bench.request.steer
            sent = len(self.bench.sent)
            self.bench.tick()
            if rising and len(self.bench.sent) == sent:
                self.edge_open = False  # another computer has the board: refused in silence
            self.check_sent()

    @rule(count=st.integers(1, 40))
    def go_on(self, count: int) -> None:
        self.ticks(count)

    @rule(angle=ANGLES, speed=SPEEDS, steer=st.booleans(), hold=st.integers(1, 30))
    def request(self, angle: float, speed: float, steer: bool, hold: int) -> None:
        self.bench.ask(steer=steer, angle=angle, speed=speed)
        self.ticks(hold)

    @rule()
    def engage_properly(self) -> None:
        self.bench.ask(steer=False)
        self.bench.replies_pass = self.bench.set_points_pass = True
        self.bench.wheel.angle = 0.0
        self.ticks(60)
        self.bench.ask(steer=True)
        self.ticks(12)

    @rule(duration=st.integers(1, 60))
    def own_gap(self, duration: int) -> None:
        self.bench.ticks += duration

    @rule(replies=st.booleans(), set_points=st.booleans(), count=st.integers(1, 60))
    def loss(self, replies: bool, set_points: bool, count: int) -> None:
        self.bench.replies_pass, self.bench.set_points_pass = replies, set_points
        self.ticks(count)
        self.bench.replies_pass = self.bench.set_points_pass = True

    @rule(outage=st.floats(0.0, 3.0))
    def restart(self, outage: float) -> None:
        self.bench.board.restart(self.bench.time + 0.03, outage)

    @precondition(lambda self: self.bench.report.engaged)
    @rule(count=st.integers(4, 60))
    def operator_takes_over(self, count: int) -> None:
        self.bench.board.override()
        self.ticks(3)  # noticed, said with the next reply, status 0 sent and heard
        if self.bench.report.overridden:
            self.taken_over = True
            assert not self.bench.board.driving
        self.ticks(count)

    @rule(pressed=st.booleans())
    def button(self, pressed: bool) -> None:
        self.bench.board.press(pressed=pressed)

    @rule(angle=st.floats(-1.0, 1.0))
    def wheel(self, angle: float) -> None:
        self.bench.wheel.angle = angle

    @rule(data=st.binary(min_size=8, max_size=8))
    def strange_reply(self, data: bytes) -> None:
        self.bench.adapter.receive(self.bench.time + 0.002, pack(STEER_BOARD, Pgn.STEER_REPLY, data), HOST)

    @rule(count=st.integers(1, 30))
    def other_master(self, count: int) -> None:
        other = SteerCommand(steer=True, angle=0.1, speed=1.0).encode()
        for _ in range(count):
            self.bench.adapter.receive(self.bench.time, other, "192.168.5.20:9999")
            self.ticks(1)

    @rule()
    def a_release_stops_the_motor(self) -> None:
        self.bench.ask(steer=False)
        self.ticks(1)
        self.bench.carry(self.bench.board.advance(self.bench.time + 0.001 + RELEASE_TIME))
        assert not self.bench.board.driving
        self.bench.ticks += 1

    @invariant()
    def never_engaged_unasked(self) -> None:
        assert self.bench.request.steer or not self.bench.report.engaged


class AnySequenceV26(AnySequence):
    firmware = "v26"


TestAnySequence = AnySequence.TestCase
TestAnySequenceV26 = AnySequenceV26.TestCase
TestAnySequence.settings = TestAnySequenceV26.settings = settings(
    max_examples=60, stateful_step_count=25, deadline=None, derandomize=True
)


def sealed(body: bytes) -> bytes:
    """Return a frame with a right length and checksum round any source, message and data."""
    frame = PREFIX + body[:2].ljust(2, b"\0") + bytes((len(body[2:]),)) + body[2:]
    return frame + bytes((checksum(frame),))


DATAGRAMS = st.one_of(
    st.binary(max_size=80),
    st.binary(max_size=60).map(lambda rest: PREFIX + rest),
    st.binary(max_size=60).map(sealed),
    st.binary(max_size=40).map(lambda data: sealed(bytes((STEER_BOARD, Pgn.STEER_REPLY)) + data)),
    st.binary(max_size=40).map(lambda data: sealed(bytes((COMPUTER, Pgn.STEER)) + data)),
)
SOURCES = st.one_of(st.just(HOST), st.just("192.168.5.20:9999"), st.text(max_size=20))


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.lists(st.tuples(DATAGRAMS, SOURCES, st.floats(0.0, 1.0), FLOATS, FLOATS, st.booleans()), max_size=30))
def test_nothing_received_or_asked_raises(steps: list[tuple[bytes, str, float, float, float, bool]]) -> None:
    adapter = SteerBoard(board="192.168.5.126", max_angle=0.6)
    time = 0.0
    for datagram, source, wait, angle, speed, steer in steps:
        adapter.receive(time, datagram, source)
        time += wait
        for sent in adapter.send(time, SteeringRequest(steer=steer, angle=angle, speed=speed)):
            frame = parse(sent)
            assert isinstance(frame, Frame)
            command = decode_steer(frame)
            assert command is None or not command[0].steer or (steer and math.isfinite(angle))
        adapter.report(time)
    assert len(adapter.dropped) <= 8


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.lists(DATAGRAMS, max_size=30), st.sampled_from(sorted(BOARDS)))
def test_stand_ins_take_any_bytes(datagrams: list[bytes], firmware: str) -> None:
    board = Bench(firmware, start=0.0).board
    for place, datagram in enumerate(datagrams):
        for output in board.receive(place * 0.02, datagram):
            assert isinstance(parse(output.data), Frame)
    board.advance(1.0)


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.floats(-5.7, 5.7), st.floats(-100.0, 100.0), st.booleans())
def test_set_points_survive_the_wire(angle: float, speed: float, steer: bool) -> None:
    frame = parse(SteerCommand(steer=steer, angle=angle, speed=speed).encode())
    assert isinstance(frame, Frame)
    read = decode_steer(frame)
    assert read is not None
    assert read[0].steer is steer
    assert abs(read[0].angle - angle) <= math.radians(0.0051)
    assert abs(read[0].speed - abs(speed)) <= 0.05 / 3.6 * 1.01


def test_angles_of_the_wire_that_no_set_point_can_hold_do_not_stop_zeros() -> None:
    adapter = SteerBoard(board="192.168.5.126", max_angle=0.6)
    reply = pack(STEER_BOARD, Pgn.STEER_REPLY, struct.pack("<hhhBB", -0x8000, 0, 0, 7, 0))
    adapter.receive(0.0, reply, HOST)
    assert len(adapter.send(0.0, SteeringRequest(steer=False, angle=0.0, speed=1.0))) == 2
    assert adapter.report(0.0).readiness is not Readiness.READY
