"""Self-test of the gate: whether its limits limit, with the settings and the interpreter that will drive. Pure."""

import math
from dataclasses import replace

from drawbar.messages import CommandMessage, Mode
from drawbar.messages.records import Flaw, decode, encode
from drawbar.safety.envelope import Bounds, Envelope
from drawbar.safety.settings import SafetySettings

SECOND = 1_000_000_000


def limits_hold(settings: SafetySettings, bounds: Bounds) -> bool:
    """Return whether what must be refused is refused, and what must be limited is limited."""
    command = CommandMessage(
        sequence=1,
        time=SECOND,
        valid_until=SECOND + 1,
        mode=Mode.DRIVE,
        tractor_angle=math.pi,
        trailer_angle=-math.pi,
        speed=1e3,
    )
    return _refuses(settings, bounds, command) and _limits(settings, bounds, command)


def _refuses(settings: SafetySettings, bounds: Bounds, command: CommandMessage) -> bool:
    record = encode(command)
    spoiled = record[:-5] + bytes([record[-5] ^ 1]) + record[-4:]
    envelope = Envelope(settings, bounds)
    return (
        decode(record, CommandMessage) == command
        and decode(spoiled, CommandMessage) is Flaw.CHECKSUM
        and decode(encode(replace(command, speed=math.nan)), CommandMessage) is Flaw.NOT_FINITE
        and not envelope.admit(command, 2.0 * (1.0 + settings.timing.command))
        and not envelope.admit(replace(command, sequence=2), 0.5)
        and envelope.admit(replace(command, sequence=3), 1.0)
        and not envelope.admit(replace(command, sequence=3), 1.0)
    )


def _limits(settings: SafetySettings, bounds: Bounds, command: CommandMessage) -> bool:
    envelope = Envelope(settings, bounds)
    envelope.begin(1.0, (0.0, 0.0))
    limited = envelope.limit(command, (0.0, 0.0), settings.envelope.speed)
    return (
        limited.clipped
        and 0.0 < limited.angles[0] <= min(bounds.tractor_limit, settings.envelope.steering_reach)
        and 0.0 > limited.angles[1] >= -min(bounds.trailer_limit, settings.envelope.steering_reach)
        and limited.speed == settings.envelope.speed
    )
