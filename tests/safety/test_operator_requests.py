"""Operator requests: leases, nonces, what an operator must have seen, and switches."""

import math

import pytest
from gate_bench import Bench

from drawbar.messages import Action, OperatorMessage, SupervisorState
from drawbar.safety.causes import Cause
from drawbar.safety.engagement import Engagement
from drawbar.safety.operator_requests import OperatorRequests
from drawbar.safety.settings import SafetySettings

READY = SupervisorState.READY


class Table:
    """Requests in front of a supervisor that is ready, and operators who see what they must."""

    def __init__(self, state=READY):
        self.engagement = Engagement(SafetySettings())
        self.engagement.state = state
        self.requests = OperatorRequests(SafetySettings(), self.engagement)
        self.time, self.nonce = 100.0, 0
        self.show()

    def show(self, sequence=1):
        self.seen = (sequence, round(self.time * 1e9))
        self.requests.show(*self.seen)

    def message(self, action, value=0.0, lease=7, nonce=None, age=0.0, valid=1.0, seen=None):
        self.nonce += 1
        sent = self.time - age
        sequence, shown = seen or self.seen
        return OperatorMessage(
            time=round(sent * 1e9), valid_until=round((sent + valid) * 1e9), action=action, lease=lease,
            nonce=self.nonce if nonce is None else nonce, seen_sequence=sequence, seen_time=shown, value=value,
        )  # fmt: skip

    def ask(self, action, *value, **given):
        message = self.message(action, *value, **given)
        self.requests.answer = None
        self.requests.receive(self.time, message)
        assert self.requests.answered == message.nonce or action is Action.PRESENT
        return self.requests.answer


def test_nothing_is_asked_for_in_the_beginning():
    requests = Table().requests
    assert (requests.answered, requests.lease, requests.line, requests.nudge) == (0, 0, 0, 0.0)
    assert requests.answer is None
    assert math.isnan(requests.set_speed)


def test_arming_takes_the_lease_and_engaging_needs_it():
    table = Table()
    assert table.ask(Action.ENGAGE) is Cause.NOT_ARMED
    assert table.ask(Action.ARM) is None
    assert table.requests.lease == 7
    assert table.engagement.armed(table.time)
    assert table.ask(Action.ENGAGE, lease=8) is Cause.LEASE_HELD
    assert table.ask(Action.ARM, lease=8) is Cause.LEASE_HELD
    assert table.ask(Action.ENGAGE) is None
    assert table.requests.take() == {Action.ENGAGE}
    assert table.requests.take() == set()


def test_who_reports_to_be_present_does_not_take_another_ones_answer_away():
    """Both may come within one tick of the gate, after which the operator would not be told why nothing happens."""
    table = Table()
    assert table.ask(Action.ENGAGE) is Cause.NOT_ARMED
    table.requests.receive(table.time, table.message(Action.PRESENT, lease=8))
    assert (table.requests.answer, table.requests.answered) == (Cause.NOT_ARMED, table.nonce - 1)


def test_the_lease_of_a_silent_holder_is_free():
    table = Table()
    table.ask(Action.ARM)
    table.time += 2.0
    table.show()
    assert table.ask(Action.ARM, lease=8) is Cause.LEASE_HELD
    table.time += 0.01
    assert table.ask(Action.ENGAGE, lease=8) is Cause.NOT_ARMED
    assert table.ask(Action.ARM, lease=8) is None
    assert table.requests.lease == 8
    table.time += 1.9
    table.show()
    assert table.ask(Action.PRESENT, lease=8) is None
    table.time += 0.2
    assert table.ask(Action.ARM, lease=7) is Cause.LEASE_HELD, "the holder has spoken"


def test_whoever_releases_gives_the_lease_back():
    table = Table()
    table.ask(Action.ARM)
    table.ask(Action.RELEASE, lease=8)
    assert table.requests.lease == 7
    table.ask(Action.RELEASE)
    assert table.requests.lease == 0
    assert table.ask(Action.ARM, lease=8) is None


@pytest.mark.parametrize("action", [Action.RELEASE, Action.STOP, Action.EMERGENCY])
def test_stopping_needs_nothing(action):
    table = Table()
    table.ask(Action.ARM, lease=8)
    assert table.ask(action, lease=0, nonce=0, age=100.0, seen=(9, 9)) is None
    assert table.requests.take() == {action}


def test_a_message_counts_once_and_while_it_is_fresh():
    table = Table()
    assert table.ask(Action.PRESENT, nonce=5) is None
    assert table.ask(Action.PRESENT, nonce=5) is Cause.REPLAYED
    assert table.ask(Action.PRESENT, nonce=4) is Cause.REPLAYED
    assert table.ask(Action.PRESENT, nonce=4, lease=8) is None, "each session counts for itself"
    assert table.ask(Action.PRESENT, nonce=6, age=1.01) is Cause.REPLAYED
    assert table.ask(Action.PRESENT, nonce=6, age=0.5, valid=0.4) is Cause.REPLAYED
    assert table.ask(Action.PRESENT, nonce=6, age=-0.01) is Cause.REPLAYED, "from the future"
    assert table.ask(Action.PRESENT, nonce=6, age=1.01, valid=5.0) is Cause.REPLAYED
    assert table.ask(Action.PRESENT, nonce=6, lease=0) is Cause.REPLAYED
    assert table.ask(Action.PRESENT, nonce=0, lease=9) is Cause.REPLAYED
    assert table.ask(Action.PRESENT, nonce=6, age=0.99) is None
    assert table.ask(Action.PRESENT, nonce=7, age=-0.004) is None, "made while the gate already looks"
    assert table.ask(Action.PRESENT, nonce=8, age=0.5, valid=0.5) is None, "until then"
    assert table.ask(Action.PRESENT, nonce=9, age=1.0, valid=5.0) is None


def test_sessions_are_remembered_up_to_a_number_the_silent_ones_forgotten_first():
    table = Table()
    for lease in range(1, 17):
        table.ask(Action.PRESENT, lease=lease, nonce=9)
    table.ask(Action.PRESENT, lease=1, nonce=10)
    table.ask(Action.PRESENT, lease=99, nonce=9)
    assert table.ask(Action.PRESENT, lease=1, nonce=10) is Cause.REPLAYED
    assert table.ask(Action.PRESENT, lease=3, nonce=9) is Cause.REPLAYED
    assert table.ask(Action.PRESENT, lease=2, nonce=9) is None, "the one that was silent for longest is forgotten"


def test_an_operator_must_see_what_is_so_now():
    table = Table()
    assert table.ask(Action.ARM, seen=(1, 1)) is Cause.SEEN_OLD
    assert table.ask(Action.ARM, seen=(2, table.seen[1])) is Cause.SEEN_OLD
    table.time += 1.0
    assert table.ask(Action.ARM) is None
    table.time += 0.01
    assert table.ask(Action.ENGAGE) is Cause.SEEN_OLD
    assert table.requests.take() == set()


def test_of_the_states_that_were_shown_the_last_64_count():
    table = Table()
    seen = table.seen
    for sequence in range(2, 65):
        table.show(sequence)
    assert table.ask(Action.ARM, seen=seen) is None
    table.show(65)
    assert table.ask(Action.ARM, seen=seen) is Cause.SEEN_OLD


def test_who_is_responsible_must_be_heard():
    table = Table()
    assert table.requests.age(table.time) == math.inf
    table.ask(Action.PRESENT, lease=8)
    table.ask(Action.ARM)
    table.time += 1.0
    table.show()
    assert table.requests.age(table.time) == 1.0
    table.ask(Action.PRESENT, lease=8)
    assert table.requests.age(table.time) == 0.0, "before engaging anybody will do"
    table.engagement.state = SupervisorState.ACTIVE
    assert table.requests.age(table.time) == 1.0, "then only who engaged"
    table.ask(Action.PRESENT)
    assert table.requests.age(table.time) == 0.0
    table.ask(Action.PRESENT, seen=(0, 0))
    table.time += 0.5
    assert table.requests.age(table.time) == 0.5


def test_a_switch_counts_by_its_edges_and_as_presence():
    table = Table()
    table.requests.switch(0, True)
    assert table.requests.take() == set(), "it was on before"
    assert table.requests.age(table.time) == 0.0
    table.requests.switch(0, False)
    assert table.requests.take() == {Action.RELEASE}
    table.requests.switch(0, True)
    table.requests.switch(0, True)
    assert table.requests.take() == {Action.ENGAGE}
    table.engagement.state = SupervisorState.ACTIVE
    assert table.requests.age(table.time) == 0.0
    table.requests.switch(0, None)
    assert table.requests.age(table.time) == math.inf, "it is not heard any more"
    table.requests.switch(0, True)
    assert table.requests.take() == set(), "nor does coming back ask for anything"
    table.requests.switch(1, None)


def test_who_engages_by_message_is_responsible_though_there_is_a_switch():
    table = Table()
    table.requests.switch(0, False)
    table.requests.switch(0, True)
    table.ask(Action.ARM)
    table.ask(Action.ENGAGE)
    table.engagement.state = SupervisorState.ACTIVE
    table.time += 3.0
    assert table.requests.age(table.time) == 3.0


@pytest.mark.parametrize(
    ("action", "value", "answer"),
    [
        (Action.NUDGE, 0.3, None),
        (Action.NUDGE, -0.3, None),
        (Action.NUDGE, 0.31, Cause.OUT_OF_RANGE),
        (Action.NUDGE, -0.31, Cause.OUT_OF_RANGE),
        (Action.SET_SPEED, 0.5, None),
        (Action.SET_SPEED, 4.2, None),
        (Action.SET_SPEED, 4.3, Cause.OUT_OF_RANGE),
        (Action.SET_SPEED, 0.0, Cause.OUT_OF_RANGE),
        (Action.SET_SPEED, -1.0, Cause.OUT_OF_RANGE),
    ],
)
def test_wishes_within_their_limits_pass(action, value, answer):
    table = Table()
    assert table.ask(action, value) is Cause.NOT_ARMED, "only the holder of the lease may wish"
    table.ask(Action.ARM)
    assert table.ask(action, value) is answer
    nudge = value if action is Action.NUDGE and answer is None else 0.0
    speed = value if action is Action.SET_SPEED and answer is None else math.nan
    assert table.requests.nudge == nudge
    assert table.requests.set_speed == pytest.approx(speed, nan_ok=True)
    assert table.requests.take() == set()


def test_nudges_add_up_to_their_limit():
    table = Table()
    table.ask(Action.ARM)
    assert [table.ask(Action.NUDGE, 0.125) for _ in range(3)] == [None, None, Cause.OUT_OF_RANGE]
    assert table.requests.nudge == 0.25
    assert table.ask(Action.NUDGE, -0.5) is None


def test_what_the_state_does_not_allow_is_answered():
    table = Table(SupervisorState.STANDBY)
    assert table.ask(Action.ARM) is Cause.STATE_NOT_READY
    assert table.requests.lease == 0
    assert table.ask(Action.ACKNOWLEDGE) is Cause.NOTHING_TO_ACKNOWLEDGE
    table.engagement.state = SupervisorState.OVERRIDE
    assert table.ask(Action.ACKNOWLEDGE) is None
    assert table.requests.lease == 7
    assert table.requests.take() == {Action.ACKNOWLEDGE}


def test_the_answer_is_in_the_gates_state():
    bench = Bench().run(0.5)
    bench.ask(Action.ARM)
    bench.operator = False
    bench.run()
    assert (bench.shown.answer, bench.shown.answered) == (Cause.STATE_NOT_READY.value, bench.nonce)


def test_a_line_is_chosen_while_nothing_is_steered_and_takes_the_lease():
    table = Table(SupervisorState.STANDBY)
    assert table.ask(Action.LINE, -2.0) is None
    assert (table.requests.line, table.requests.lease) == (-2, 7)
    assert table.ask(Action.LINE, 1.0, lease=8) is Cause.LEASE_HELD
    assert table.ask(Action.LINE, -10_000.0) is None
    assert table.ask(Action.LINE, -2.0) is None
    for value in (0.5, 10_001.0, -1e300):
        assert table.ask(Action.LINE, value) is Cause.OUT_OF_RANGE
    table.engagement.state = SupervisorState.ACTIVE
    assert table.ask(Action.LINE, 1.0) is Cause.STEERED
    assert table.requests.line == -2
    assert table.requests.take() == set()
