"""Stand-in tractor: the control unit that reports a machine's speeds on its bus, and takes a speed command."""

import math
from collections import Counter

from drawbar.protocols.isobus.cadence import Cadence
from drawbar.protocols.isobus.guidance_messages import LimitStatus
from drawbar.protocols.isobus.identifier import Message
from drawbar.protocols.isobus.node import Component, IsobusNode
from drawbar.protocols.isobus.tractor_messages import (
    GROUND_SPEED,
    SELECTED_SPEED,
    SELECTED_SPEED_COMMAND,
    WHEEL_SPEED,
    SelectedSpeed,
    SpeedSource,
    WheelOrGroundSpeed,
    WheelStates,
    decode_speed_command,
    encode_selected_speed,
    encode_speed,
)
from drawbar.transports.base import CanFrame

_PERIOD = 0.1
_TIMEOUT = 0.3
"""after which a speed command counts no more, s"""


class StandInTractor(Component):
    """Speeds at 10 Hz of a machine that a test or a simulation moves by `wheel_speed` and `ground_speed`."""

    def __init__(self, node: IsobusNode) -> None:
        self.dropped: Counter[str] = Counter()
        self.wheel_speed: float | None = 0.0
        """at the wheels, m/s, reverse negative; None: this facility is lost"""
        self.ground_speed: float | None = 0.0
        """over ground, m/s, reverse negative; None: this facility is lost"""
        self.operator_drives = False
        self.exit_reason = 0
        """its exit reason: why it ended the last command"""
        """the operator has taken the speed over by pedal or lever"""
        self._node = node
        self._cadence = Cadence(_PERIOD)
        self._distances = [0.0, 0.0]
        self._moved = math.nan
        self._set_point = math.nan
        self._set_point_time = -math.inf
        node.attach(self)

    def commanded(self, time: float) -> float | None:
        """Return the speed that is asked of it, m/s, None where none is or the last one is too old."""
        fresh = time - self._set_point_time <= _TIMEOUT
        obeys = fresh and math.isfinite(self._set_point) and not self.operator_drives
        return self._set_point if obeys else None

    def receive_message(self, time: float, message: Message) -> None:
        """Take in a speed command."""
        if message.pgn != SELECTED_SPEED_COMMAND:
            return
        command = decode_speed_command(message.data)
        if command is None:
            self.dropped["length"] += 1
        else:
            self._set_point, self._set_point_time = command[0], time

    def frames(self, time: float) -> list[CanFrame]:
        """Move on, and return the speeds that are due."""
        elapsed = time - self._moved if self._moved <= time else 0.0
        self._moved = time
        speeds = (self.wheel_speed, self.ground_speed)
        self._distances = [
            distance + abs(speed or 0.0) * elapsed for distance, speed in zip(self._distances, speeds, strict=True)
        ]
        if not self._node.claim.held or not self._cadence.due(time):
            return []
        return self._speeds()

    def _speeds(self) -> list[CanFrame]:
        wheel, ground = self._distances
        frames = []
        if self.wheel_speed is not None:
            value = WheelOrGroundSpeed(speed=self.wheel_speed, distance=wheel)
            frames.append(self._node.frame(WHEEL_SPEED, encode_speed(value, WheelStates(key_on=True))))
            limit = LimitStatus.OPERATOR if self.operator_drives else LimitStatus.NOT_LIMITED
            selected = SelectedSpeed(
                speed=self.wheel_speed,
                distance=wheel,
                source=SpeedSource.WHEEL,
                exit_reason=self.exit_reason,
                limit=limit,
            )
            frames.append(self._node.frame(SELECTED_SPEED, encode_selected_speed(selected)))
        if self.ground_speed is not None:
            value = WheelOrGroundSpeed(speed=self.ground_speed, distance=ground)
            frames.append(self._node.frame(GROUND_SPEED, encode_speed(value)))
        return frames
