"""Heartbeat of a process: it shows the gate that it is alive, at 4 Hz."""

from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.messages import Heartbeat, Role, SupervisorState
from drawbar.messages.records import encode

PERIOD = 250_000_000
"""ns"""


class HeartbeatSender:
    """Sends the heartbeats of one process."""

    def __init__(self, role: Role, endpoint: Endpoint, gate: str) -> None:
        """Take the role, the own endpoint and the path of the gate's socket."""
        self._role, self._endpoint, self._gate = role, endpoint, gate
        self._sequence, self.due = 0, 0
        self.state = SupervisorState.BOOT
        """of the gate, as this process received it last"""

    def pass_time(self, now: int, *, healthy: bool = True) -> None:
        """Send what is due at a time, ns."""
        if now < self.due:
            return
        self.due = now + PERIOD
        self._sequence = (self._sequence + 1) % 2**32
        heartbeat = Heartbeat(
            sequence=self._sequence,
            time=now,
            valid_until=now + 4 * PERIOD,
            role=self._role,
            healthy=int(healthy),
            state=self.state,
        )
        self._endpoint.send(self._gate, encode(heartbeat))
