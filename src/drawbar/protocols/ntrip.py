"""NTRIP, versions 1 and 2, the client's side: requests, replies, chunks and the position upload. Pure.

A reply is read by a state machine that takes bytes cut anywhere: `ReplyReader` finds out what the caster answers and
returns the stream's bytes, with HTTP's chunks taken apart. Whether a stream holds corrections its content decides.
"""

import base64
import re
from enum import Enum

LONGEST_HEAD = 8192
"""a caster that sends more before its stream begins is none, bytes"""
LONGEST_LINE = 256
"""of a chunk's size, or of a header that version 1 does not have, bytes"""


def ntrip_request(
    *, mount: str, host: str, port: int, agent: str, version: int, login: str = "", position: bytes = b""
) -> bytes:
    """Return the request for a mount point.

    Args:
        mount: mount point, without slash.
        host: the caster's name or address.
        port: its port.
        agent: program and version, such as `drawbar/0.2`.
        version: of NTRIP, 1 or 2.
        login: `user:password`; empty: the caster asks for none.
        position: a GGA sentence for version 2's header; empty: none.
    """
    name = f"[{host}]" if ":" in host else host
    lines = [f"GET /{mount} HTTP/1.{version - 1}", f"Host: {name}:{port}"]
    if version == 2:
        lines.append("Ntrip-Version: Ntrip/2.0")
    lines.append(f"User-Agent: NTRIP {agent}")
    if login:
        lines.append(f"Authorization: Basic {base64.b64encode(login.encode()).decode()}")
    if version == 2:
        if position:
            lines.append(f"Ntrip-GGA: {position.decode('ascii').strip()}")
        lines.append("Connection: close")
    return "\r\n".join([*lines, "", ""]).encode()


class Answer(Enum):
    """What a caster answers."""

    STREAM = "streams"
    SOURCE_TABLE = "sends its table of mount points instead of corrections"
    NO_LOGIN = "refuses the user name or the password"
    NO_MOUNT = "has no such mount point"
    REFUSED = "refuses the request"
    REDIRECT = "leads to another page"
    NONSENSE = "answers something that is not NTRIP"


_BY_CONTENT = {b"gnss/sourcetable": Answer.SOURCE_TABLE, b"text/html": Answer.NONSENSE}
"""by the type in HTTP's headers; a page is that of a modem, or of a network that asks for a login first"""
_BY_CODE = {200: Answer.STREAM, 401: Answer.NO_LOGIN, 403: Answer.NO_LOGIN, 404: Answer.NO_MOUNT}


class ReplyReader:
    """A caster's reply, from its first byte."""

    def __init__(self) -> None:
        self.answer: Answer | None = None
        """None until it is known"""
        self.code = 0
        """three digits of HTTP, 0 where there are none"""
        self.ended = False
        """no more bytes will come: the last chunk was there, or the chunks make no sense"""
        self._held = bytearray()
        self._in_body = False
        self._chunks: ChunkReader | None = None

    def feed(self, data: bytes) -> bytes:
        """Return the bytes of the stream that are in these bytes of the reply."""
        if self._in_body:
            return self._body(data)
        self._held += data
        if self.answer is None:
            self._read_head()
        if self.answer is Answer.STREAM and not self._in_body:
            self._skip_further_headers()
        if not self._in_body:
            return b""
        held, self._held = bytes(self._held), bytearray()
        return self._body(held)

    def _body(self, data: bytes) -> bytes:
        if self.answer is not Answer.STREAM:
            return b""
        if self._chunks is None:
            return data
        body = self._chunks.feed(data)
        self.ended = self._chunks.ended
        return body

    def _read_head(self) -> None:
        """Decide by the first line, and for HTTP's 200 by the headers after it."""
        line, end, _ = bytes(self._held).partition(b"\n")
        if not end:
            if len(self._held) > LONGEST_HEAD:
                self._decide(Answer.NONSENSE)
            return
        version_1 = re.match(rb"(?:ICY|HTTP/1\.\d) (\d{3})\b", line)
        self.code = int(version_1[1]) if version_1 else 0
        if version_1 and (self.code != 200 or line.startswith(b"ICY")):
            self._decide(_BY_CODE.get(self.code, Answer.REDIRECT if 300 <= self.code < 400 else Answer.REFUSED))
            del self._held[: len(line) + 1]
        elif version_1:
            self._read_headers()
        elif line.startswith(b"SOURCETABLE"):
            self._decide(Answer.SOURCE_TABLE)
        elif line.startswith(b"ERROR"):  # some casters of version 1: "ERROR - Bad Password"
            self._decide(Answer.NO_LOGIN if b"password" in line.lower() else Answer.REFUSED)
        else:
            self._decide(Answer.NONSENSE)

    def _decide(self, answer: Answer) -> None:
        self.answer = answer
        self._in_body = answer is not Answer.STREAM

    def _read_headers(self) -> None:
        head = re.match(rb"(.*?)\r?\n\r?\n", bytes(self._held), re.DOTALL)
        if not head:
            if len(self._held) > LONGEST_HEAD:
                self._decide(Answer.NONSENSE)
            return
        lines = [line.partition(b":") for line in head[1].lower().splitlines()[1:]]
        headers = {name.strip(): value.strip() for name, _, value in lines}
        kind = headers.get(b"content-type", b"").partition(b";")[0].strip()
        self.answer, self._in_body = _BY_CONTENT.get(kind, Answer.STREAM), True
        self._chunks = ChunkReader() if headers.get(b"transfer-encoding", b"").endswith(b"chunked") else None
        del self._held[: head.end()]

    def _skip_further_headers(self) -> None:
        """Skip what may stand between version 1's `ICY 200 OK` and the stream: an empty line, headers, or nothing."""
        while not self._in_body:
            empty = re.match(rb"\r?\n", self._held)
            header = re.match(rb"[A-Za-z][A-Za-z0-9-]*:[ -~]*\r?\n", self._held)
            skipped = empty or header
            if skipped:
                del self._held[: skipped.end()]
                self._in_body = bool(empty)
            elif len(self._held) <= LONGEST_LINE and re.fullmatch(
                rb"(?:[A-Za-z][A-Za-z0-9-]*(?::[ -~]*)?)?\r?", self._held
            ):
                return  # may yet become one of them
            else:
                self._in_body = True


class ChunkReader:
    """HTTP's chunked transfer coding (RFC 9112, 7.1) taken apart, whatever the pieces."""

    def __init__(self) -> None:
        self.ended = False
        """the last chunk was there, or what came is no chunk"""
        self.broken = False
        """what came is no chunk"""
        self._line = bytearray()
        self._left = 0
        """bytes of the chunk still to come"""
        self._behind = False
        """the line end behind a chunk is expected"""

    def feed(self, data: bytes) -> bytes:
        """Return the bytes of the body that are in these bytes."""
        body = bytearray()
        position = 0
        while position < len(data) and not self.ended:
            if self._left:
                piece = data[position : position + self._left]
                body += piece
                position += len(piece)
                self._left -= len(piece)
                self._behind = not self._left
            else:
                end = data.find(b"\n", position) + 1 or len(data)
                self._line += data[position:end]
                position = end
                self._read_line()
        return bytes(body)

    def _read_line(self) -> None:
        """Read the line before or behind a chunk, once it is whole."""
        if not self._line.endswith(b"\n"):
            self._give_up(len(self._line) > LONGEST_LINE)
            return
        line = bytes(self._line.rstrip(b"\r\n"))
        self._line.clear()
        if self._behind:
            self._behind = False
            self._give_up(line != b"")
            return
        size = re.match(rb"([0-9A-Fa-f]{1,8})[ \t]*(?:;|$)", line)
        self._give_up(size is None)
        self._left = int(size[1], 16) if size else 0
        self.ended = self.ended or not self._left

    def _give_up(self, broken: bool) -> None:
        self.broken = self.broken or broken
        self.ended = self.ended or broken


def upload_of(sentence: bytes) -> bytes:
    """Return a receiver's own GGA sentence as casters take it, or nothing where it is none or has no fix.

    The checksum must be right; the talker becomes GP, because some casters know no other.
    """
    match = re.fullmatch(rb"\$(..GGA,([ -)+-~]*))\*([0-9A-Fa-f]{2})\s*", sentence)
    if not match or _checksum(match[1]) != int(match[3], 16):
        return b""
    fields = match[2].split(b",")
    if len(fields) != 14 or not re.fullmatch(rb"[1-9]", fields[5]) or not all(fields[:5]):
        return b""
    return _sentence(b"GPGGA," + match[2])


def gga_sentence(
    *,
    time_of_day: float,
    latitude: float,
    longitude: float,
    quality: int,
    satellites: int,
    dilution: float,
    height: float,
    separation: float,
) -> bytes:
    """Return the GGA sentence of a position, for receivers that send no NMEA.

    Args:
        time_of_day: UTC, s.
        latitude: WGS84, rad, north positive.
        longitude: WGS84, rad, east positive.
        quality: GGA's own, 1 to 9; 0 (no fix) must not be sent to a caster.
        satellites: how many are used.
        dilution: horizontal dilution of precision.
        height: over the geoid, m.
        separation: of the geoid from the ellipsoid, m.

    Raises:
        ValueError: no fix, or a number that no position has.
    """
    if not (1 <= quality <= 9 and abs(latitude) <= _QUARTER and abs(longitude) <= 2 * _QUARTER and satellites >= 0):
        raise ValueError(f"quality {quality} at {latitude} rad, {longitude} rad is no position for a caster")
    if not (0.0 <= time_of_day < 86401.0 and abs(height) < 1e5 and abs(separation) < 1e3 and 0.0 <= dilution < 1e3):
        given = f"time {time_of_day} s, height {height} m, separation {separation} m, dilution {dilution}"
        raise ValueError(f"{given}: not all of them are a position's")
    hundredths = round(time_of_day * 100.0) % 8640000
    clock = (
        f"{hundredths // 360000:02d}{hundredths // 6000 % 60:02d}{hundredths % 6000 // 100:02d}.{hundredths % 100:02d}"
    )
    place = f"{_degrees(latitude, 2)},{'NS'[latitude < 0]},{_degrees(longitude, 3)},{'EW'[longitude < 0]}"
    rest = f"{quality},{satellites:02d},{dilution:.1f},{height:.3f},M,{separation:.3f},M,,"
    return _sentence(f"GPGGA,{clock},{place},{rest}".encode())


_QUARTER = 1.5707963267948966
"""of a turn, rad"""
_MINUTE = 10_000_000
"""seven decimals: 0.19 mm"""


def _degrees(angle: float, digits: int) -> str:
    """Return `dddmm.mmmmmmm` with so many digits of degrees; whole numbers, so that no minute becomes 60."""
    parts = round(abs(angle) / _QUARTER * 90 * 60 * _MINUTE)
    degrees, minutes = divmod(parts, 60 * _MINUTE)
    return f"{degrees:0{digits}d}{minutes // _MINUTE:02d}.{minutes % _MINUTE:07d}"


def _checksum(body: bytes) -> int:
    value = 0
    for byte in body:
        value ^= byte
    return value


def _sentence(body: bytes) -> bytes:
    return b"$" + body + f"*{_checksum(body):02X}\r\n".encode()
