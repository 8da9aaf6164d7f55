"""Settings of the supervisor and of the gate's process: conditions of engaging, and how long each fault may last.

They are read and checked before the gate starts, and do not change while it runs.
"""

import math
import zlib
from typing import Annotated

from pydantic import Field

from drawbar.settings import NonNegative, Positive, PositiveAngle, Settings, Share

Timeout = Annotated[float, Field(gt=0.0, le=60.0)]
"""s"""
Steps = Annotated[int, Field(ge=1, le=1000)]


class EngageSettings(Settings):
    """What must hold before the operator may engage."""

    hold: Timeout = 2.0
    """for how long all conditions must have held, s"""
    arming: Timeout = 5.0
    """time from arming within which to engage, s"""
    seen: Timeout = 1.0
    """oldest state of the gate that an operator may have seen when asking for something, s"""
    fixed: Annotated[float, Field(ge=0.0, le=600.0)] = 10.0
    """for how long both receivers must have had an RTK fix, lost epochs of less than 0.5 s not counted, s"""
    correction_age: Positive = 5.0
    """largest, s"""
    lateral_deviation: Positive = 0.07
    """largest standard deviation across the line, m"""
    heading_deviation: PositiveAngle = math.radians(3.0)
    """largest standard deviation of the heading, rad"""
    lateral_error: Positive = 1.0
    """farthest of either body from the line, m"""
    heading_error: PositiveAngle = math.radians(30.0)
    """of either body from the line's direction, rad"""
    speed: NonNegative = 0.1
    """slowest, m/s; with a speed actuator the vehicle may stand"""
    steering_error: PositiveAngle = math.radians(2.0)
    """largest difference of a measured steering angle from the controller's first command, rad"""
    hitch_angle: PositiveAngle = math.radians(45.0)
    """largest, rad"""
    solved: Steps = 20
    """steps in a row that estimator and controllers must have solved"""
    quiet: Timeout = 5.0
    """time without a late step, s"""
    clean: Timeout = 2.0
    """time without a refused command, a late tick of the gate or a frame that was not sent, s"""
    emergency_test: bool = True
    """the operator must have tried the emergency stop since the gate started"""
    wiggle_test: bool = True
    """sign, gain and delay of the actuators must have been tried (`drawbar check --wiggle`)"""
    recorder: bool = True
    """the recorder must be alive and writing"""


class DriveSettings(Settings):
    """What may be wrong while driving, how much and for how long."""

    engaging: Timeout = 3.0
    """time within which the actuators must take over, s"""
    easing: Timeout = 1.0
    """time after engaging for which rates and distances of commands are halved, s"""
    budget: Timeout = 10.0
    """time for which the vehicle may be driven degraded, s"""
    recovery: Timeout = 2.0
    """time without a cause to degrade, after which it is no longer degraded, s"""
    degraded_speed: Share = 0.5
    """share of its speed at which the vehicle is driven degraded"""
    stopping: Timeout = 10.0
    """time within which the vehicle must stand; then the steering is released if any condition asks for a stop, s"""
    abandoning: Timeout = 30.0
    """time after which the steering of a vehicle that does not stand is released whatever else is so, s"""
    comfort: Timeout = 5.0
    """time after which a vehicle that does not stand is asked to stop as fast as possible, s"""
    deceleration: Positive = 1.0
    """of a stop, m/s²"""
    emergency_deceleration: Positive = 2.5
    """of a stop as fast as possible, m/s²"""
    standing: Positive = 0.05
    """speed below which the vehicle stands, m/s"""
    stood: Timeout = 0.5
    """for how long it must be below it, s"""
    correction_age: Positive = 20.0
    """oldest corrections with which to continue undegraded, s"""
    lateral_deviation: Positive = 0.08
    """standard deviation across the line at which to stop, m"""
    lateral_error: Positive = 1.5
    """distance of either body from the line at which to stop, on the way onto it, m"""
    leaving: Positive = 0.4
    """the same once both have been within 0.1 m of it, m: the vehicle does not follow"""
    hitch_angle: PositiveAngle = math.radians(60.0)
    """at which to release the steering, rad"""
    overruns: Steps = 3
    """late steps within `engage.quiet` that degrade"""
    operator: Timeout = 2.0
    """time without a message of an operator after which to stop, s"""
    stuck_angle: PositiveAngle = math.radians(3.5)
    """distance from its set point at which a steering must move, rad"""
    stuck_move: PositiveAngle = math.radians(0.5)
    """least by which it must then move, rad"""
    stuck_time: Timeout = 0.6
    """within this time, s"""
    reversed_angle: PositiveAngle = math.radians(2.5)
    """by which a steering may move away from its set point, rad"""
    reversed_time: Timeout = 0.3
    """within this time, s"""
    jump_rate: PositiveAngle = math.radians(25.0)
    """fastest that a measured angle can turn, rad/s"""
    jump_angle: PositiveAngle = math.radians(1.5)
    """by which it may be further from one reading to the next, rad; more is a sensor that has slipped"""


class EnvelopeSettings(Settings):
    """What a command may be, whatever the controller thinks."""

    speed: Positive = 4.2
    """fastest that this machine is driven, m/s"""
    acceleration: Positive = 1.5
    """hardest that it speeds up, m/s²; bounds the speed while that is not known"""
    lateral_acceleration: Positive = 1.5
    """largest, m/s²; bounds the front wheels' angle by speed"""
    lateral_jerk: Positive = 2.0
    """largest, m/s³; bounds the front wheels' rate by speed"""
    steering_rate: PositiveAngle = math.radians(25.0)
    """fastest lasting change of a steering's set point, rad/s"""
    steering_lead: Timeout = 0.8
    """by which a set point may lead what changes at that rate, s: lag and delay, time between commands"""
    steering_reach: PositiveAngle = math.radians(15.0)
    """farthest of a set point from the measured angle, rad"""
    clips: Steps = 5
    """commands in a row that were limited, at which to stop"""
    flood: Steps = 16
    """most records that the controller may send within one tick"""


class TimingSettings(Settings):
    """How old what the gate lives on may be, and its own time."""

    tick: Annotated[float, Field(ge=0.025, le=0.1)] = 0.05
    """between two ticks of the gate, s; AgOpenGPS boards obey no more than 40 frames a second"""
    command: Annotated[float, Field(gt=0.0, le=0.5)] = 0.2
    """oldest command that is obeyed, s"""
    controller: Timeout = 0.5
    """oldest state of the controller, s"""
    speed: Timeout = 0.5
    """oldest speed, s"""
    speed_difference: Positive = 0.5
    """of wheels and receiver, on a weighted mean of their last three, above which neither is used, m/s"""
    speed_samples: Steps = 6
    """of each source of speed whose largest counts"""
    speed_ratio: Annotated[float, Field(gt=1.0, le=5.0)] = 1.5
    """of wheels and receiver, each the mean of these samples, above which one of them is wrong; slip makes less"""
    fix: Timeout = 0.5
    """for which a receiver's RTK fix may be missing while driving; along trees it flips, s"""
    angle: Timeout = 0.2
    """oldest measured steering angle, s"""
    angle_lost: Timeout = 0.5
    """age of a measured steering angle at which to release the steering, s"""
    recorder: Timeout = 1.0
    """oldest heartbeat of the recorder, s"""
    guard: Timeout = 1.0
    """oldest heartbeat of the guard, which releases the boards where the gate falls silent, s"""
    late: Timeout = 0.14
    """by which a tick of the gate may come late, s"""
    suspended: Timeout = 0.5
    """for which the computer may have been suspended, s"""
    off: Annotated[float, Field(ge=1.0, le=10.0)] = 1.0
    """for how long the actuators are commanded to release before the gate ends, and before it engages them, s"""
    lease: Timeout = 2.0
    """without a message of its holder, after which another operator may engage, s"""
    priority: Annotated[int, Field(ge=0, le=99)] = 50
    """of the gate's real-time scheduling, above the controller's (10 less) and the receivers' (15 less); 0: none"""


class SafetySettings(Settings):
    """All that the supervisor and the gate's process go by."""

    engage: EngageSettings = EngageSettings()
    drive: DriveSettings = DriveSettings()
    envelope: EnvelopeSettings = EnvelopeSettings()
    timing: TimingSettings = TimingSettings()
    nudge: NonNegative = 0.30
    """largest shift of the line by the operator, m"""

    def fingerprint(self) -> int:
        """Return a number of these settings by which two processes check that they hold the same."""
        return zlib.crc32(self.model_dump_json().encode())
