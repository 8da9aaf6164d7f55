"""Self-test of the gate: whether its limits limit, with the settings and the interpreter that will drive. Pure."""

import math
from dataclasses import replace

from drawbar.messages import CommandMessage, Mode
from drawbar.messages.records import Flaw, decode, encode
from drawbar.safety.envelope import Bounds, Envelope
from drawbar.safety.settings import SafetySettings


def limits_hold(settings: SafetySettings, bounds: Bounds) -> bool:
    """Return whether what must be refused is refused, and what must be limited is limited."""
    command = CommandMessage(
        sequence=0,
        time=0,
        valid_until=0,
        mode=Mode.DRIVE,
        tractor_angle=math.pi,
        trailer_angle=-math.pi,
        speed=2.0 * settings.envelope.speed,
    )
    return _refuses(settings, bounds, command) and _limits(settings, bounds, command)


def _refuses(settings: SafetySettings, bounds: Bounds, command: CommandMessage) -> bool:
    record = encode(command)
    spoiled = record[:-1] + bytes([record[-1] ^ 1])
    envelope = Envelope(settings, bounds)
    return (
        decode(record, CommandMessage) == command
        and decode(spoiled, CommandMessage) is Flaw.CHECKSUM
        and decode(encode(replace(command, speed=math.nan)), CommandMessage) is Flaw.NOT_FINITE
        and not Envelope(settings, bounds).admit(command, math.inf)  # expired
        and not Envelope(settings, bounds).admit(command, -math.inf)  # of the future
        and envelope.admit(command, 0.0)
        and not envelope.admit(command, 0.0)  # again
    )


def _limits(settings: SafetySettings, bounds: Bounds, command: CommandMessage) -> bool:
    limited = Envelope(settings, bounds).limit(command, (0.0, 0.0), settings.envelope.speed)
    return (
        limited.clipped
        and 0.0 < limited.angles[0] <= min(bounds.tractor_limit, settings.envelope.steering_reach)
        and 0.0 > limited.angles[1] >= -min(bounds.trailer_limit, settings.envelope.steering_reach)
        and limited.speed == settings.envelope.speed
    )
