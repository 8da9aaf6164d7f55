"""Messages between the processes of `drawbar drive` (docs/messages.md); `message_records.py` makes bytes of them.

Times are the machine's monotonic clock in ns, the same in all of its processes; angles in rad, left positive.
"""

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated

from drawbar.message_fields import Byte, Cell, Codes, Count, Known, Long, Number, Signed, Time


class Kind(IntEnum):
    """What a record is."""

    COMMAND = 1
    CONTROLLER_STATE = 2
    GATE_STATE = 3
    OPERATOR = 4
    HEARTBEAT = 5
    FIXES = 6


class Mode(IntEnum):
    """What the controller is about."""

    IDLE = 0
    """it computes, but no run has begun; its command is what it would begin with"""
    DRIVE = 1
    """a run is on"""
    STOP = 2
    """the run has ended; the vehicle is to stop along the steering of these commands"""


class SupervisorState(IntEnum):
    """Where the supervisor is (docs/safety.md)."""

    BOOT = 0
    """before the first update"""
    SELFTEST = 1
    """the gate tests itself, its connections and its settings"""
    STANDBY = 2
    """a condition of engaging is not met"""
    READY = 3
    """all conditions are met: the operator may engage"""
    ENGAGING = 4
    """it steers as soon as actuators and controller have taken over; rates and distances are halved"""
    ACTIVE = 5
    """it steers"""
    DEGRADED = 6
    """it steers, slower and for a limited time: see its cause"""
    STOPPING = 7
    """it steers until the vehicle stands"""
    STOPPED = 8
    """released after a stop; waits for the acknowledgement"""
    OVERRIDE = 9
    """released: the operator has taken over at an actuator; waits for the acknowledgement"""
    FAULT = 10
    """released at once for a cause; waits for the acknowledgement"""
    ESTOP = 11
    """released by an emergency stop; waits for the acknowledgement"""


class Action(IntEnum):
    """What an operator asks for."""

    PRESENT = 0
    """nothing: the operator is there, and sees the gate's states; the first one subscribes its sender to them"""
    ARM = 1
    """first half of engaging, and takes the lease"""
    ENGAGE = 2
    """second half, within a few seconds"""
    RELEASE = 3
    """release the steering; accepted from everybody"""
    STOP = 4
    """stop the vehicle, then release the steering; accepted from everybody"""
    EMERGENCY = 5
    """release the steering and stop as fast as possible; accepted from everybody"""
    ACKNOWLEDGE = 6
    """leave a state that waits for the operator"""
    NUDGE = 7
    """move the line by `value`, m, to the left of the configured line's direction"""
    SET_SPEED = 8
    """drive at `value`, m/s"""
    LINE = 9
    """drive the line so many working widths to the left of the configured one as `value`, a whole number; while
    the vehicle is not steered. Takes the lease"""


class Role(IntEnum):
    """Which process a heartbeat is of."""

    RECEIVERS = 0
    """reads the receivers and sensors"""
    CONTROLLER = 1
    """estimates and plans"""
    RECORDER = 2
    """writes the log"""
    FRONT_END = 3
    """shows the drive to an operator"""
    GUARD = 4
    """releases the boards where the gate falls silent"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Message:
    """What every record begins with."""

    sequence: Count = 0
    """one more than in the sender's last record of this kind, modulo 2³²"""
    time: Time
    """of sending, ns"""
    valid_until: Time
    """ns; later the record means nothing"""


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
    """of the tractor's receiver, m/s, forward positive"""
    line_offset: Number = 0.0
    """how far left of the configured line lies the one that is driven, m"""
    against: Byte = 0
    """1: it is driven against the configured line's direction"""
    notices: Codes = (0,) * 8
    """codes of notices about sensors, for the operator; 0: no more"""


@dataclass(frozen=True, slots=True, kw_only=True)
class GateState(Message):
    """What the gate does; gate to controller, recorder and front ends, at each of its ticks."""

    state: Annotated[SupervisorState, Cell("B")]
    """of the supervisor"""
    steers: Byte
    """1: the gate asks the actuators to steer"""
    engaged: Byte
    """which actuators report that they steer or drive; 1 tractor, 2 trailer, 4 speed"""
    stop: Byte
    """1: the vehicle is asked to stop; 2: as fast as possible. Without a speed actuator: the driver is to stop it"""
    armed: Byte
    """1: the operator may engage now"""
    cause: Annotated[int, Cell("H")]
    """code of what led to this state; 0: nothing"""
    answer: Annotated[int, Cell("H")]
    """to the last operator's message: 0 accepted, else the code of why not"""
    answered: Long
    """nonce of that message"""
    lease: Long
    """who may engage; 0: nobody yet"""
    since: Time
    """when this state was entered, ns"""
    refusals: Codes
    """codes of what stands against engaging, or of causes while driving, the first eight; 0: no more"""
    remaining: Known
    """until this state is left by itself, s; NaN: it is not"""
    tractor_angle: Known
    """measured, rad"""
    tractor_angle_time: Time
    """when it was received, ns; 0: never"""
    trailer_angle: Known
    """measured, rad"""
    trailer_angle_time: Time
    """when it was received, ns; 0: never"""
    tractor_set_point: Known
    """given to the actuator, rad; NaN: none"""
    trailer_set_point: Known
    """given to the actuator, rad; NaN: none"""
    speed_limit: Number
    """fastest that the gate lets the vehicle drive now, m/s"""
    set_speed: Known
    """the operator's wish, m/s; NaN: none"""
    nudge: Number
    """the operator's shift of the line, m, to the left of the configured line's direction"""
    clips: Count
    """commands that were limited, since the start"""
    rejects: Count
    """commands that were refused, since the start"""
    dropped: Count
    """other records and frames that were refused, since the start"""
    line: Signed = 0
    """the operator's choice of the line: so many working widths to the left of the configured one"""


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatorMessage(Message):
    """What an operator wants; front end to gate, one per datagram. All but PRESENT go to the recorder too."""

    action: Annotated[Action, Cell("B")]
    """what is asked for"""
    lease: Long
    """random number of this front end's session, not 0"""
    nonce: Long
    """larger than in any earlier message of this session"""
    seen_sequence: Count
    """of the gate's state that the operator sees"""
    seen_time: Time
    """of the gate's state that the operator sees, ns"""
    value: Number = 0.0
    """of NUDGE, SET_SPEED and LINE"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Heartbeat(Message):
    """A process is alive; at least at 4 Hz, to the gate's Unix socket."""

    role: Annotated[Role, Cell("B")]
    """which process this is of"""
    healthy: Byte
    """1: it does all that it is there for; the recorder: what it writes reaches the disk"""
    state: Annotated[SupervisorState, Cell("B")]
    """of the gate, as this process received it last"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixes(Message):
    """What the receivers of both bodies report for one instant; receivers to controller, one for each epoch.

    Positions are those of the antennas, in the frame of the path. A receiver that reports nothing has no fix, and NaN.
    Where none reports anything, the sensor board's reports come by themselves.
    """

    epoch: Time
    """instant of the measurement, ns; of the sensor board's report, where it comes by itself"""
    first_byte: Time
    """when the first byte of this epoch was there, ns"""
    hitch_angle: Known
    """tractor yaw minus drawbar yaw, rad"""
    hitch_angle_time: Time
    """when it was measured, ns; 0: never"""
    wheel_speed: Known
    """m/s, forward positive"""
    wheel_speed_time: Time
    """when it was measured, ns; 0: never"""
    tractor_heard: Byte = 1
    """0: its receiver reports nothing for this instant"""
    tractor_x: Known
    """east, m"""
    tractor_y: Known
    """north, m"""
    tractor_deviation: Known
    """standard deviation of each coordinate, m"""
    tractor_quality: Byte
    """FixQuality of statuses.py, debounced"""
    tractor_speed: Known
    """over ground, m/s, never negative"""
    tractor_course: Known
    """yaw of the velocity, rad"""
    tractor_roll: Known
    """right side down positive, rad"""
    tractor_pitch: Known
    """nose up positive, rad"""
    tractor_yaw: Known = math.nan
    """of the body, by two antennas on it, rad"""
    tractor_yaw_rate: Known = math.nan
    """counter-clockwise, rad/s"""
    tractor_attitude_time: Time = 0
    """when roll, pitch, yaw and yaw rate were measured, ns; 0: never"""
    tractor_correction_age: Known
    """s"""
    tractor_satellites: Byte = 0
    """in use; 0: not known"""
    trailer_heard: Byte = 1
    """0: its receiver reports nothing for this instant, or there is none"""
    trailer_x: Known
    """east, m"""
    trailer_y: Known
    """north, m"""
    trailer_deviation: Known
    """standard deviation of each coordinate, m"""
    trailer_quality: Byte
    """FixQuality of statuses.py, debounced"""
    trailer_speed: Known
    """over ground, m/s, never negative"""
    trailer_course: Known
    """yaw of the velocity, rad"""
    trailer_roll: Known
    """right side down positive, rad"""
    trailer_pitch: Known
    """nose up positive, rad"""
    trailer_yaw_rate: Known = math.nan
    """counter-clockwise, rad/s"""
    trailer_attitude_time: Time = 0
    """when roll, pitch and yaw rate were measured, ns; 0: never"""
    trailer_correction_age: Known
    """s"""
    trailer_satellites: Byte = 0
    """in use; 0: not known"""


KINDS: dict[Kind, type[Message]] = {
    Kind.COMMAND: CommandMessage,
    Kind.CONTROLLER_STATE: ControllerState,
    Kind.GATE_STATE: GateState,
    Kind.OPERATOR: OperatorMessage,
    Kind.HEARTBEAT: Heartbeat,
    Kind.FIXES: Fixes,
}
