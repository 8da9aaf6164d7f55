"""Statuses, flags and verdicts: how a step, a solver, a fix and a command came out, each with its number and its text.

`signals/c_headers.py` prints them in C. This module imports nothing of numpy: the gate's process uses it too.
"""

from enum import IntEnum, IntFlag
from typing import Self


class Status(IntEnum):
    """What became of a control step; each status carries its text. Below REFUSED it is a set of flags (Flag)."""

    text: str

    def __new__(cls, value: int, text: str = "") -> Self:
        """Make a status of its number and its text."""
        status = int.__new__(cls, value)
        status._value_ = value
        status.text = text
        return status

    OK = 0, "done; of a step: with a new command"

    REFUSED = 64, "last command repeated: the new one is not finite or exceeds its limits"
    TIME = 65, "last command repeated: the time stamp is not finite or does not increase"
    POSITION = 66, "standing: the run cannot begin, an antenna's position is missing"
    START = 67, "standing: the run cannot begin, the tractor is too far from where it is to begin on the path"

    FINISHED = 128, "stopped: the tractor has reached the end of the path"
    OFF_COURSE = 129, "stopped: the tractor is too far from the path"
    BLIND = 130, "stopped: neither antenna has had a valid fix for too long"
    GUIDANCE = 131, "stopped: the estimate is not finite, or no turns lead back onto the path"
    GAP = 132, "stopped: samples were left out for longer than a command may be repeated"
    STOPPED = 133, "stopped: no command could be given for longer than one may be repeated"
    UNSOLVED = 134, "stopped: estimator or controllers have had no solution for too long"
    OVERDUE = 135, "stopped: samples came late for too long"
    RATE = 136, "stopped: samples come more often, or less often, than every sample_time"
    COARSE = 140, "stopped: positions have been coarse for too long"
    OSCILLATION = 141, "stopped: errors or steering swing from side to side"
    BACKWARDS = 142, "stopped: both antennas move backwards: they are swapped, or the vehicle is driven in reverse"
    STEERING = 143, "stopped: a steering does not follow its commands: sensor or actuator fails, or somebody steers"
    HITCH = 144, "stopped: the hitch angle contradicts the motion of both bodies"
    ROLL = (
        145,
        "stopped: a roll sensor contradicts the other angles or the swing of its antenna: it is reversed or stuck",
    )
    JUMPED = (
        146,
        "stopped: both positions have jumped: base station or solution changed, receivers swapped, or vehicle slides",
    )

    NULL = 256, "wrong call: a pointer is NULL"
    NOT_INITIALISED = 257, "wrong call: drawbar_init has not been called on this state"
    NO_PATH = 258, "wrong call: drawbar_set_path has not been called, or not with success"
    ORDER = (
        259,
        "wrong call: out of order: feedback and prepare alternate, and a run's start is set before it begins",
    )
    PATH = 260, "wrong call: the path's table is not a smooth path"
    RANGE = 261, "wrong call: a number is beyond what is allowed"
    NO_RUN = 262, "wrong call: no run has begun, or it has ended"
    ELSEWHERE = 263, "wrong call: the vehicle is not on the new path at that place, or faces away from it"
    UNALIGNED = 264, "wrong call: a pointer is not aligned as a double"
    ARITHMETIC = 265, "wrong build: NaN or sums are not IEEE's"

    @property
    def is_new_command(self) -> bool:
        """Whether the step made a new command."""
        return self < Status.REFUSED

    @property
    def has_ended(self) -> bool:
        """Whether the run has ended; the vehicle is stopped."""
        return Status.FINISHED <= self < Status.NULL


class Flag(IntFlag):
    """Remarks on a step that made a new command; each flag carries its text."""

    text: str

    def __new__(cls, value: int, text: str = "") -> Self:
        """Make a flag of its number and its text; a set of flags has none."""
        flag = int.__new__(cls, value)
        flag._value_ = value
        flag.text = text
        return flag

    MEASUREMENT = 1, "a measured value was infinite or beyond what its sensor can mean, and was taken for missing"
    LATE = 2, "one or more samples were left out"
    LIMITED = 4, "steering clamped where the valve is already fully open; the motion is unchanged"
    SOLVER = 8, "a solver failed; the estimate or the plan is its own prediction"
    SLOWED = 16, "the vehicle is driven slower than the set speed, until estimates and plans are sound again"
    RELEASED = 32, "not engaged: the command repeats the steering as it is, with speed zero"


class FixQuality(IntEnum):
    """How a receiver found a position."""

    UNKNOWN = 0
    """the receiver does not report it"""
    NONE = 1
    SINGLE = 2
    """without corrections"""
    DIFFERENTIAL = 3
    FLOAT = 4
    """RTK, ambiguities not resolved"""
    FIXED = 5
    """RTK, ambiguities resolved"""


class SolverStatus(IntEnum):
    """Outcome of a solver call; the C runtime returns the same numbers."""

    SOLVED = 0
    MAXIMUM_ITERATIONS = 1
    INFEASIBLE = 2
    NOT_FINITE = 3
    CHECK_FAILED = 4
    BAD_INPUT = 5


class FixStatus(IntEnum):
    """What an estimator made of one antenna's position fix."""

    ACCEPTED = 0
    MISSING = 1
    """the receiver reported none"""
    STALE = 2
    """the receiver repeated an old one while the vehicle moved"""
    REJECTED = 3
    """too far from the predicted position, or contradicted by the other antenna"""


class GateVerdict(IntEnum):
    """What the gate made of a command."""

    PASSED = 0
    LIMITED = 1
    """steering clamped where the valve is already fully open; the motion is unchanged"""
    REPEATED = 2
    """refused: the last one that passed was repeated"""
    STOPPED = 3
    """refused, and there was none to repeat, or none new enough: speed zero, steering held"""


class MonitorVerdict(IntEnum):
    """What the run monitor decided about a run."""

    ON_COURSE = 0
    OFF_COURSE = 1
    """the tractor is too far from the path, or its distance is not known"""
    BLIND = 2
    """neither antenna has had an accepted fix for too long"""


class GuidanceStatus(IntEnum):
    """How guidance went."""

    FINE = 0
    FAR_FROM_START = 1
    """the tractor is too far from where the run is to begin, or its position is missing"""
    POSE_NOT_FINITE = 2
    """a body's position or yaw is not finite"""
    SPEED_NOT_FINITE = 3
    NO_WAY = 4
    """the tractor faces away and no turns lead onto the path"""
