"""Supervisors that have come to a state, and what the tests of the supervisor share."""

from drawbar.messages import Action
from drawbar.safety.causes import Cause
from drawbar.safety.conditions import Observation, present
from drawbar.safety.engagement import (
    ACTIVE,
    BOOT,
    DEGRADED,
    ENGAGING,
    ESTOP,
    FAULT,
    OVERRIDE,
    READY,
    SELFTEST,
    STANDBY,
    STOPPED,
    STOPPING,
    Engagement,
    Situation,
)
from drawbar.safety.settings import SafetySettings

SETTINGS = SafetySettings()
SEVERITY = {ACTIVE: 0, DEGRADED: 1, STOPPING: 2, STOPPED: 2, OVERRIDE: 3, FAULT: 4, ESTOP: 5}
"""of states in which something is wrong"""
SILENCE = present(Observation(), SETTINGS)
"""causes of total silence"""


def brought_to(state, *, settings=SETTINGS):
    """Return a supervisor that has come to a state by what it went by, at time 100 s."""
    ways = {
        BOOT: "", SELFTEST: "b", STANDBY: "bs", READY: "bsm", ENGAGING: "bsme", ACTIVE: "bsmet", DEGRADED: "bsmetw",
        STOPPING: "bsmetx", STOPPED: "bsmetxr", OVERRIDE: "bsmeto", FAULT: "bsmetf", ESTOP: "bq",
    }  # fmt: skip
    engagement = Engagement(settings)
    time = 0.0
    for step in ways[state]:
        time += {"s": 1.0625, "m": 2.0625, "t": 1.0625}.get(step, 0.0625)
        given = {
            "e": {"actions": frozenset({Action.ENGAGE})},
            "t": {"taken": True},
            "w": {"causes": (Cause.FIX_LOST,)},
            "x": {"actions": frozenset({Action.STOP})},
            "r": {"actions": frozenset({Action.RELEASE})},
            "o": {"overridden": True},
            "f": {"causes": (Cause.SILENT,)},
            "q": {"actions": frozenset({Action.EMERGENCY})},
        }.get(step, {})
        engagement.update(time, Situation(**{"causes": (), **given}))
    assert engagement.state is state
    shift = 100.0 - time
    for name in ("since", "_unmet", "_degraded", "_moved"):
        setattr(engagement, name, getattr(engagement, name) + shift)
    return engagement
