"""A gate on the bench: actuators, controller, recorder and operator that behave, until a test tells them not to."""

import math
from dataclasses import replace

from drawbar.messages import (
    Action,
    CommandMessage,
    ControllerState,
    GateState,
    Heartbeat,
    Mode,
    OperatorMessage,
    Role,
    SupervisorState,
)
from drawbar.messages.records import decode, encode
from drawbar.protocols.actuator import Readiness, SteeringReport
from drawbar.protocols.speed_actuator import SpeedReport
from drawbar.safety.envelope import Bounds
from drawbar.safety.machine_gate import Gate
from drawbar.safety.settings import SafetySettings
from drawbar.safety.wires import Wire
from drawbar.transports.base import Transport

BOUNDS = Bounds(wheelbase=1.4, tractor_limit=math.radians(30.0), trailer_limit=math.radians(20.0))
TICK = 0.05
STEERING = (SupervisorState.ENGAGING, SupervisorState.ACTIVE, SupervisorState.DEGRADED, SupervisorState.STOPPING)


class FakeTransport(Transport):
    """Keeps what is written; gives what a test has put in."""

    def __init__(self):
        self.connected, self.written, self.waiting, self.works, self.closed = True, [], [], True, False

    def fileno(self):
        return -1

    def read(self):
        arrived, self.waiting = self.waiting, []
        return arrived

    def write(self, data):
        self.written.append(data)
        return self.works

    def close(self):
        self.closed = True


class FakeSteering:
    """A steering that turns at 25 deg/s, and reports what a test has changed of its report."""

    def __init__(self, name):
        self.name, self.dropped, self.requests, self.received = name, {"checksum": 1}, [], []
        self.angle, self.changes, self.time, self.takes, self.silent_since = 0.0, {}, 0.0, True, None
        self.frames = 1

    def receive(self, time, frame, source=""):
        self.received.append((time, frame, source))

    def send(self, time, request):
        if request.steer and self.takes:
            step = math.radians(25.0) * (time - self.time)
            self.angle += min(max(request.angle - self.angle, -step), step)
        self.time = time
        self.requests.append((time, request))
        return [f"{self.name} {'on' if request.steer else 'off'}".encode()] * self.frames

    def report(self, time):
        steers = bool(self.requests) and self.requests[-1][1].steer and self.takes
        heard = time if self.silent_since is None else self.silent_since
        report = SteeringReport(angle=self.angle, angle_time=heard, engaged=steers, readiness=Readiness.READY)
        return replace(report, **self.changes)


class FakeSpeed:
    """A speed actuator that takes what it is told."""

    def __init__(self):
        self.dropped, self.requests, self.changes = {}, [], {}

    def receive(self, time, frame, source=""):
        pass

    def send(self, time, request):
        self.requests.append((time, request))
        return [b"speed"]

    def report(self, time):
        drives = bool(self.requests) and self.requests[-1][1].drive
        return replace(SpeedReport(engaged=drives, readiness=Readiness.READY), **self.changes)


class FakeController:
    """The gate's end of the controller's channel."""

    def __init__(self):
        self.gone, self.waiting, self.sent, self.most = False, [], [], 0

    def fileno(self):
        return -1

    def receive(self, most):
        self.most = most
        taken, self.waiting = self.waiting[:most], self.waiting[most:]
        return taken

    def send(self, record):
        self.sent.append(record)


class FakeOperatorChannel(FakeController):
    """The operators' socket."""

    def __init__(self):
        super().__init__()
        self.subscribed = []

    def receive(self, most):
        return [(record, "front") for record in super().receive(most)]

    def subscribe(self, sender):
        self.subscribed.append(sender)

    def publish(self, record):
        self.sent.append(record)


class Bench:
    """The gate with its clock; `run` lets time pass, and everything that is not None or False is heard at each tick."""

    def __init__(self, settings=None, *, speed_actuator=False, trailer=True, bounds=BOUNDS, time=100.0):
        self.settings = settings or SafetySettings()
        self.time, self.sequence, self.nonce, self.lease = time, 0, 0, 7
        self.transport, self.tractor = FakeTransport(), FakeSteering("tractor")
        self.trailer = FakeSteering("trailer") if trailer else None
        self.speed_actuator = FakeSpeed() if speed_actuator else None
        self.channel, self.operators = FakeController(), FakeOperatorChannel()
        wire = Wire(transport=self.transport, tractor=self.tractor, trailer=self.trailer, speed=self.speed_actuator)
        self.gate = Gate(self.settings, bounds, [wire], self.channel, self.operators)
        self.speed = 1.0
        self.controller = {}
        """changes of the controller's state; None: it says nothing"""
        self.command = {}
        """changes of its command; None: it gives none"""
        self.follows = True
        """the controller's mode follows the gate's state"""
        self.recorder, self.guard, self.operator, self.late = 1, 1, True, 0.0

    # what is sent

    def ns(self, time=None):
        return round((self.time if time is None else time) * 1e9)

    def state_record(self):
        values = dict(  # noqa: C408
            sequence=self.sequence, time=self.ns(), valid_until=self.ns(self.time + 1.0), tractor_quality=5,
            trailer_quality=5, configuration=self.settings.fingerprint(), wiggled=1, status=0, flags=0, solved=99,
            overruns=0, correction_age=1.0, lateral_deviation=0.02, heading_deviation=0.01,
            tractor_lateral_error=0.1, trailer_lateral_error=-0.1, tractor_heading_error=0.05,
            trailer_heading_error=-0.05, hitch_angle=0.1, wheel_speed=self.speed, receiver_speed=self.speed,
        )  # fmt: skip
        return encode(ControllerState(**{**values, **self.controller}))

    def command_record(self, **changes):
        self.sequence += 1
        mode = Mode.DRIVE if self.follows and self.state in STEERING else Mode.IDLE
        values = dict(  # noqa: C408
            sequence=self.sequence, time=self.ns(), valid_until=self.ns(self.time + 0.2), mode=mode,
            tractor_angle=0.0, trailer_angle=0.0, speed=1.0,
        )  # fmt: skip
        return encode(CommandMessage(**{**values, **self.command, **changes}))

    def ask(self, action, value=0.0, **changes):
        """Let an operator's message arrive; it is received at the next tick."""
        self.nonce += 1
        shown = self.shown
        values = dict(  # noqa: C408
            time=self.ns(), valid_until=self.ns(self.time + 1.0), action=action, lease=self.lease, nonce=self.nonce,
            seen_sequence=shown.sequence if shown else 0, seen_time=shown.time if shown else 0, value=value,
        )  # fmt: skip
        self.operators.waiting.append(encode(OperatorMessage(**{**values, **changes})))

    # what is seen

    @property
    def state(self):
        return self.gate.engagement.state

    @property
    def shown(self):
        return decode(self.operators.sent[-1], GateState) if self.operators.sent else None

    @property
    def cause(self):
        return self.gate.engagement.cause

    # what happens

    def receive(self):
        if self.controller is not None:
            self.channel.waiting.append(self.state_record())
        if self.command is not None:
            self.channel.waiting.append(self.command_record())
        if self.recorder is not None:
            beat = Heartbeat(
                time=self.ns(), valid_until=self.ns(), role=Role.RECORDER, healthy=self.recorder, state=self.state
            )
            self.operators.waiting.append(encode(beat))
        if self.guard is not None:
            beat = Heartbeat(
                time=self.ns(), valid_until=self.ns(), role=Role.GUARD, healthy=self.guard, state=self.state
            )
            self.operators.waiting.append(encode(beat))
        if self.operator:
            self.ask(Action.PRESENT)
        return self.gate.receive(lambda: self.time)

    def run(self, seconds=0.0):
        """Let ticks pass: at least one."""
        for _ in range(max(round(seconds / TICK), 1)):
            self.time = self.ns(self.time + TICK) / 1e9  # rounded as the gate's own clock is
            self.receive()
            self.gate.tick(self.time, self.late)
        return self

    def ready(self):
        """Try the emergency stop while standing, then wait until the gate is ready."""
        self.run(1.5)
        speed, self.speed = self.speed, 0.0
        self.run(1.0)
        self.ask(Action.EMERGENCY)
        self.run(1.0)
        self.ask(Action.ACKNOWLEDGE)
        self.run()
        self.speed = speed
        return self.run(12.0)

    def engage(self):
        self.ask(Action.ARM)
        self.run()
        self.ask(Action.ENGAGE)
        return self.run()

    def drive(self):
        """Drive: the gate is active."""
        return self.ready().engage().run(2.0)


def driving(settings=None, **names):
    """Return a bench whose gate steers."""
    bench = Bench(settings, **names).drive()
    assert bench.state is SupervisorState.ACTIVE, (bench.cause, bench.shown.refusals)
    return bench


def told(bench):
    """Return what the last frames say."""
    return bench.transport.written[-2:]
