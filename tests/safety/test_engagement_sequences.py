"""The supervisor of a real machine under random sequences of causes, actions, actuators and times."""

from engagements import SETTINGS, SEVERITY, SILENCE
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from drawbar.messages import Action
from drawbar.safety.causes import Cause, Response
from drawbar.safety.engagement import (
    ACTIVE,
    DEGRADED,
    ENGAGING,
    ESTOP,
    FAULT,
    READY,
    STEERING,
    STOPPING,
    Engagement,
    Situation,
)


class Supervised(RuleBasedStateMachine):
    """Random causes, actions, actuators and times."""

    def __init__(self):
        super().__init__()
        self.engagement, self.time = Engagement(SETTINGS), 0.0
        self.asked_to_engage = False
        self.before = self.engagement.state
        self.acknowledged = False

    def update(self, seconds, **given):
        self.time += seconds
        situation = Situation(**{"causes": (), **given})
        self.before, since = self.engagement.state, self.engagement.since
        self.acknowledged = Action.ACKNOWLEDGE in situation.actions
        self.released = Action.RELEASE in situation.actions
        if Action.ENGAGE in situation.actions and self.before is READY:
            self.asked_to_engage = True
        self.engagement.update(self.time, situation)
        if self.engagement.state is self.before:
            assert self.engagement.since == since or self.before in (FAULT, ESTOP)
        self.check(situation)

    def check(self, situation):
        after = self.engagement.state
        if after in STEERING and self.before not in STEERING:
            assert self.asked_to_engage
            assert self.before is READY
            assert not any(cause.refuses for cause in situation.causes)
        if self.engagement.steers:
            assert not any(cause.response is Response.RELEASE for cause in situation.causes)
            assert not situation.overridden
        if self.before in SEVERITY and self.before is not DEGRADED and not self.acknowledged and not self.released:
            assert SEVERITY.get(after, -1) >= SEVERITY[self.before]
        if Action.EMERGENCY in situation.actions:
            assert after is ESTOP
        if not self.engagement.steers:
            self.asked_to_engage = False

    @rule(seconds=st.sampled_from([0.05, 0.5, 2.0, 11.0]), taken=st.booleans(), standing=st.booleans())
    def quiet(self, seconds, taken, standing):
        self.update(seconds, taken=taken, standing=standing)

    @rule(causes=st.lists(st.sampled_from(list(Cause)), max_size=3), overridden=st.booleans())
    def trouble(self, causes, overridden):
        self.update(0.05, causes=tuple(causes), overridden=overridden, taken=True)

    @rule(actions=st.frozensets(st.sampled_from(list(Action)), min_size=1), standing=st.booleans())
    def operator(self, actions, standing):
        self.update(0.05, actions=actions, standing=standing)

    @precondition(lambda self: self.engagement.state is READY)
    @rule()
    def engage(self):
        self.update(0.05, actions=frozenset({Action.ENGAGE}))

    @rule()
    def silence(self):
        for _ in range(240):
            self.update(0.05, causes=SILENCE)
        assert not self.engagement.steers

    @invariant()
    def steering_states_are_those(self):
        assert self.engagement.steers == (self.engagement.state in (ENGAGING, ACTIVE, DEGRADED, STOPPING))


Supervised.TestCase.settings = hypothesis_settings(
    derandomize=True, max_examples=60, stateful_step_count=40, deadline=None, database=None
)
TestSupervised = Supervised.TestCase
