"""AiO_26 stand-in: the rules read in its source; not compared with a running board."""

import math
import struct

from drawbar.machine.stand_in.board import StandInBoard
from drawbar.protocols.agopengps.board_settings import decode_steer_config, decode_steer_settings
from drawbar.protocols.agopengps.frame import COMPUTER, CONSTANT, GREETINGS, Frame, Pgn, parse

_WATCHDOG = 2.0
_DISARM = 0.3
_NOT_READY = 0.2
_RAMP = 0.5
_BUTTON_WINDOW = 5.0


class Aio26(StandInBoard):
    """An AiO_26 steer board: it checks what it obeys, and reports at 100 Hz unasked."""

    TICK = 0.01
    SLOWEST = 0.0

    link = True
    """its network cable carries"""
    motor_ready = True
    """its CAN motor or valve answers"""
    computer_port = 9999
    """the only port it takes datagrams from"""

    def _boot(self) -> None:
        self._status: int | None = None
        self._armed = False
        self._received = self._zero_since = self._kicked = -math.inf
        self._armed_at = self._drives_since = math.inf
        self._speed = self._target = 0.0
        self._now = self._start

    @property
    def steer_off(self) -> bool:
        """The steer bit."""
        return not self._armed

    def press(self, *, pressed: bool) -> None:
        """Press or release the operator's steer button: within 5 s of a kick-out it steers again."""
        if pressed and self._armed:
            self._armed = False
        elif pressed and (self._status or 0) & 1 and self._now - self._kicked <= _BUTTON_WINDOW:
            self._arm(self._now)

    def override(self) -> None:
        """Kick out: the motor is off at once."""
        self._armed, self._kicked = False, self._now
        self.driving, self.pwm = False, 0

    def _take(self, time: float, datagram: bytes, port: int) -> None:
        frame = parse(datagram)
        if not self.link or port != self.computer_port or not isinstance(frame, Frame) or frame.source != COMPUTER:
            return
        self._now = time
        if frame.pgn in GREETINGS and datagram[-1] != CONSTANT:
            return
        if frame.pgn == Pgn.STEER and len(frame.data) == 8:
            self._take_set_point(time, frame.data)
        elif frame.pgn in (Pgn.STEER_SETTINGS, Pgn.STEER_CONFIG):
            self.settings = decode_steer_settings(frame) or self.settings
            self.config = decode_steer_config(frame) or self.config
        elif frame.pgn == Pgn.HELLO:
            self._send(time, Pgn.STEER_HELLO_REPLY, bytes(5), constant=True)
        elif frame.pgn == Pgn.SCAN:
            self._send_address(time)
        elif frame.pgn == Pgn.SUBNET:
            self._move(time, frame.data[2:5])

    def _take_set_point(self, time: float, data: bytes) -> None:
        speed, status, target = struct.unpack_from("<HBh", data)
        rising = self._status is not None and bool(status & 0x41 & ~self._status)
        if not status & 1 and (self._status is None or self._status & 1):
            self._zero_since = time
        self._status, self._received = status, time
        self._speed, self._target = speed / 10.0, target / 100.0
        if rising and speed >= self.config.minimum_speed:
            self._arm(time)

    def _arm(self, time: float) -> None:
        self._armed, self._armed_at, self._kicked = True, time, -math.inf

    def _tick(self, time: float) -> None:
        self._now = time
        asked = bool((self._status or 0) & 1)
        by_operator = self.config.steer_switch or self.config.steer_button
        if not asked and not by_operator and time - self._zero_since >= _DISARM:
            self._armed = False
        if not self.motor_ready and time - self._armed_at >= _NOT_READY:
            self._armed = False
        angle = self._measured()
        self.driving = self._armed and asked and self.link and self.motor_ready and time - self._received < _WATCHDOG
        self._drives_since = min(self._drives_since, time) if self.driving else math.inf
        self.pwm = self._drive(angle - self._target, time) if self.driving else 0
        if self.link:
            self._report(time, angle)

    def _drive(self, error: float, time: float) -> int:
        settings, size = self.settings, abs(error)
        if size == 0.0:
            return 0
        pwm = min(int(settings.gain * size) + settings.minimum_pwm, settings.high_pwm)
        ramped = int(pwm * min((time - self._drives_since) / _RAMP, 1.0))
        return ramped if error > 0.0 else -ramped

    def _report(self, time: float, angle: float) -> None:
        """Send the reply that nobody asked for; heading and roll are 0."""
        hundredths = int(min(max(angle, -300.0), 300.0) * 100.0)
        switches = 4 | self.steer_off << 1 | 1
        self._send(time, Pgn.STEER_REPLY, struct.pack("<hhhBB", hundredths, 0, 0, switches, abs(self.pwm)))
