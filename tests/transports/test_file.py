"""Recordings played back: every piece, in order, as much later as it came; files that are none."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from waiting import FakeClock

from drawbar.errors import HardwareError
from drawbar.transports.address import FileAddress
from drawbar.transports.base import Received
from drawbar.transports.file import FileTransport, piece_of

PIECES = [Received(20.0, b"a"), Received(20.5, b"", "10.0.0.1:5120"), Received(20.5, b"\x00\xff"), Received(22.0, b"d")]


def recorded_line(piece: Received) -> str:
    return f"{piece.time!r} {piece.data.hex() or '-'} {piece.source}".rstrip()


def recording(folder: Path, *lines: str) -> FileAddress:
    (folder / "recording.txt").write_text("\n".join(lines) + "\n")
    return FileAddress(path=str(folder / "recording.txt"))


@pytest.mark.parametrize("path", ["/dev/zero", "/dev"])
def test_what_is_no_file_is_refused_and_not_read_for_ever(path: str) -> None:
    with pytest.raises(HardwareError, match=rf"{path}: is no file; a serial line is written serial:"):
        FileTransport(FileAddress(path=path))


def test_pieces_come_as_much_later_as_they_came(tmp_path: Path) -> None:
    clock = FakeClock(1000.0)
    transport = FileTransport(recording(tmp_path, *map(recorded_line, PIECES)), clock)
    assert transport.read() == [Received(1000.0, b"a")]
    clock.now = 1000.49
    assert transport.read() == []
    clock.now = 1000.6
    assert transport.read() == [Received(1000.5, b"", "10.0.0.1:5120"), Received(1000.5, b"\x00\xff")]
    assert transport.connected
    clock.now = 1005.0
    assert transport.read() == [Received(1002.0, b"d")]
    assert not transport.connected
    assert transport.trouble.endswith("has ended")
    assert transport.read() == []
    assert not transport.write(b"abc")
    assert transport.unsent == 3
    assert transport.fileno() == -1
    transport.close()


@pytest.mark.parametrize("line", ["20.0 0g", "nan 00", "20.0", "", "x 00", "20.0 00 a b", "20.0 000"])
def test_line_that_is_no_piece_ends_the_recording(tmp_path: Path, line: str) -> None:
    transport = FileTransport(recording(tmp_path, "20.0 aa", line, "20.0 bb"), FakeClock())
    assert [piece.data for piece in transport.read()] == [b"\xaa"]
    assert not transport.connected
    assert "line 2 is not" in transport.trouble
    transport.close()


def test_missing_recording_is_refused(tmp_path: Path) -> None:
    with pytest.raises(HardwareError, match="cannot be read"):
        FileTransport(FileAddress(path=str(tmp_path / "none")))


@settings(derandomize=True, deadline=None)
@given(st.floats(allow_nan=False, allow_infinity=False), st.binary(min_size=1), st.sampled_from(["", "127.0.0.1:9"]))
def test_what_is_recorded_is_what_is_played(time: float, data: bytes, source: str) -> None:
    received = Received(time, data, source)
    assert piece_of(recorded_line(received)) == received
