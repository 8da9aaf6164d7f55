"""Input recorder: what the receivers' process sends to the recorder, so that a drive can be computed again."""

from drawbar.driving.messaging.datagrams import Device, pack
from drawbar.driving.messaging.endpoint import Endpoint
from drawbar.nanoseconds import nanoseconds
from drawbar.recording.drive_records import Happening, Kind, Order, RawBytes
from drawbar.transports.base import Received, Transport
from drawbar.transports.clock import Clock
from drawbar.transports.tapped import Direction, TappedTransport

_TOGETHER = 32
"""looks that are sent at once, at most"""


class InputRecorder:
    """Sends the recorder every byte, and each look at the receivers that may have changed anything."""

    def __init__(self, endpoint: Endpoint, recorder: str, clock: Clock) -> None:
        """Take the own endpoint, the path of the recorder's and the clock of what comes, s."""
        self._endpoint, self._recorder, self.clock = endpoint, recorder, clock
        self._pieces = 0
        self._looks: list[Happening] = []

    def tap(self, transport: Transport, device: Device) -> TappedTransport:
        """Return a transport, every byte of which goes to the recorder too."""

        def tap(direction: Direction, received: Received) -> None:
            self._pieces += direction is Direction.IN
            raw = RawBytes(
                time=nanoseconds(received.time),
                device=device.topic,
                direction=direction,
                source=received.source,
                data=received.data,
            )
            self._endpoint.send_queued(self._recorder, pack(raw))

        return TappedTransport(transport, tap, self.clock)

    def note_look(self, time: int, *, was_due: bool, found: bool) -> None:
        """Note a look at a time, ns, at which something came, was due or was found; any other has done nothing.

        All looks are sent to the recorder with the one that has found something, or soon.
        """
        if self._pieces or was_due or found:
            self._looks.append(Happening(kind=Kind.LOOK, time=time, sequence=self._pieces))
        self._pieces = 0
        if self._looks and (found or len(self._looks) >= _TOGETHER):
            self._endpoint.send_queued(self._recorder, pack(Order(tuple(self._looks))))
            self._looks.clear()
