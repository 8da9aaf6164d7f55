"""Serial lines on real ptys: bytes both ways, an unplugged device, a line that takes no more; never a wait."""

import errno
import os
import pty
import select
import termios
import time
import tty
from collections.abc import Iterator
from pathlib import Path

import pytest
import serial
from waiting import FakeClock, until

from drawbar.transports.address import SerialAddress
from drawbar.transports.open import open_transport
from drawbar.transports.serial import RETRY, SerialTransport


class Line:
    """A pty under a path of its own, as a USB adapter has one, that can be unplugged and plugged in again."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.plug()

    def plug(self) -> None:
        self.far, self._near = pty.openpty()
        tty.setraw(self.far)
        tty.setraw(self._near)
        self.path.symlink_to(os.ttyname(self._near))

    def unplug(self) -> None:
        self.path.unlink()
        os.close(self._near)
        os.close(self.far)


def read_all(far: int, count: int) -> bytes:
    """Return so many bytes, which come out of a line in pieces."""
    data = b""
    while len(data) < count:
        data += os.read(far, count - len(data))
    return data


@pytest.fixture
def line(tmp_path: Path) -> Iterator[Line]:
    line = Line(tmp_path / "ttyUSB0")
    yield line
    line.unplug()


def test_bytes_cross_both_ways_unchanged(line: Line) -> None:
    transport = open_transport(f"serial:{line.path}@460800")
    assert transport.connected
    every = bytes(range(256))
    for start in range(0, 256, 7):
        os.write(line.far, every[start : start + 7])
    arrived = bytearray()

    def look() -> bool:
        arrived.extend(b"".join(piece.data for piece in transport.read()))
        return len(arrived) >= 256

    until(look)
    assert bytes(arrived) == every
    assert transport.write(every)
    assert read_all(line.far, len(every)) == every
    assert transport.read() == []
    transport.close()
    assert not transport.connected
    assert transport.fileno() == -1


def test_a_device_that_goes_while_it_is_opened_is_tried_again(line: Line, monkeypatch: pytest.MonkeyPatch) -> None:
    def gone(descriptor: int, queue: int) -> None:
        raise termios.error(errno.EIO, "Input/output error")

    clock = FakeClock()
    with monkeypatch.context() as patch:
        patch.setattr(termios, "tcflush", gone)
        transport = SerialTransport(SerialAddress(device=str(line.path), baud=115200), clock)
    assert not transport.connected
    assert transport.trouble == f"{line.path} cannot be opened: Input/output error"
    clock.now += RETRY
    transport.read()
    assert transport.connected
    transport.close()


def test_unplugged_device_is_noticed_and_opened_again(line: Line) -> None:
    clock = FakeClock()
    transport = SerialTransport(SerialAddress(device=str(line.path), baud=115200), clock)
    line.unplug()
    assert transport.read() == []
    assert not transport.connected
    assert "is lost" in transport.trouble
    assert not transport.write(b"gone")
    assert transport.unsent == 4
    line.plug()
    transport.read()
    assert not transport.connected, "it is not asked again at once"
    clock.now += RETRY
    transport.read()
    assert transport.connected
    assert transport.trouble == ""
    os.write(line.far, b"again")
    (piece,) = until(transport.read)
    assert (piece.data, piece.time, piece.source) == (b"again", clock.now, "")
    transport.close()


def test_device_that_is_not_there_is_reported_and_tried_again(tmp_path: Path) -> None:
    clock = FakeClock()
    transport = SerialTransport(SerialAddress(device=str(tmp_path / "none"), baud=115200), clock)
    assert not transport.connected
    assert transport.trouble == f"{tmp_path / 'none'} cannot be opened: No such file or directory"
    assert transport.read() == []
    assert transport.fileno() == -1
    line = Line(tmp_path / "none")
    clock.now += RETRY
    transport.read()
    assert transport.connected
    transport.close()
    line.unplug()


def test_what_is_no_serial_line_is_reported() -> None:
    transport = SerialTransport(SerialAddress(device="/dev/null", baud=115200), FakeClock())
    assert transport.trouble == "/dev/null cannot be opened: it is no serial line"


def test_what_was_sent_last_leaves_before_the_line_is_closed(line: Line) -> None:
    transport = open_transport(f"serial:{line.path}@115200")
    assert transport.write(b"$PDBD,0*32\r\n")
    transport.close()
    assert select.select([line.far], [], [], 5.0)[0]
    assert read_all(line.far, 12) == b"$PDBD,0*32\r\n"


@pytest.mark.parametrize("still", [3, 10**9])
def test_a_line_that_is_closed_is_waited_for_until_it_has_sent_all_but_not_for_long(line: Line, still: int) -> None:
    transport, looks, dropped = SerialTransport(SerialAddress(device=str(line.path), baud=115200)), [], []
    port = transport._port

    class Port:
        """The port, of which bytes leave slowly."""

        @property
        def out_waiting(self) -> int:
            looks.append(1)
            return max(0, still - len(looks))

        def reset_output_buffer(self) -> None:
            dropped.append(1)

        def close(self) -> None:
            port.close()

    transport._port = Port()
    began = time.monotonic()
    transport.close()
    assert time.monotonic() - began < 1.0
    assert len(looks) >= 3
    assert bool(dropped) is (still > 3)


def test_a_device_that_one_may_not_open_is_reported_with_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise serial.SerialException(errno.EACCES, "could not open port: Permission denied")

    monkeypatch.setattr(serial, "Serial", refuse)
    trouble = SerialTransport(SerialAddress(device="/dev/ttyUSB0", baud=115200), FakeClock()).trouble
    assert trouble == (
        "/dev/ttyUSB0 cannot be opened: you may not open it; add your user to its group (ls -l /dev/ttyUSB0; often "
        "dialout), and log in again"
    )


def test_bytes_a_full_line_does_not_take_are_counted_and_dropped(line: Line) -> None:
    transport = open_transport(f"serial:{line.path}@9600")
    flood = bytes(1 << 20)
    assert not transport.write(flood)
    assert "takes no more bytes" in transport.trouble
    taken = len(flood) - transport.unsent
    assert taken > 0
    read_all(line.far, taken)
    transport.write(b"end")
    assert read_all(line.far, 3) == b"end", "nothing was queued"
    transport.close()


def real_adapters() -> list[Path]:
    folder = Path("/dev/serial/by-id")
    return sorted(folder.iterdir()) if folder.is_dir() else []


def test_real_adapter_is_opened_by_one_program_only() -> None:
    if not real_adapters():
        pytest.skip(
            "no USB serial adapter is plugged in (/dev/serial/by-id is missing); ptys do not refuse a second open"
        )
    address = SerialAddress(device=str(real_adapters()[0]), baud=115200)
    first, second = SerialTransport(address), SerialTransport(address)
    assert first.connected
    assert first.low_latency
    assert not second.connected
    assert "another program has it open" in second.trouble
    first.close()
