"""Board scan: asks all AgOpenGPS boards on this computer's networks where they are; none moves or stores anything."""

from collections.abc import Iterable

from drawbar.protocols.agopengps.frame import Refusal, parse
from drawbar.protocols.agopengps.network import BOARD_PORT, SCAN, ScanReply, decode_scan_reply
from drawbar.transports.address import UdpAddress
from drawbar.transports.udp import UdpTransport


class BoardScan:
    """The scan from one socket of this computer, which must be the port that boards answer to."""

    def __init__(self, listen: tuple[str, int], boards: Iterable[tuple[str, int]]) -> None:
        """Open the socket.

        Args:
            listen: its host and port.
            boards: host and port of known ones, which are asked by themselves too.

        Raises:
            HardwareError: the port is taken.
        """
        host, port = listen
        self._line, self._boards = UdpTransport(UdpAddress(host=host, port=port, broadcast=True)), tuple(boards)
        self.found: dict[str, ScanReply] = {}
        """what was answered, by `address:port` of the sender"""

    def ask(self) -> None:
        """Ask on all networks, and the known ones."""
        self._line.write_everywhere(SCAN, BOARD_PORT)
        for board in self._boards:
            self._line.write_to(SCAN, board)

    def poll(self) -> None:
        """Take in what has been answered."""
        for received in self._line.read():
            message = parse(received.data)
            reply = None if isinstance(message, Refusal) else decode_scan_reply(message)
            if reply is not None:
                self.found[received.source] = reply

    def close(self) -> None:
        """Close the socket."""
        self._line.close()
