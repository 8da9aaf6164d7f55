"""What a gate does that is given certain safety settings: each look returns something that a setting changes."""

import math

from gate_bench import BOUNDS, Bench

from drawbar.messages import Action
from drawbar.safety import gate_process
from drawbar.safety.causes import Cause
from drawbar.safety.envelope import Envelope


def refuses(cause, seconds=0.1, **controller):
    """See whether a ready gate refuses for a cause once the controller says something."""

    def look(settings):
        bench = Bench(settings).ready()
        bench.controller = controller
        bench.run(seconds)
        return cause.value in bench.shown.refusals

    return look


def state_after(seconds, change=lambda bench: None, **names):
    """See state and cause of a driving gate some time after a change."""

    def look(settings):
        bench = Bench(settings, **names).drive()
        change(bench)
        bench.run(seconds)
        return bench.state, bench.cause

    return look


def state_on_the_way(seconds, **controller):
    """See state and cause of a gate that has steered for a time, while the vehicle is not yet on its line."""

    def look(settings):
        bench = Bench(settings)
        bench.controller = controller
        bench.drive().run(seconds)
        return bench.state, bench.cause

    return look


def saying(**controller):
    return lambda bench: setattr(bench, "controller", controller)


def untried(cause, change):
    def look(settings):
        bench = Bench(settings)
        change(bench)
        bench.run(2.0)
        return cause.value in bench.shown.refusals

    return look


def set_points(settings):
    """Return the first set points after a demand that is far too large, at 3 m/s."""
    bench = Bench(settings)
    bench.speed = 3.0
    bench.drive()
    bench.command = {"tractor_angle": 1.0, "trailer_angle": 1.0}
    bench.run()
    return bench.gate._envelope.angles


def rate_cap(settings):
    return Envelope(settings, BOUNDS).rate_cap(3.0)


def angle_cap(settings):
    return Envelope(settings, BOUNDS).angle_cap(3.0)


def ready_after(settings, seconds=4.5):
    bench = Bench(settings).ready()
    bench.channel.waiting.append(b"garbage")
    bench.run(seconds)
    return bench.state


def armed_after(seconds):
    def look(settings):
        bench = Bench(settings).ready()
        bench.ask(Action.ARM)
        bench.run(seconds)
        return bench.shown.armed

    return look


def seen_after(seconds):
    def look(settings):
        bench = Bench(settings).ready()
        shown = bench.shown
        bench.run(seconds)
        bench.ask(Action.ARM, seen_sequence=shown.sequence, seen_time=shown.time)
        bench.operator = False
        bench.run()
        return bench.shown.answer

    return look


def engaging_for(seconds, change=lambda bench: None):
    def look(settings):
        bench = Bench(settings).ready()
        change(bench)
        bench.engage().run(seconds)
        return bench.state

    return look


def wheels_do_not_take(bench):
    bench.tractor.takes = False


def degraded_then_calm(seconds):
    def look(settings):
        bench = Bench(settings).drive()
        bench.controller = {"tractor_quality": 4}
        bench.run(1.0)
        bench.controller = {}
        bench.run(seconds)
        return bench.state

    return look


def degraded_speed(settings):
    bench = Bench(settings, speed_actuator=True).drive()
    bench.controller = {"tractor_quality": 4}
    bench.run(0.7)
    return bench.speed_actuator.requests[-1][1].speed


def stopping_for(seconds, speed=1.0, **controller):
    """See what the speed actuator is told, and the state, some time after a stop was asked for."""

    def look(settings):
        bench = Bench(settings, speed_actuator=True).drive()
        bench.ask(Action.STOP)
        bench.run()
        bench.speed, bench.controller = speed, controller
        bench.run(seconds)
        return bench.state, bench.speed_actuator.requests[-1][1].deceleration

    return look


def stuck(gap, speed, seconds, *, ahead=True):
    """See whether a steering that creeps is released; its set point stays at a distance or where it is; rad, rad/s."""

    def look(settings):
        bench = Bench(settings).drive()
        bench.tractor.takes = False
        bench.tractor.changes["engaged"] = True
        for _ in range(round(seconds / 0.05)):
            bench.tractor.angle += speed * 0.05
            bench.command = {"tractor_angle": gap + (bench.tractor.angle if ahead else 0.0)}
            bench.run()
        return bench.state, bench.cause

    return look


def leaps(step):
    """See whether a steering is released whose measured angle leaps by a step, rad, and stays there."""

    def look(settings):
        bench = Bench(settings).drive()
        bench.tractor.takes = False
        bench.tractor.changes["engaged"] = True
        bench.tractor.angle += step
        bench.run(0.2)
        return bench.state, bench.cause

    return look


def clipped(times):
    def look(settings):
        bench = Bench(settings).drive()
        bench.command = {"speed": 9.0}
        bench.run(0.05 * times)
        return bench.state

    return look


def flooded(count):
    def look(settings):
        bench = Bench(settings).drive()
        bench.channel.waiting += [bench.command_record() for _ in range(count)]
        bench.run()
        return bench.state

    return look


def ticks_in_a_second(settings):
    """Return how often a gate's process tells its actuators to release before it ends, by its own clock."""
    bench = Bench(settings)
    bench.gate.watch.troubles.ended = True
    clock = iter(0.01 * index for index in range(10_000))
    gate_process._wait, before = lambda *given: None, gate_process._wait
    try:
        gate_process._loop(bench.gate, settings, gate_process.Notifier(), lambda: next(clock))
    finally:
        gate_process._wait = before
    return len(bench.tractor.requests)


class Hurrying:
    """A clock that goes on by 0.1 s at each look, and waits for nothing."""

    def __init__(self):
        self.time = 0.0

    def __call__(self):
        self.time += 0.1
        return self.time

    def wait(self, descriptors, duration):
        pass


def told_priority(settings):
    told = []
    original, gate_process.prepare = gate_process.prepare, lambda priority: told.append(priority) or []
    bench = Bench(settings)
    bench.gate.watch.troubles.ended = True
    try:
        gate_process.run(bench.gate, settings, Hurrying())
    finally:
        gate_process.prepare = original
    return told


def late(seconds):
    return lambda bench: setattr(bench, "late", seconds)


def silent_angle(bench):
    bench.tractor.silent_since = bench.time


def command_lasting(seconds):
    def look(settings):
        bench = Bench(settings).ready()
        bench.command = {"valid_until": bench.ns(bench.time + 0.05 + seconds)}
        bench.run()
        return bench.shown.rejects

    return look


def speeds(seconds, **controller):
    def look(settings):
        bench = Bench(settings).drive()
        bench.controller = {"wheel_speed": math.nan, "receiver_speed": math.nan, **controller}
        bench.run(seconds)
        return bench.state

    return look


def largest_speed(settings):
    bench = Bench(settings).drive()
    for wheel in (2.0, 1.9, 1.8, 1.7):
        bench.controller = {"wheel_speed": wheel, "receiver_speed": wheel}
        bench.run()
    return bench.gate.watch.speeds.largest(bench.time)


def unknown_speed(settings):
    bench = Bench(settings).drive()
    bench.controller = {"wheel_speed": math.nan, "receiver_speed": math.nan}
    bench.run(0.8)
    return bench.gate.watch.speeds.largest(bench.time)


def silent(name, cause, seconds):
    """Return whether it shows that a process has been silent for so long."""

    def look(settings):
        bench = Bench(settings).ready()
        setattr(bench, name, None)
        bench.run(seconds)
        return cause.value in bench.shown.refusals

    return look


def suspended_for(seconds):
    def change(bench):
        bench.gate._suspended_before -= seconds

    return state_after(0.1, change)


def lease_after(seconds):
    def look(settings):
        bench = Bench(settings).ready()
        bench.ask(Action.ARM)
        bench.run()
        bench.operator = False
        bench.run(seconds)
        bench.ask(Action.ARM, lease=8)
        bench.run()
        return bench.shown.lease

    return look


def nudged(settings):
    bench = Bench(settings).ready()
    bench.ask(Action.ARM)
    bench.run()
    bench.ask(Action.NUDGE, 0.25)
    bench.operator = False
    bench.run()
    return bench.shown.nudge


def steering_apart(settings):
    bench = Bench(settings).ready()
    bench.command = {"tractor_angle": 0.1}
    bench.run(0.1)
    return Cause.STEERING_APART.value in bench.shown.refusals


def overrun_forgotten(settings):
    bench = Bench(settings).ready()
    bench.controller = {"overruns": 1}
    bench.run(1.0)
    return Cause.OVERRUN.value in bench.shown.refusals


def garbage_forgotten(settings):
    bench = Bench(settings).ready()
    bench.channel.waiting.append(b"garbage")
    bench.run(1.0)
    return Cause.COMMAND_REFUSED.value in bench.shown.refusals
