"""Live: the channels of a log that have a schema over Foxglove's WebSocket, for programs of this computer alone.

The server is foxglove-sdk's; it keeps what a viewer does not take, and drops the oldest. Nothing here waits.
"""

import foxglove

from drawbar.errors import HardwareError

HOST = "127.0.0.1"


class Live:
    """The server; `port` is where it listens."""

    def __init__(self, port: int) -> None:
        """Listen on a port of 127.0.0.1; 0: a free one.

        Raises:
            HardwareError: the port is taken.
        """
        self._context = foxglove.Context()
        self._channels: dict[str, foxglove.Channel] = {}
        try:
            self._server = foxglove.start_server(name="drawbar", host=HOST, port=port, context=self._context)
        except (OSError, RuntimeError) as error:
            raise HardwareError(
                f"the live log cannot listen at {HOST}:{port} ({error}); give another --live-port"
            ) from error
        self.port = self._server.port

    def open(self, topic: str, encoding: str, schema: foxglove.Schema) -> None:
        """Open a channel."""
        self._channels[topic] = foxglove.Channel(topic, schema=schema, message_encoding=encoding, context=self._context)

    def send(self, topic: str, data: bytes, time: int) -> None:
        """Send a message with its time, ns since 1970; one of a channel that is not open is left out."""
        if topic in self._channels:
            self._channels[topic].log(data, log_time=time)

    def close(self) -> None:
        """Close all connections."""
        self._server.stop()
