"""AIO v4 stand-in: rules that reproduce recorded traces of its firmware byte for byte and millisecond for millisecond.

Checksums, lengths and senders' ports are not looked at, as on the board.
"""

import struct

from drawbar.machine.stand_in.board import StandInBoard
from drawbar.protocols.agopengps.board_settings import decode_steer_config, decode_steer_settings
from drawbar.protocols.agopengps.frame import COMPUTER, PREFIX, Frame, Pgn

_NEVER = 102
"""watchdog that does not drive"""
_DRIVES_BELOW = 100
_SWITCHES_OFF_ABOVE = 250
_OFF_TICKS = 32
"""with status 0 after which the steer bit falls back"""


class AioV4(StandInBoard):
    """An AIO v4 steer board with its firmware of 2025."""

    TICK = 0.025
    SLOWEST = 0.2

    def _boot(self) -> None:
        self._buffer = bytearray(64)
        self._status, self._changed = 0, False
        self._steer_off, self._counter, self._watchdog = True, 0, _NEVER
        self._switches, self._angle, self._speed, self._target = 7, 0.0, 0.0, 0.0
        self._low_pwm = 10
        self._pin, self._last_pin, self._overridden = True, True, False

    @property
    def steer_off(self) -> bool:
        """The steer bit."""
        return self._steer_off

    def press(self, *, pressed: bool) -> None:
        """Press or release the operator's steer button: pressing it toggles the steer bit."""
        self._pin = not pressed

    def override(self) -> None:
        """Let encoder, pressure or current notice the operator; the motor continues until the next set point."""
        self._overridden = True

    def _take(self, time: float, datagram: bytes, port: int) -> None:
        if len(datagram) < 5 or datagram[:3] != PREFIX + bytes((COMPUTER,)):
            return
        size = min(len(datagram), len(self._buffer))
        self._buffer[:size] = datagram[:size]  # what a short one lacks stays from the one before
        pgn, data = self._buffer[3], bytes(self._buffer[5:13])
        if pgn == Pgn.STEER:
            self._take_set_point(time, data)
        elif pgn in (Pgn.STEER_SETTINGS, Pgn.STEER_CONFIG):
            self._take_settings(Frame(COMPUTER, pgn, data))
        elif pgn == Pgn.HELLO:
            greeting = struct.pack("<hhB", int(self._angle * 100.0), self._counts() - 6800, self._switches)
            self._send(time, Pgn.STEER_HELLO_REPLY, greeting, constant=True)
        elif pgn == Pgn.SCAN:
            self._send_address(time)
        elif pgn == Pgn.SUBNET:
            self._move(time, data[2:5])

    def _take_set_point(self, time: float, data: bytes) -> None:
        speed, status, target = struct.unpack_from("<HBh", data)
        self._changed, self._status = status != self._status, status
        self._speed, self._target = speed / 10.0, target / 100.0
        self._watchdog = _NEVER if not status & 1 or self._steer_off else 0
        reply = struct.pack("<hhhBB", int(self._angle * 100.0), 9999, 8888, self._switches, min(abs(self.pwm), 255))
        self._send(time, Pgn.STEER_REPLY, reply)

    def _take_settings(self, frame: Frame) -> None:
        self.settings = decode_steer_settings(frame) or self.settings
        self.config = decode_steer_config(frame) or self.config
        if frame.pgn == Pgn.STEER_SETTINGS:
            self._low_pwm = int(1.2 * self.settings.minimum_pwm)

    def _tick(self, time: float) -> None:
        if self._watchdog > _SWITCHES_OFF_ABOVE:
            self._switch_off()
        else:
            self._watchdog += 1
        self._follow_status()
        if self._overridden:
            self._steer_off, self._overridden = True, False
        self._switches = 4 | self._steer_off << 1 | 1
        self._measure()
        self.driving = self._watchdog < _DRIVES_BELOW
        self.pwm = self._drive(self._angle - self._target) if self.driving and self._speed >= self.SLOWEST else 0

    def _switch_off(self) -> None:
        self._watchdog, self._steer_off = _NEVER, True

    def _follow_status(self) -> None:
        if self._changed and self._status == 1:
            self._steer_off = False
        if not self._steer_off and self._status == 0:
            self._counter += 1
            if self._counter >= _OFF_TICKS:
                self._counter, self._steer_off = 0, True
        else:
            self._counter = 0
        if self._last_pin and not self._pin:
            self._steer_off = not self._steer_off
        self._last_pin = self._pin

    def _measure(self) -> None:
        angle = self._measured()
        if abs(angle) > 50.0 or self._speed > 25.0:
            self._switch_off()
        self._angle = min(max(angle, -50.0), 50.0)

    def _drive(self, error: float) -> int:
        """Return the PWM, positive to the left, for an error in degrees, positive where the wheel is too far right."""
        settings, size = self.settings, abs(error)
        if size == 0.0:
            return 0
        slope = (settings.high_pwm - self._low_pwm) / 3.0
        limit = int(size * slope + self._low_pwm) if size < 3.0 else settings.high_pwm
        pwm = min(int(settings.gain * size) + settings.minimum_pwm, limit)
        return pwm if error > 0.0 else -pwm
