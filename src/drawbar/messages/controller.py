"""Controller: what it reports, and what it asks of the actuators."""

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Annotated

from drawbar.messages.base import Message
from drawbar.messages.fields import Byte, Cell, Codes, Count, Known, Number


class Mode(IntEnum):
    """What the controller is about."""

    IDLE = 0
    """it computes, but no run has begun; its command is what it would begin with"""
    DRIVE = 1
    """a run is on"""
    STOP = 2
    """the run has ended; the vehicle is to stop along the steering of these commands"""


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandMessage(Message):
    """What the controller asks of the actuators; controller to gate, at least at 10 Hz."""

    mode: Annotated[Mode, Cell("B")]
    """what the controller is about"""
    tractor_angle: Number
    """of the front wheels, rad"""
    trailer_angle: Number
    """of the joint between drawbar and trailer, rad, in the sign in which it is measured"""
    speed: Number
    """of the wheels, m/s"""

    def repeats(self, other: "CommandMessage") -> bool:
        """Return whether it asks for the same as another one."""
        return self == replace(other, sequence=self.sequence, time=self.time, valid_until=self.valid_until)


@dataclass(frozen=True, slots=True, kw_only=True)
class ControllerState(Message):
    """State of the controller, for the supervisor; controller to gate, at every step."""

    configuration: Count
    """fingerprint of the safety settings that the controller was started with"""
    tractor_quality: Byte
    """FixQuality of statuses.py, debounced"""
    trailer_quality: Byte
    """the same; the tractor's where the trailer has no receiver"""
    wiggled: Byte
    """1: the wiggle test of sign, gain and delay of the actuators has been passed"""
    status: Count
    """Status of statuses.py: how the last step ended"""
    flags: Count
    """Flag of statuses.py: remarks on it"""
    solved: Count
    """steps in a row up to now of which estimate and plans were solved"""
    overruns: Count
    """steps that came late, since the start"""
    correction_age: Known
    """of the older of both receivers' corrections, s"""
    lateral_deviation: Known
    """standard deviation across the line, the larger of both bodies', m"""
    heading_deviation: Known
    """standard deviation of the heading, the larger of both bodies', rad"""
    tractor_lateral_error: Known
    """m, left positive"""
    trailer_lateral_error: Known
    """m, left positive"""
    tractor_heading_error: Known
    """rad"""
    trailer_heading_error: Known
    """rad"""
    hitch_angle: Known
    """rad"""
    wheel_speed: Known
    """m/s, forward positive"""
    receiver_speed: Known
    """over ground, of the tractor's receiver, or of the trailer's while that reports none, m/s, forward positive"""
    line_offset: Number = 0.0
    """how far left of the configured line lies the one that is driven, m"""
    against: Byte = 0
    """1: it is driven against the configured line's direction"""
    notices: Codes = (0,) * 8
    """codes of notices about sensors, for the operator; 0: no more"""
