"""Messages of a drive with nothing in them but what a test is about."""

import dataclasses
import math

from drawbar.messages import ControllerState, GateState, OperatorMessage, SupervisorState


def gate_of(state, cause=None):
    return _of(GateState, state=state, cause=0 if cause is None else cause.value, refusals=(0,) * 8)


def ready_gate(sequence):
    """Return a state of a gate that may be engaged, and does not know what it need not know."""
    unknown = ("remaining", "tractor_set_point", "trailer_set_point", "trailer_angle", "set_speed")
    known = dataclasses.replace(gate_of(SupervisorState.READY), sequence=sequence, time=10**9, tractor_angle=0.1)
    return dataclasses.replace(known, **dict.fromkeys(unknown, math.nan))


def controller_of(status):
    return _of(ControllerState, status=int(status), notices=(0,) * 8)


def asked(action, value=math.nan):
    return _of(OperatorMessage, action=action, value=value)


def _of(kind, **values):
    fields = [field.name for field in dataclasses.fields(kind)]
    return kind(**(dict.fromkeys(fields, 0) | values))
