"""Board settings: what a steer board stores (252, 251). It writes them at once to memory that wears out.

They are for an operator's command at standstill, never for a cycle; AiO_26 stops for 2 s and restarts when 251
changes its motor.
"""

import struct
from dataclasses import dataclass

from drawbar.protocols.agopengps.frame import COMPUTER, Frame, Pgn, byte, pack


@dataclass(frozen=True, slots=True, kw_only=True)
class SteerSettings:
    """The board's position loop and its wheel angle sensor (252)."""

    gain: int = 40
    """PWM per degree of error"""
    high_pwm: int = 60
    """largest PWM"""
    low_pwm: int = 10
    """AIO v4 ignores it and takes 1.2 x `minimum_pwm`"""
    minimum_pwm: int = 9
    """added to every PWM that is not zero: what the motor needs to move at all"""
    counts_per_degree: int = 30
    """of the wheel angle sensor, at least 1: with 0 the board reports angles that are no numbers"""
    offset: int = 0
    """of the wheel angle sensor's centre, counts"""
    ackermann: int = 100
    """per cent by which the board scales angles to the left"""

    def encode(self) -> bytes:
        """Return the datagram; raises HardwareError when a value is outside of what boards take."""
        data = struct.pack(
            "<5BhB",
            byte("gain", self.gain),
            byte("high_pwm", self.high_pwm),
            byte("low_pwm", self.low_pwm),
            byte("minimum_pwm", self.minimum_pwm),
            byte("counts_per_degree", self.counts_per_degree, lowest=1),
            byte("offset", self.offset, -0x8000, 0x7FFF),
            byte("ackermann", self.ackermann, lowest=1),
        )
        return pack(COMPUTER, Pgn.STEER_SETTINGS, data)


def decode_steer_settings(frame: Frame) -> SteerSettings | None:
    """Return settings as a board takes them, impossible values included; None: not such a message."""
    if (frame.source, frame.pgn, len(frame.data)) != (COMPUTER, Pgn.STEER_SETTINGS, 8):
        return None
    gain, high, low, minimum, counts, offset, ackermann = struct.unpack("<5BhB", frame.data)
    return SteerSettings(
        gain=gain,
        high_pwm=high,
        low_pwm=low,
        minimum_pwm=minimum,
        counts_per_degree=counts,
        offset=offset,
        ackermann=ackermann,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class SteerConfig:
    """How a steer board is wired (251)."""

    invert_sensor: bool = False
    """the wheel angle sensor turns the other way"""
    relay_active_high: bool = False
    invert_motor: bool = False
    """the motor turns the other way"""
    single_ended: bool = False
    """the wheel angle sensor has one signal wire"""
    cytron: bool = False
    """motor driver: Cytron, else IBT2"""
    steer_switch: bool = False
    """a switch at the board enables its steering"""
    steer_button: bool = False
    """a button does"""
    shaft_encoder: bool = False
    """turns of the steering wheel's shaft release"""
    threshold: int = 5
    """counts of the encoder, or reading of the sensor, that release"""
    minimum_speed: int = 0
    """below which AiO_26 does not begin to steer, 0.1 km/h; AIO v4 ignores it"""
    danfoss: bool = False
    """a Danfoss valve instead of a motor: 128 is neutral, 0 its fault"""
    pressure_sensor: bool = False
    """pressure in the steering releases"""
    current_sensor: bool = False
    """current of the motor releases"""
    imu_across: bool = False
    """the IMU's Y axis is the vehicle's roll axis"""
    angular_velocity: int = 0
    """unused by boards"""

    def encode(self) -> bytes:
        """Return the datagram; raises HardwareError when a value does not fit its byte."""
        sensor_and_motor = (self.invert_sensor, self.relay_active_high, self.invert_motor, self.single_ended)
        wiring = (*sensor_and_motor, self.cytron, self.steer_switch, self.steer_button, self.shaft_encoder)
        options = (self.danfoss, self.pressure_sensor, self.current_sensor, self.imu_across)
        threshold, speed = byte("threshold", self.threshold), byte("minimum_speed", self.minimum_speed)
        rest = (_bits(options), byte("angular_velocity", self.angular_velocity), 0, 0, 0)
        return pack(COMPUTER, Pgn.STEER_CONFIG, bytes((_bits(wiring), threshold, speed, *rest)))


def _bits(flags: tuple[bool, ...]) -> int:
    return sum(1 << place for place, flag in enumerate(flags) if flag)


def decode_steer_config(frame: Frame) -> SteerConfig | None:
    """Return the wiring that a message sets; None: not such a message."""
    if (frame.source, frame.pgn, len(frame.data)) != (COMPUTER, Pgn.STEER_CONFIG, 8):
        return None
    wiring, threshold, speed, options, angular_velocity = frame.data[:5]
    return SteerConfig(
        invert_sensor=bool(wiring & 0x01),
        relay_active_high=bool(wiring & 0x02),
        invert_motor=bool(wiring & 0x04),
        single_ended=bool(wiring & 0x08),
        cytron=bool(wiring & 0x10),
        steer_switch=bool(wiring & 0x20),
        steer_button=bool(wiring & 0x40),
        shaft_encoder=bool(wiring & 0x80),
        threshold=threshold,
        minimum_speed=speed,
        danfoss=bool(options & 0x01),
        pressure_sensor=bool(options & 0x02),
        current_sensor=bool(options & 0x04),
        imu_across=bool(options & 0x08),
        angular_velocity=angular_velocity,
    )
