"""Identifiers: the 29 bits of an ISO 11783 frame, taken apart and put together (ISO 11783-3, J1939-21)."""

from dataclasses import dataclass

from drawbar.transports.base import CanFrame

GLOBAL = 0xFF
"""the destination that means all"""
NULL = 0xFE
"""the source address of who has none"""
_PEER_TO_PEER = 240
"""PDU formats below it carry a destination"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Message:
    """One frame, its identifier taken apart."""

    pgn: int
    """parameter group number; without the destination where it has one"""
    source: int
    """address of the sender, 0 to 255"""
    data: bytes
    """up to 8 bytes"""
    destination: int = GLOBAL
    """address it is meant for; `GLOBAL` for groups that carry none"""
    priority: int = 6
    """0 (first) to 7"""


def decode(frame: CanFrame) -> Message | None:
    """Return the frame taken apart, or None where its identifier or its length is none of ISO 11783."""
    if not (0 <= frame.identifier < 1 << 29) or len(frame.data) > 8:
        return None
    pgn, destination = (frame.identifier >> 8) & 0x3FFFF, GLOBAL
    if (pgn >> 8) & 0xFF < _PEER_TO_PEER:
        destination, pgn = pgn & 0xFF, pgn & 0x3FF00
    return Message(
        pgn=pgn,
        source=frame.identifier & 0xFF,
        data=frame.data,
        destination=destination,
        priority=frame.identifier >> 26,
    )


def encode(message: Message) -> CanFrame:
    """Return the message as a frame; the destination of a group that carries none is left out."""
    pgn = message.pgn
    if (pgn >> 8) & 0xFF < _PEER_TO_PEER:
        pgn |= message.destination
    return CanFrame(message.priority << 26 | pgn << 8 | message.source, message.data)
