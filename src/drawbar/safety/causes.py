"""Causes: everything that stands against engaging or ends driving, each with code, sentence and what to do.

Codes are stable: they are what records, logs and operators' displays show. Not to be confused with `Status` of
statuses.py, which is how one control step ended.
"""

from enum import Enum, IntEnum
from typing import Self

from drawbar.protocols.actuator import Readiness


class Response(IntEnum):
    """What the supervisor does about a cause while driving, the worst last."""

    NONE = 0
    NOTIFY = 1
    """notify the operator, and drive on"""
    DEGRADE = 2
    """drive slower, for a limited time"""
    STOP = 3
    """stop the vehicle along its steering, then release it"""
    RELEASE = 4
    """release the steering at once, and stop"""


class Cause(Enum):
    """Why driving does not begin, or ends."""

    sentence: str
    advice: str
    refuses: bool
    """it stands against engaging"""
    response: Response
    """to it while driving"""

    def __new__(cls, code: int, refuses: bool, response: Response, sentence: str, advice: str) -> Self:
        """Make a cause of its code and all that belongs to it."""
        cause = object.__new__(cls)
        cause._value_ = code
        cause.refuses, cause.response, cause.sentence, cause.advice = refuses, response, sentence, advice
        return cause

    # fmt: off
    CONTROLLER_SILENT = (101, True, Response.RELEASE, "the controller's state is missing or old",
        "see whether both receivers report (drawbar check); if so, look at the controller's messages")
    COMMAND_EXPIRED = (102, True, Response.RELEASE, "the controller's last command has expired",
        "look at the controller's own messages; it may be computing too slowly")
    COMMAND_REFUSED = (103, True, Response.RELEASE, "a record of the controller was refused",
        "this is a fault of the program: keep the log and report it")
    COMMAND_LIMITED = (104, False, Response.STOP, "the controller asked for too much again and again",
        "drive slower, or see whether limits of vehicle and envelope agree")
    MODE = (105, True, Response.RELEASE, "controller and gate disagree about whether a run is on",
        "wait until the controller has ended its run; else start it again")
    CONFIGURATION = (106, True, Response.RELEASE, "the controller has other safety settings, or they are not known",
        "if the controller reports, start both again with the same configuration")
    UNPROVED = (107, True, Response.NONE, "estimator and controllers have not solved enough steps in a row",
        "wait a few seconds; if it stays, see the log")
    UNSOLVED = (108, False, Response.DEGRADE, "the last step was not solved",
        "nothing to do; the vehicle stops if it stays")
    OVERRUN = (109, True, Response.NONE, "a step came late in the last seconds",
        "wait; if it stays, end other programs or lower the rate")
    OVERRUNS = (110, True, Response.DEGRADE, "several steps came late in the last seconds",
        "end other programs or lower the rate")
    CONTROLLER_STOPS = (111, True, Response.STOP, "the controller has ended its run",
        "see its status: the line has ended, or it cannot continue")
    CONTROLLER_GONE = (112, True, Response.RELEASE, "the controller's process has ended",
        "see its last messages; start drawbar again")

    FIX_TOO_NEW = (201, True, Response.NONE, "the receivers have not had an RTK fix for long enough",
        "wait under open sky; check the corrections")
    FIX_LOST = (202, True, Response.DEGRADE, "a receiver has no RTK fix",
        "wait under open sky; check the corrections")
    CORRECTIONS_OLD = (203, True, Response.NONE, "the corrections are old, or their age is not known",
        "check modem, caster and mount point")
    CORRECTIONS_LOST = (204, True, Response.DEGRADE, "corrections have been missing for long, or have no age",
        "check modem, caster and mount point")
    POSITION_UNSURE = (205, True, Response.DEGRADE, "the position across the line is not certain enough",
        "wait for a better fix")
    POSITION_LOST = (206, True, Response.STOP, "the position across the line is no longer known well enough",
        "wait for a better fix; where that is good, check the sensors of hitch and joint")
    HEADING_UNSURE = (207, True, Response.DEGRADE, "the heading is not certain enough",
        "drive two or three metres straight ahead")
    OFF_LINE = (208, True, Response.NONE, "a body is too far from the line, or its distance is not known",
        "drive slowly along the line, close to it")
    LINE_LOST = (209, True, Response.STOP, "a body has left the line",
        "drive back to the line")
    ACROSS_LINE = (210, True, Response.NONE, "a body does not point along the line, or its direction is not known",
        "turn into the line's direction; if both bodies do, the two receivers are swapped")
    HITCH_ANGLE = (211, True, Response.NONE, "the hitch angle is too large, or not known",
        "pull tractor and trailer straighter")
    HITCH_FOLDED = (212, True, Response.RELEASE, "a jackknife is near, or the hitch angle is not known",
        "pull tractor and trailer straight by hand")
    RECEIVERS_SWAPPED = (213, True, Response.STOP, "the trailer's antenna moves ahead of the tractor's",
        "drive forwards; if you do, the two receivers are swapped: exchange them in [devices]")
    SENSORS_LOST = (214, True, Response.STOP, "neither an RTK fix nor any speed is received",
        "check the receivers and the sensor board")
    # faults of sensors, found by the controller (driving/fault_detection/notices.py); the gate decides without them
    RECEIVER_SILENT = (215, False, Response.NOTIFY, "nothing is received from a receiver",
        "check its power and its cable; run drawbar check")
    SENSOR_SILENT = (216, False, Response.NOTIFY, "the hitch angle or the wheels' speed is not received any more",
        "check power and cables of the sensor board and its sensors")
    POSITIONS_JUMPED = (217, False, Response.NOTIFY, "both antennas' positions have jumped, and are left out",
        "wait until the positions are right again; check base station and mount point")
    POSITIONS_DRIFT = (218, False, Response.NOTIFY, "the positions drift aside of the receivers' velocities",
        "compare them with a place that is known; check base station and mount point")
    POSITION_REJECTED = (219, True, Response.NOTIFY, "an antenna's position contradicts the motion, and is rejected",
        "see whether its mast and cable are firm and its sky is open")
    TRAILER_CONTRADICTS = (220, False, Response.NOTIFY, "the angles of hitch and joint contradict the motion",
        "check both sensors, their linkages and cables, then calibrate them again")
    YAW_REJECTED = (221, False, Response.NOTIFY, "the tractor's yaw or yaw rate contradicts the motion",
        "check how its antennas or its inertial sensor are mounted and wired")
    ANTENNA_DISTANCE = (222, True, Response.NOTIFY, "both antennas are not as far apart as lengths and angles say",
        "give both receivers the same corrections, else check lengths, places of the antennas and the hitch sensor; "
        "then start drawbar again")
    RECEIVER_TIMES = (223, False, Response.NOTIFY, "the receivers' epochs are never of the same time",
        "let both run until they know UTC and its leap seconds, up to 13 minutes; drawbar check tells the difference")
    YAW_CHANGED = (224, False, Response.NOTIFY, "the two antennas' heading has turned against positions and angles",
        "see whether both antennas and the sensors of hitch and joint are firm, then calibrate them again")
    ANGLE_SCALE = (225, False, Response.NOTIFY, "the sensor of hitch or joint shows a tenth too much or too little",
        "calibrate both sensors; drawbar identify tells by how much the angles are corrected meanwhile")
    FIELD_EDGE = (226, True, Response.STOP, "the field's boundary is just ahead, or has been crossed",
        "drive back into the field; path.beyond_boundary says how far drawbar may steer beyond it")
    OUTSIDE_TUBE = (227, False, Response.DEGRADE, "a body is farther from its plan than noise and ground explain",
        "see what pushes or slows it; else compare the vehicle's lengths, limits and delays with the machine")
    TUBE_LOST = (228, False, Response.STOP, "a body has been outside its tube for 2 s, which nothing ordinary explains",
        "compare the vehicle's lengths, limits and delays with the machine; drawbar tube --from-log helps")

    TOO_SLOW = (301, True, Response.NONE, "the vehicle stands or is too slow",
        "begin to drive, then engage")
    TOO_FAST = (302, True, Response.STOP, "the vehicle is too fast",
        "drive slower")
    SPEED_UNKNOWN = (303, True, Response.DEGRADE, "the speed is missing or old, or its sources disagree",
        "check the wheel sensor and the receiver")
    NOT_STANDING = (304, False, Response.NONE, "the vehicle moves, or its speed is not known",
        "stop the vehicle, then acknowledge")
    STOP_IGNORED = (305, False, Response.NONE, "the vehicle did not stop in time, or its speed is not known",
        "brake; look at the speed actuator before you drive again")
    SPEEDS_CONTRADICT = (306, True, Response.STOP, "wheels and receiver differ in speed by more than wheels slip",
        "check the units of the receiver's speed and the pulses per metre of the wheel sensor")

    STEERING_OLD = (402, True, Response.STOP, "a measured steering angle is missing or old",
        "check the sensor and the actuator's cable")
    STEERING_LOST = (403, True, Response.RELEASE, "a measured steering angle has been missing for too long",
        "check the sensor and the actuator's cable")
    STEERING_APART = (404, True, Response.NONE, "a steering is not where the controller would begin",
        "turn the wheels towards where the line leads")
    STEERING_STUCK = (405, False, Response.RELEASE, "a steering does not follow its set point",
        "check valve, motor and sensor; run drawbar check")
    STEERING_REVERSED = (406, False, Response.RELEASE, "a steering moves away from its set point",
        "check the signs of actuator and sensor; run drawbar check")
    ACTUATOR_RELEASED = (407, False, Response.RELEASE, "an actuator has released the steering by itself",
        "see the machine's own display for its reason")
    NOT_TAKEN = (408, False, Response.RELEASE, "actuators or controller did not take over in time",
        "see the machine's own display; engage again")
    STEERING_JUMPED = (409, False, Response.RELEASE, "a measured steering angle has jumped",
        "check the sensor's linkage and cable, then calibrate it again")
    STEERING_MIRRORED = (410, True, Response.RELEASE, "the tractor turns the other way than its wheels are measured",
        "sensor and motor are both the wrong way round: change both signs, then run drawbar check --wiggle")
    SILENT = (411, True, Response.RELEASE, "an actuator reports nothing",
        "check its power, its cable and its address")
    TOO_NEW = (412, True, Response.RELEASE, "an actuator came up, or was released, less than a second ago",
        "wait; if it came up again by itself, check its power")
    SWITCHED_ON = (413, True, Response.NONE, "an actuator already steers, or its switch is on",
        "turn it off")
    OVERRIDDEN = (414, True, Response.NONE, "the operator has taken over at an actuator",
        "engage again when ready")
    LOCKED_OUT = (415, True, Response.RELEASE, "an actuator is locked out",
        "see the machine's own display")
    NOT_READY = (416, True, Response.RELEASE, "an actuator reports that it is not ready",
        "see the machine's own display")
    OTHER_MASTER = (417, True, Response.RELEASE, "another program commands an actuator too",
        "stop that program")
    ADDRESS_LOST = (418, True, Response.RELEASE, "drawbar has no address on the bus",
        "see who else claims it")
    ACTUATOR_FAULT = (419, True, Response.RELEASE, "an actuator reports a fault",
        "see the machine's own display, and run drawbar check")
    SHADOW = (420, True, Response.RELEASE, "drawbar only looks on",
        "start it without --shadow")
    STEERING_CONTRADICTS = (421, True, Response.RELEASE, "the tractor does not turn as its wheels are measured",
        "check the sensor of the front wheels, its linkage, cable and sign, then calibrate it again")

    GATE_LATE = (501, True, Response.RELEASE, "the gate itself came late",
        "end other programs; allow real-time scheduling")
    SUSPENDED = (502, True, Response.RELEASE, "the computer was suspended",
        "forbid it to sleep; start drawbar again")
    SELFTEST = (503, False, Response.NONE, "the gate's own limits failed their test",
        "do not drive: reinstall drawbar and report it")
    NOT_SENT = (504, True, Response.RELEASE, "a frame to an actuator could not be sent",
        "check adapter, cable and network")
    ENDED = (505, True, Response.RELEASE, "the gate was told to end",
        "start drawbar again")
    DEVICE = (506, True, Response.RELEASE, "the program of an actuator failed",
        "keep the log and report it")

    NO_OPERATOR = (601, True, Response.STOP, "no operator is present",
        "open the console, or start the keyboard again")
    NOT_RECORDING = (602, True, Response.NOTIFY,
        "nothing is recorded: the disk is full, too slow or gone, or the recorder has ended",
        "steering continues; stop when it suits, make room on the disk, start drawbar again")
    EMERGENCY_UNTRIED = (603, True, Response.NONE, "the emergency stop has not been tried since the start",
        "stand, press the emergency stop, then acknowledge")
    WIGGLE_UNTRIED = (604, True, Response.NONE, "the actuators' signs and gains have not been tried",
        "run drawbar check --wiggle")
    BUDGET = (605, False, Response.NONE, "it has been driven degraded for as long as allowed",
        "see what degraded it; engage again when it is gone")
    OPERATOR_STEERS = (606, False, Response.NONE, "the operator took over",
        "acknowledge, then engage again when ready; where nobody did, the actuator has restarted: check its power")
    OPERATOR_STOPS = (607, False, Response.NONE, "the operator asked for a stop",
        "acknowledge when standing")
    OPERATOR_RELEASES = (608, False, Response.NONE, "the operator asked to release the steering",
        "engage again when ready")
    EMERGENCY = (609, False, Response.NONE, "the operator asked for an emergency stop",
        "acknowledge when standing")
    NOT_GUARDED = (610, True, Response.NOTIFY, "the guard, which releases the boards where the gate cannot, is silent",
        "steering continues; stop when it suits, end other programs, start drawbar again")
    LEASE_HELD = (621, False, Response.NONE, "another operator has control",
        "wait until that one gives it up, or falls silent")
    NOT_ARMED = (622, False, Response.NONE, "engaging is not prepared, or no longer",
        "prepare, then engage within a few seconds")
    STATE_NOT_READY = (623, False, Response.NONE, "it is not ready to engage",
        "see what stands against it; acknowledge a state that waits for it")
    SEEN_OLD = (624, False, Response.NONE, "what the operator saw is too old",
        "look again, then repeat")
    REPLAYED = (625, False, Response.NONE, "the message is old or has been received before",
        "send each message once")
    OUT_OF_RANGE = (626, False, Response.NONE, "the value is beyond what is allowed",
        "see docs/safety.md for the limits")
    NOTHING_TO_ACKNOWLEDGE = (627, False, Response.NONE, "there is nothing to acknowledge",
        "nothing to do")
    STEERED = (628, False, Response.NONE, "the vehicle is steered",
        "to engage again or to choose the line, stop first")
    # fmt: on


BY_CODE: dict[int, Cause] = {cause.value: cause for cause in Cause}
"""causes by the codes that records carry"""
BY_READINESS = {
    Readiness.SILENT: Cause.SILENT,
    Readiness.TOO_NEW: Cause.TOO_NEW,
    Readiness.SWITCHED_ON: Cause.SWITCHED_ON,
    Readiness.OVERRIDDEN: Cause.OVERRIDDEN,
    Readiness.LOCKED_OUT: Cause.LOCKED_OUT,
    Readiness.NOT_READY: Cause.NOT_READY,
    Readiness.OTHER_MASTER: Cause.OTHER_MASTER,
    Readiness.ADDRESS_LOST: Cause.ADDRESS_LOST,
    Readiness.FAULT: Cause.ACTUATOR_FAULT,
    Readiness.SHADOW: Cause.SHADOW,
}
"""what an actuator that is not ready reports, as a cause"""
