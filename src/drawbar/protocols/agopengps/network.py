"""Network messages: hello (200), scan (202) and its reply (203)."""

from dataclasses import dataclass

from drawbar.protocols.agopengps.frame import COMPUTER, STEER_BOARD, Frame, Pgn, pack

BOARD_PORT = 8888
"""where boards listen"""
COMPUTER_PORT = 9999
"""where boards send to; AiO_26 obeys what is sent from this port only"""
STEER_HOST = 126
"""last number of a steer board's address, the same on every AIO v4"""
HELLO_PERIOD = 2.0
"""between two hellos, s"""

HELLO = pack(COMPUTER, Pgn.HELLO, b"\x38\x00\x00")
"""asks boards for a sign of life"""
SCAN = pack(COMPUTER, Pgn.SCAN, b"\xca\xca\x05")
"""asks boards for their addresses; for 255.255.255.255"""


_KINDS = {STEER_BOARD: "steer board", 0x7B: "machine board", 0x79: "IMU board", 0x78: "GNSS board"}


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanReply:
    """Where a board is (203)."""

    board: int
    """its source byte"""
    address: str
    subnet: str
    """the first three numbers of the asker's address"""

    @property
    def kind(self) -> str:
        """What kind of board it is, in words."""
        return _KINDS.get(self.board, f"board of kind {self.board:02X}")


def decode_scan_reply(frame: Frame) -> ScanReply | None:
    """Return where a board is; None: not such a message."""
    if (frame.pgn, len(frame.data)) != (Pgn.SCAN_REPLY, 7):
        return None
    numbers = [str(number) for number in frame.data]
    return ScanReply(board=frame.source, address=".".join(numbers[:4]), subnet=".".join(numbers[4:]))
