"""News of devices while they are driven with: lines that are lost, receivers that send too few epochs or spoofing."""

import datetime
import os
import tty
from pathlib import Path

import pytest

from drawbar.driving.stand_in.memory_transports import MemoryTransport
from drawbar.machine.hardware.device_news import LineNews, ReceiverNews
from drawbar.machine.hardware.receiver import Receiver, ReceiverSettings
from drawbar.machine.stand_in import nmea
from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.gnss.assembly import SPOOFED
from drawbar.transports.address import SerialAddress
from drawbar.transports.serial import SerialTransport

NAME = "tractor receiver"
BEGIN = datetime.datetime(2026, 11, 22, 12, tzinfo=datetime.UTC)


def test_a_line_that_is_unplugged_or_never_there_is_reported_once_and_when_it_is_back(tmp_path: Path) -> None:
    name, now, plugged, said = tmp_path / "receiver", [0.0], list[int](), list[str]()

    def plug() -> None:
        plugged[:] = os.openpty()
        for end in plugged:
            tty.setraw(end)
        name.symlink_to(os.ttyname(plugged[1]))
        os.close(plugged.pop())

    line = SerialTransport(SerialAddress(device=str(name), baud=115200), lambda: now[0])
    news = LineNews(NAME, line)
    for _ in range(2):  # not there, and unplugged
        for _ in range(50):
            now[0] += 0.1
            line.read()
            said += news.update()
        assert len(said) == 1
        plug()
        for _ in range(50):
            now[0] += 0.1
            line.read()
            said += news.update()
        assert said.pop() == f"{NAME}: it is connected again"
        assert said.pop().startswith(f"{NAME}: {name} ")
        name.unlink()
        os.close(plugged.pop())
    line.close()


def told(rate: float, epochs: int, *, lost: frozenset[int] = frozenset()) -> list[str]:
    """Return what is said of a receiver of a rate, Hz, of which some epochs are lost, where 5 Hz are needed."""
    wire = MemoryTransport()
    receiver = Receiver(wire, ReceiverSettings(transport="serial:/dev/ttyACM0@460800", latency=0.03))
    news, said = ReceiverNews(NAME, receiver, 0.2), list[str]()
    for i in range(epochs):
        if i not in lost:
            report = Report(time=BEGIN + datetime.timedelta(seconds=i / rate), latitude=50.0, longitude=4.0, height=0.0)
            wire.arrive(10.0 + i / rate, nmea.gga(report))
        for wait in (0.0, 0.03):
            receiver.poll(10.0 + i / rate + wait)
            said += news.update()
    return said


@pytest.mark.parametrize("rate", [1, 2, 4])
def test_a_receiver_that_is_too_slow_is_reported_once(rate: int) -> None:
    advice = f"it sends {rate}.0 epochs a second, the controller takes 5: set it to 5 Hz"
    assert told(rate, 40) == [f"{NAME}: {advice}"]


@pytest.mark.parametrize("rate", [5, 8, 10, 20])
def test_a_receiver_that_is_fast_enough_is_not_reported_though_epochs_are_lost(rate: int) -> None:
    assert told(rate, 60, lost=frozenset(range(20, 60, 3))) == []


def test_a_receiver_that_reports_spoofing_is_named_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Receiver, "dropped", {SPOOFED: 1})
    assert told(5, 5) == [f"{NAME}: it reports false satellite signals (spoofing), and counts as without a fix"]
