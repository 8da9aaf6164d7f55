"""The gate of a real machine: once a tick it reads all messages, decides, and commands the actuators.

Whatever goes wrong, the actuators are sent an explicit disengage, never silence. It runs in a process of its own
(gate_process.py), without numpy. It is not `gate.h`, the last part of the control step, whose commands it distrusts.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from drawbar.messages import Action, CommandMessage, ControllerState, Heartbeat, Mode, OperatorMessage
from drawbar.messages.records import Flaw, decode, encode
from drawbar.protocols.actuator import SteeringReport, SteeringRequest
from drawbar.protocols.speed_actuator import SpeedReport, SpeedRequest
from drawbar.realtime import suspended_time
from drawbar.safety.causes import Cause
from drawbar.safety.channels import ControllerChannel, OperatorChannel
from drawbar.safety.conditions import present
from drawbar.safety.engagement import DEGRADED, STOPPING, Engagement, Situation
from drawbar.safety.envelope import Bounds, Envelope
from drawbar.safety.following import Following
from drawbar.safety.gate_report import Actuation, Counts, Tick, gate_state
from drawbar.safety.operator_requests import OperatorRequests
from drawbar.safety.selftest import limits_hold
from drawbar.safety.settings import SafetySettings
from drawbar.safety.watch import Watch
from drawbar.safety.wires import Wire, Wires

MOST = 64
"""operators' datagrams taken at one look"""
URGENT = frozenset({Action.RELEASE, Action.STOP, Action.EMERGENCY})
"""actions that do not wait for the next tick"""


class Gate:
    """All of the gate but its process: `receive` takes the monotonic clock, `tick` its time, s."""

    def __init__(
        self,
        settings: SafetySettings,
        bounds: Bounds,
        wires: Sequence[Wire],
        controller: ControllerChannel,
        operators: OperatorChannel,
    ) -> None:
        """Begin in BOOT, with nothing received; the first tick commands the actuators to release."""
        self._settings = settings
        self.wires, self.controller, self.channel = Wires(wires), controller, operators
        self.engagement = Engagement(settings, sound=limits_hold(settings, bounds))
        self.watch = Watch(settings, drives=self.wires.drives)
        self._requests = OperatorRequests(settings, self.engagement)
        self._envelope = Envelope(settings, bounds)
        self._followings = (Following(settings.drive), Following(settings.drive))
        self._taken: set[int] = set()  # actuators that have reported steering since they were asked to
        self._speed = self._degraded_speed = 0.0
        self._counts, self._clips_in_a_row = Counts(), 0
        self._suspended_before = suspended_time()

    def receive(self, clock: Callable[[], float]) -> bool:
        """Take in all that has arrived; return whether to tick before it is due: a new command does not wait.

        The clock is read after each channel: what is sent while this process waits for a processor is not of the
        future.
        """
        self.wires.receive()
        urgent = self._receive_controller(clock) | self._receive_operators(clock)
        return self.engagement.steers and (urgent or not self.watch.command_valid(clock()))

    def _receive_controller(self, clock: Callable[[], float]) -> bool:
        most, refused, commanded = self._settings.envelope.flood, 0, False
        records, now = self.controller.receive(most + 1), clock()
        for record in records[:most]:
            message = decode(record, CommandMessage, ControllerState)
            if isinstance(message, CommandMessage) and self._envelope.repeats(message):
                self._counts.dropped += 1
            elif isinstance(message, CommandMessage) and self._envelope.admit(message, now):
                commanded |= self.watch.command is None or not message.repeats(self.watch.command)
                self._obey(now, message)
            elif isinstance(message, ControllerState):
                self.watch.receive_controller(now, message)
            else:
                refused += 1
        refused += len(records) > most
        if refused:
            self.watch.troubles.refused = now
            self._counts.rejects += refused
        self.watch.troubles.gone |= self.controller.gone
        return self.controller.gone or refused > 0 or commanded

    def _obey(self, now: float, command: CommandMessage) -> None:
        """Put an admitted command through the envelope; before a run has begun the result is only shown."""
        self.watch.command = command
        if not self.engagement.steers or command.mode is Mode.IDLE:
            return
        eased, angles = self.engagement.eases(now), self._actuation(now).angles
        limited = self._envelope.limit(command, angles, self.watch.speeds.largest(now), eased=eased)
        self._speed = limited.speed
        self._counts.clips += limited.clipped
        # while it is eased a command is limited because that is what easing is
        self._clips_in_a_row = self._clips_in_a_row + 1 if limited.clipped and not eased else 0

    def _receive_operators(self, clock: Callable[[], float]) -> bool:
        urgent, records, now = False, self.channel.receive(MOST), clock()
        for record, sender in records:
            message = decode(record, OperatorMessage, Heartbeat)
            if isinstance(message, OperatorMessage):
                self.channel.subscribe(sender)
                self._requests.receive(now, message)
                urgent |= message.action in URGENT
            elif isinstance(message, Heartbeat):
                self.watch.receive_heartbeat(now, message)
            self._counts.dropped += isinstance(message, Flaw)
        return urgent

    def tick(self, now: float, late: float) -> None:
        """Decide what is to be done now, and command it; `late` by s after it was due."""
        self._look_at_oneself(now, late)
        actuation, before = self._actuation(now), self.engagement.state
        self._ask_switches(actuation)
        causes = self._causes(now, actuation)
        if not self.engagement.steers:
            self._prepare(now, actuation)
        self.engagement.update(now, self._situation(now, causes, actuation))
        if self.engagement.state is DEGRADED and before is not DEGRADED:
            self._degraded_speed = self._settings.drive.degraded_speed * abs(self._speed)
        self._tell(now, actuation)
        self._publish(now, actuation, causes)

    def _actuation(self, now: float) -> Actuation:
        tractor, trailer = self.wires.steering(now)
        return Actuation(tractor=tractor, trailer=trailer, speed=self.wires.speed(now))

    def _look_at_oneself(self, now: float, late: float) -> None:
        troubles, timing = self.watch.troubles, self._settings.timing
        troubles.lateness = late
        if not (late <= timing.late):
            troubles.late = now
        troubles.suspended |= not (suspended_time() - self._suspended_before <= timing.suspended)
        troubles.device |= self.wires.failed

    def _ask_switches(self, actuation: Actuation) -> None:
        for actuator, report in enumerate(actuation.bodies):
            self._requests.switch(actuator, None if report is None else report.switch)

    def _causes(self, now: float, actuation: Actuation) -> tuple[Cause, ...]:
        reports = actuation.reports
        lost = any(index in self._taken and not report.engaged for index, report in enumerate(self._asked(actuation)))
        seen = self.watch.observe(now, self.engagement.state, actuation.bodies, tuple(r.readiness for r in reports))
        observation = replace(
            seen,
            clips=self._clips_in_a_row,
            stuck=any(each.stuck for each in self._followings),
            reversed=any(each.reversed for each in self._followings),
            jumped=any(each.jumped for each in self._followings),
            released=lost and not any(report.overridden for report in reports),
            operator_age=self._requests.age(now),
            emergency_tried=self.engagement.emergency_tried,
        )
        return present(observation, self._settings)

    def _asked(self, actuation: Actuation) -> list[SteeringReport | SpeedReport]:
        """Return the reports of those that were asked to steer or drive; a speed actuator that is to stop was not."""
        if not self.engagement.steers:
            return []
        return actuation.reports if self.speed_limit > 0.0 else actuation.steering

    def _prepare(self, now: float, actuation: Actuation) -> None:
        """Be ready to steer without a jump: while it does not steer, its set points are where the steering is."""
        self._envelope.begin(now, actuation.angles)
        self._clips_in_a_row = 0
        self._speed = self.watch.speeds.last

    def _situation(self, now: float, causes: tuple[Cause, ...], actuation: Actuation) -> Situation:
        reports = actuation.reports
        self._taken = {i for i, each in enumerate(self._asked(actuation)) if each.engaged or i in self._taken}
        return Situation(
            causes=causes,
            actions=self._requests.take(),
            overridden=any(report.overridden for report in reports),
            taken=all(report.engaged for report in reports) and self.watch.mode is Mode.DRIVE,
            standing=self.watch.speeds.stands(now, self._settings.drive.standing),
            concerned=actuation.concerned,
        )

    @property
    def speed_limit(self) -> float:
        """Fastest that the vehicle may drive now, m/s."""
        if not self.engagement.steers or self.engagement.state is STOPPING:
            return 0.0
        return self._degraded_speed if self.engagement.state is DEGRADED else self._settings.envelope.speed

    def _tell(self, now: float, actuation: Actuation) -> None:
        steers, speed, angles = self.engagement.steers, self.watch.speeds.believable(now), self._envelope.angles
        tractor, trailer = (SteeringRequest(steer=steers, angle=angle, speed=speed) for angle in angles)
        if not self.wires.send(now, (tractor, trailer), self._speed_request(now)):
            self.watch.troubles.unsent = now
        for following, report, angle in zip(self._followings, actuation.bodies, angles, strict=True):
            # some actuators do not move while the vehicle stands
            if steers and report is not None and report.engaged and speed >= self._settings.engage.speed:
                following.add(now, angle, report.angle, report.angle_time)
            else:
                following.reset()

    def _speed_request(self, now: float) -> SpeedRequest:
        drive, limit = self._settings.drive, self.speed_limit
        deceleration = drive.emergency_deceleration if self.engagement.hurries(now) else drive.deceleration
        speed = math.copysign(min(abs(self._speed), limit), self._speed)
        return SpeedRequest(drive=limit > 0.0, speed=speed, deceleration=deceleration)

    def _publish(self, now: float, actuation: Actuation, causes: tuple[Cause, ...]) -> None:
        counts = replace(self._counts, dropped=self._counts.dropped + self.wires.dropped)
        angles, limit = self._envelope.angles, self.speed_limit
        tick = Tick(now=now, causes=causes, actuation=actuation, angles=angles, speed_limit=limit)
        state = gate_state(tick, self.engagement, self._requests, counts, valid=self._settings.engage.seen)
        record = encode(state)
        self._requests.show(state.sequence, state.time)
        self.controller.send(record)
        self.channel.publish(record)
        self._counts.states += 1
