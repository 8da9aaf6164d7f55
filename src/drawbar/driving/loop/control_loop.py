"""Control loop: from messages of the receivers and the gate to commands, in the controller's process or a rehearsal.

Everything comes with its time (monotonic, ns) and leaves by the functions given; the loop itself never waits.
"""

import math
from collections.abc import Callable

from drawbar.driving.loop.controller import Controller
from drawbar.machine.hardware.sampler import Sampler, ground_speed
from drawbar.messages import CommandMessage, Fixes, GateState, Message
from drawbar.nanoseconds import seconds
from drawbar.recording.drive_records import Kind
from drawbar.signals import Measurement, StepRecord

LATE = 20_000_000
"""a command that leaves so long after its epoch was complete, or given up, is late, ns: waiting for a receiver that
loses epochs is not the computer's fault"""
REPEAT = 55_000_000
"""between a command and its repetition, ns: a controller that is held up for up to `VALIDITY` less this steers on; a
little more than 50 ms, so that none is repeated just before the next sample of 5, 10 or 20 Hz"""
_NEVER = 2**63


class ControlLoop:
    """Samples, steps, and repeats of commands in between."""

    def __init__(
        self,
        controller: Controller,
        sampler: Sampler,
        *,
        send: Callable[[Message], None],
        record: Callable[[StepRecord], None],
        clock: Callable[[], int],
        tell: Callable[[Kind, int], None] = lambda kind, sequence: None,
        send_again: Callable[[CommandMessage], None] | None = None,
    ) -> None:
        """Take the parts.

        Args:
            controller: with the autopilot.
            sampler: of measurements.
            send: hands a message to the gate, at once.
            record: takes the record of each step; called when the command is out.
            clock: monotonic time, ns.
            tell: takes what is done, and the sequence of the record that it is done about, before it is done.
            send_again: hands the gate the newest command once more; None: as `send` does.
        """
        self._controller, self._sampler = controller, sampler
        self._send, self._record, self._clock, self._tell = send, record, clock, tell
        self._send_again = send_again or send
        self._repeat = _NEVER
        self._corrected = [math.nan] * controller.receivers  # when the corrections of each were made, s
        self._receiver_speed = math.nan

    @property
    def due(self) -> int:
        """When `pass_time` is to be called even if nothing comes, ns."""
        deadline = self._sampler.deadline
        return self._repeat if deadline is None else min(self._repeat, deadline)

    def receive_gate(self, state: GateState) -> None:
        """Take in what the gate does."""
        self._tell(Kind.GATE, state.sequence)
        self._controller.receive_gate(state)
        self._sampler.receive_gate(state)

    def receive_fixes(self, fixes: Fixes) -> None:
        """Take in an epoch of the receivers; where it is a sample's, the step is made."""
        self._tell(Kind.FIXES, fixes.sequence)
        self._controller.receive_fixes(fixes)
        measurement = self._sampler.take(fixes)
        if measurement is None:
            return
        ages = (fixes.tractor.correction_age, fixes.trailer.correction_age)
        for i, age in enumerate(ages[: len(self._corrected)]):
            if math.isfinite(age):
                self._corrected[i] = seconds(fixes.epoch) - age
        self._receiver_speed = ground_speed(fixes)
        self._step(measurement, fixes.time)

    def pass_time(self, now: int) -> None:
        """Do what is due: repeat the command, or make the step of a sample whose epoch has not come."""
        deadline = self._sampler.deadline
        if deadline is not None and now >= deadline:
            self.miss()
        elif now >= self._repeat:
            self.repeat(now)

    def miss(self) -> None:
        """Make a step without its epoch."""
        self._tell(Kind.MISS, 0)
        self._receiver_speed = math.nan
        self._step(self._sampler.miss(), None)

    def repeat(self, now: int) -> None:
        """Repeat the command."""
        self._tell(Kind.REPEAT, 0)
        self._repeat = now + REPEAT
        self._send_again(self._controller.repeat(now))

    def _step(self, measurement: Measurement, complete: int | None) -> None:
        command: CommandMessage = self._controller.feedback(measurement, self._clock())
        if self._controller.ends:  # the gate acts on the command at once, and by why it ends
            self._send_state()
        self._send(command)
        out = self._clock()
        record = self._controller.prepare(late=complete is not None and out - complete > LATE)
        if self._controller.has_corrected:  # what bent the estimate bent the command
            self._send(self._controller.repeat(self._clock()))
        self._send_state()
        self._repeat = command.time + REPEAT
        self._record(record)

    def _send_state(self) -> None:
        age, speed = self._correction_age(), self._receiver_speed
        self._send(self._controller.state(self._clock(), correction_age=age, receiver_speed=speed))

    def _correction_age(self) -> float:
        """Return the age of the older corrections now, s: they grow old where an epoch, or its age, is lost."""
        ages = [seconds(self._clock()) - corrected for corrected in self._corrected]
        return math.nan if any(map(math.isnan, ages)) else max(ages)
