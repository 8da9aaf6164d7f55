"""Decoding: one intact frame into a message in SI, by the libraries' parsers; nothing that comes in raises.

A checksum proves that bytes arrived, not that they make sense: parsers raise declared and undeclared errors on frames
whose checksum is right. Each frame is parsed by itself, and what cannot be read is counted by kind.
"""

from collections import Counter

from pynmeagps import NMEAReader
from pysbf2 import SBFReader
from pyubx2 import UBXReader

from drawbar.protocols.gnss.boards import BOARDS
from drawbar.protocols.gnss.framing import Frame, Protocol
from drawbar.protocols.gnss.messages import Message
from drawbar.protocols.gnss.sbf import SBF, given
from drawbar.protocols.gnss.sentences import SENTENCES
from drawbar.protocols.gnss.ubx import UBX
from drawbar.protocols.gnss.values import Values

LEAP_SECONDS = 18
"""GPS time minus UTC since 2017, s"""
_DAY = 86_400_000
"""ms"""
_WEEK = 7 * _DAY
_UBX_FRAME = 8
"""bytes of a frame around its payload"""
_PROPRIETARY = {b"PSSN": b"HRP", b"PTNL": b"AVR"}
"""the only sentence of each vendor that is used"""


class Decoder:
    """Turns frames into messages; `dropped` counts what was not used, could not be read or cannot be meant."""

    dropped: Counter[str]

    def __init__(self, leap_seconds: int = LEAP_SECONDS) -> None:
        self.dropped = Counter()
        self._leap_seconds = leap_seconds
        self._decode = {Protocol.NMEA: self._nmea, Protocol.UBX: self._ubx, Protocol.SBF: self._sbf}

    def decode(self, frame: Frame) -> Message | None:
        """Return the message of an intact frame, None where it is not used or cannot be read."""
        decode = self._decode.get(frame.protocol)
        if decode is None:
            return None  # corrections that pass by
        try:
            return decode(frame.data)
        except Exception as error:  # parsers raise errors that they do not declare
            self.dropped[f"{frame.protocol.value} unreadable: {type(error).__name__}"] += 1
            return None

    def _nmea(self, data: bytes) -> Message | None:
        address, *fields = data[1:-3].split(b",")
        kind = _sentence(address, fields)
        if kind in BOARDS:
            return self._board(kind, [field.decode("ascii") for field in fields])
        if kind not in SENTENCES:
            self.dropped["NMEA of no use"] += 1
            return None
        sentence = SENTENCES[kind]
        if len(fields) < sentence.fields:
            self.dropped[f"{kind} cut short"] += 1
            return None
        parsed = NMEAReader.parse(data + b"\r\n")
        raw = {str(number): text for number, text in enumerate(parsed.payload, 1)}
        values = Values(kind, vars(parsed) | raw, self.dropped)
        utc = values.clock(sentence.clock) if sentence.clock else None
        return Message(kind=kind, utc=utc, contents=sentence.decode(values))

    def _board(self, kind: str, fields: list[str]) -> Message | None:
        board = BOARDS[kind]
        if len(fields) not in board.fields:
            self.dropped[f"{kind} with {len(fields)} fields"] += 1
            return None
        named = {str(number): text for number, text in enumerate(fields, 1)}
        values = Values(kind, named | {"time": fields[0][board.clock :]}, self.dropped)
        return Message(kind=kind, utc=values.clock("time"), contents=board.decode(values))

    def _ubx(self, data: bytes) -> Message | None:
        name, length, decode = UBX.get((data[2], data[3]), ("", 0, None))
        if decode is None:
            self.dropped["UBX of no use"] += 1
            return None
        if len(data) != length + _UBX_FRAME:
            self.dropped[f"{name} of another version"] += 1
            return None
        fields = vars(UBXReader.parse(data))
        return Message(
            kind=name, utc=self._day_time(name, fields["iTOW"]), contents=decode(Values(name, fields, self.dropped))
        )

    def _sbf(self, data: bytes) -> Message | None:
        name, least, decode = SBF.get(int.from_bytes(data[4:6], "little") & 0x1FFF, ("", 0, None))
        if decode is None:
            self.dropped["SBF of no use"] += 1
            return None
        if len(data) < least:
            self.dropped[f"{name} of another version"] += 1
            return None
        fields = vars(SBFReader.parse(data))
        values = Values(name, given(fields, len(data)), self.dropped)
        return Message(kind=name, utc=self._day_time(name, fields["TOW"]), contents=decode(values))

    def _day_time(self, kind: str, milliseconds: int) -> float | None:
        """Return a GPS time of week (ms) as seconds of the UTC day, None where it is none."""
        if not 0 <= milliseconds < _WEEK:
            self.dropped[f"{kind}: impossible time of week"] += 1
            return None
        return (milliseconds - 1000 * self._leap_seconds) % _DAY / 1000.0


def _sentence(address: bytes, fields: list[bytes]) -> str:
    """Return the name of a sentence whatever talker sent it."""
    if address[:1] == b"P" and address not in (b"PANDA", b"PAOGI"):
        name = _PROPRIETARY.get(address)
        return name.decode() if name is not None and fields[:1] == [name] else ""
    name = address if address in (b"PANDA", b"PAOGI", b"KSXT") else address[-3:] if len(address) == 5 else b""
    return name.decode("ascii")
