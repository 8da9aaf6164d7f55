"""The gate's process: runs the gate at its own pace until it is told to end or the controller is gone.

It alone owns the actuators. Before it ends, for any reason but SIGKILL, it has disengaged them.
"""

import math
import signal
import traceback
from types import FrameType

from drawbar.messages import SupervisorState
from drawbar.nanoseconds import seconds
from drawbar.protocols.actuator import SteeringRequest
from drawbar.protocols.speed_actuator import SpeedRequest
from drawbar.realtime import Notifier, prepare, say
from drawbar.safety.machine_gate import Gate
from drawbar.safety.settings import SafetySettings
from drawbar.transports.clock import MachineClock

ENDED, GONE, FAILED = 0, 3, 4
"""exit codes: told to end; the controller's process has ended; the gate's own program failed"""
ASK_AGAIN = 0.01
"""between two looks at a device that cannot be waited on, s"""


def run(gate: Gate, settings: SafetySettings, clock: MachineClock) -> int:
    """Run the gate in this process, which may do nothing else; return the exit code.

    SIGTERM and SIGINT end it. Before it returns, it commands the actuators to release for `timing.off` seconds and
    closes the devices. Real-time scheduling that the system does not allow is reported on standard error.
    """
    for word in prepare(settings.timing.priority):
        say(f"gate: {word}")

    def end(number: int, frame: FrameType | None) -> None:
        gate.watch.troubles.ended = True

    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, end)
    notifier = Notifier()
    try:
        return _loop(gate, settings, notifier, clock)
    except Exception:
        say(traceback.format_exc())
        _release_for_good(gate, settings, clock)
        return FAILED
    finally:
        notifier.tell("STOPPING=1")
        notifier.close()
        gate.wires.close()


def _loop(gate: Gate, settings: SafetySettings, notifier: Notifier, clock: MachineClock) -> int:
    """Tick at the gate's pace, counted from the last tick; one that was missed is never caught up in a burst.

    After a new command the next tick comes after half a period, so that commands at 5, 10 and 20 Hz arrive between two
    ticks and not just after the actuators were commanded. One that does come then waits for a quarter of a period.
    """
    period, due, over, announced = settings.timing.tick, clock(), math.inf, SupervisorState.BOOT
    last = due - period
    while True:
        urgent, time = gate.receive(clock), clock()
        if urgent or time >= due:
            gate.tick(time, max(time - last - period, 0.0))
            notifier.feed(time)
            due = next_tick(time, period, time - last, urgent=urgent)
            last = time
        if gate.engagement.state is not announced:
            announced = _announce(notifier, announced, gate.engagement.state)
        if gate.controller.gone or gate.watch.troubles.ended:
            over = min(over, time + settings.timing.off)
        if time >= over:
            return ENDED if gate.watch.troubles.ended else GONE
        _wait(gate, clock, time, min(due, over))


def next_tick(time: float, period: float, since: float, *, urgent: bool) -> float:
    """Return when the tick after one at a time is due, s.

    Args:
        time: of the tick, s.
        period: of ticks that come by themselves, s.
        since: how long after the tick before it came, s.
        urgent: it came because of something new.
    """
    if not urgent:
        return time + period
    return time + (period / 4.0 if since < period / 4.0 else period / 2.0)


def _announce(notifier: Notifier, announced: SupervisorState, state: SupervisorState) -> SupervisorState:
    """Report a new state to the service manager; the gate is ready once it has passed its first self-test."""
    if state is SupervisorState.STANDBY and announced <= SupervisorState.SELFTEST:
        notifier.tell("READY=1")
    notifier.tell(f"STATUS={state.name}")
    return state


def _wait(gate: Gate, clock: MachineClock, now: float, until: float) -> None:
    """Wait for a message, at most until a time, s, or until the last command expires."""
    descriptors = [*gate.wires.descriptors(), gate.channel.fileno()]
    if not gate.controller.gone:
        descriptors.append(gate.controller.fileno())
    if gate.engagement.steers and gate.watch.command is not None:
        until = min(until, seconds(gate.watch.command.valid_until) + 1e-6)
    if min(descriptors) < 0:
        until = min(until, now + ASK_AGAIN)
    clock.wait([each for each in descriptors if each >= 0], until - now)


def _release_for_good(gate: Gate, settings: SafetySettings, clock: MachineClock) -> None:
    """Command the actuators to release, after the gate's own program has failed: nothing of it is asked any more."""
    off = SteeringRequest(steer=False, angle=0.0, speed=0.0)
    stop = SpeedRequest(drive=False, speed=0.0, deceleration=settings.drive.emergency_deceleration)
    end = clock() + settings.timing.off
    while clock() < end:
        gate.wires.send(clock(), (off, off), stop)
        clock.wait((), settings.timing.tick)
