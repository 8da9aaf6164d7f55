"""Own sentences: what drawbar's small boards send and receive, in NMEA's form, `$NAME,FIELD,...*hh` CR LF. Pure."""

from collections import Counter
from collections.abc import Iterator

from drawbar.protocols.gnss.checksums import xor

_LONGEST = 64
"""bytes of a sentence"""


class SentenceReader:
    """Bytes of a stream in, fields out. Whatever comes, nothing raises; `dropped` counts what was not understood."""

    def __init__(self, name: str) -> None:
        """Take the sentences' name, such as PDBS."""
        self.dropped: Counter[str] = Counter()
        self._head, self._rest = f"${name},".encode("ascii"), b""

    def push(self, data: bytes) -> Iterator[list[bytes]]:
        """Take bytes; yield the fields of each sentence that they end."""
        *lines, rest = (self._rest + data).split(b"\n")
        if len(rest) > _LONGEST:
            self.dropped["too long"] += 1
            rest = rest[-_LONGEST:]  # the beginning of a sentence may be in it
        self._rest = rest
        for line in lines:
            fields = self._fields(line.rstrip(b"\r"))
            if isinstance(fields, str):
                self.dropped[fields] += 1
            else:
                yield fields

    def _fields(self, line: bytes) -> list[bytes] | str:
        """Return the fields of the sentence that a line ends with, or why it does with none."""
        line = line[max(line.rfind(self._head), 0) :]
        if not line.startswith(self._head) or len(line) > _LONGEST or line[-3:-2] != b"*":
            return "no sentence of this board"
        try:
            same = int(line[-2:], 16) == xor(line[1:-3])
        except ValueError:
            same = False
        return line[1:-3].split(b",")[1:] if same else "checksum"


def own_sentence(name: str, *fields: int | None) -> bytes:
    """Return a sentence of whole numbers; None: an empty field."""
    body = ",".join([name, *("" if field is None else str(field) for field in fields)]).encode("ascii")
    return b"$" + body + f"*{xor(body):02X}\r\n".encode("ascii")


def whole_number(field: bytes, *, signed: bool = False) -> int | None:
    """Return the number of a field, None where it is empty; raises ValueError where it is no whole number."""
    if not field:
        return None
    if not (field.removeprefix(b"-") if signed else field).isdigit() or len(field) > 10:
        raise ValueError
    return int(field)
