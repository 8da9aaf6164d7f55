"""A disk that is slow, or takes nothing more, and the recorder's thread that writes."""

import threading
import time

import pytest

from drawbar.driving.messaging.datagrams import PackedStep
from drawbar.driving.processes import background_writer
from drawbar.driving.processes.background_writer import BackgroundWriter
from drawbar.errors import StorageError
from drawbar.recording.drive_records import RawBytes
from drawbar.transports.tapped import Direction


class SlowLog:
    """A log on a disk that takes nothing until it is let."""

    flushed = 0

    def __init__(self):
        self.added, self.written, self.gave_up = [], [], False
        self.disk = threading.Event()
        self.error, self.is_in_place = None, True

    def add_raw(self, raw):
        self.added.append(raw.time)

    def add_step(self, moment, record):
        self.added.append(moment)

    def flush(self):
        self.disk.wait()
        if self.error:
            raise self.error
        self.written.append(self.added)
        self.added = []

    def give_up(self):
        self.gave_up = True


def step(moment):
    return PackedStep(time=moment, data=b""), 1000


def raw(moment):
    return RawBytes(time=moment, device="sensors", direction=Direction.IN, source="", data=b""), 10


@pytest.fixture
def log(monkeypatch):
    monkeypatch.setattr(background_writer, "unpacked", lambda data: None)
    monkeypatch.setattr(background_writer, "BUSY", 0.05)
    return SlowLog()


def writer_of(log):
    return BackgroundWriter(log, lambda: 0)


def await_that(holds):
    end = time.monotonic() + 5.0
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.002)


def test_what_comes_while_the_disk_is_busy_is_written_in_one_go_and_in_order(log):
    writer = writer_of(log)
    writer.put([step(0)])
    await_that(lambda: log.added)
    for moment in range(1, 7):
        writer.put([step(moment), raw(10 * moment)])
    log.disk.set()
    writer.close()
    assert log.written == [[0], [1, 10, 2, 20, 3, 30, 4, 40, 5, 50, 6, 60]]
    assert not writer.lost


def test_nobody_waits_for_a_disk_that_hangs_and_it_does_not_count_as_recorded(log):
    writer = writer_of(log)
    assert writer.writes
    writer.put([step(0)])
    await_that(lambda: not writer.writes)
    begin = time.monotonic()
    writer.put([step(1)])
    assert time.monotonic() - begin < 0.5
    log.disk.set()
    await_that(lambda: writer.writes)
    writer.close()
    assert log.written == [[0], [1]]


def test_a_log_that_is_elsewhere_is_written_on_and_does_not_count_as_recorded(log, capfd):
    log.disk.set()
    writer = writer_of(log)

    def put(moment):
        writer.put([step(moment)])
        await_that(lambda: log.written[-1:] == [[moment]] and writer.writes is log.is_in_place)

    for moment, log.is_in_place in enumerate((True, False, False, True)):
        put(moment)
    writer.close()
    assert log.written == [[0], [1], [2], [3]]
    told = "recorder: the log's folder was moved, or its disk unmounted; it is written on wherever it is now\n"
    assert capfd.readouterr().err == told


def test_what_is_too_much_for_the_memory_is_lost_and_that_is_said_once(log, monkeypatch, capfd):
    monkeypatch.setattr(background_writer, "MOST", 3500)
    writer = writer_of(log)
    writer.put([step(0)])
    await_that(lambda: log.added)
    writer.put([step(moment) for moment in range(1, 6)])
    assert writer.lost == 2
    assert not writer.writes
    log.disk.set()
    writer.close()
    assert log.written == [[0], [1, 2, 3]]
    assert capfd.readouterr().err == "recorder: the disk is too slow, and what it has not taken is lost\n"


@pytest.mark.parametrize("error", [OSError(5, "Input/output error"), StorageError("log.mcap: it was removed")])
def test_nothing_is_added_behind_what_could_not_be_written(log, capfd, error):
    log.error = error
    log.disk.set()
    writer = writer_of(log)
    writer.put([step(0)])
    await_that(lambda: log.gave_up)
    writer.put([step(1)])
    writer.close()
    assert log.added == [0]
    assert not writer.writes
    assert f"the log cannot be written any further ({error})" in capfd.readouterr().err


def test_a_fault_of_the_program_ends_the_recorder(log):
    log.error = RuntimeError("a fault of the program")
    log.disk.set()
    writer = writer_of(log)
    writer.put([step(0)])
    await_that(lambda: not writer.writes)
    with pytest.raises(RuntimeError, match="a fault of the program"):
        writer.put([step(1)])
