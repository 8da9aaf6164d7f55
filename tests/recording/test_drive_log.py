"""The log of a drive: what is written is read again, its size in an hour, and what is no such log."""

import dataclasses
import math
from collections import Counter
from itertools import islice

import pytest
from drive_messages import ready_gate
from mcap.reader import make_reader

from drawbar.config import load_configuration
from drawbar.errors import DrawbarError
from drawbar.geometry import LocalFrame
from drawbar.messages.records import encode
from drawbar.recording.drive_log import DriveLog
from drawbar.recording.drive_records import Happening, Kind, Order, RawBytes, is_drive, open_drive
from drawbar.recording.header import run_header
from drawbar.recording.log import Outcome, read_log
from drawbar.recording.recorder import Recorder
from drawbar.recording.scene import Scene
from drawbar.signals import Status
from drawbar.simulation import build_path
from drawbar.transports.tapped import Direction

NAN = math.nan


def test_what_was_recorded_of_a_drive_is_read_again(tmp_path):
    configuration = load_configuration("articulated")
    path, _ = build_path(configuration)
    frame = LocalFrame(latitude=50.0, longitude=4.0)
    header = run_header(configuration, path, None, seed=0, frame=frame)
    state = ready_gate(sequence=7)
    raw = [
        RawBytes(time=5, device="sensors", direction=Direction.IN, data=b"\x00\xff", source="127.0.0.1:9999"),
        RawBytes(time=7, device="tractor_receiver", direction=Direction.UNSENT, data=b""),
    ]
    look = Happening(kind=Kind.LOOK, time=123456789)
    with DriveLog(tmp_path / "log.mcap", header, Scene(path=path, vehicle=configuration.vehicle, frame=frame)) as log:
        for each in raw:
            log.add_raw(each)
        waiting = log.flushed
        log.flush()
        assert log.flushed > waiting, "the recorder need not flush by itself so soon"
        with open_drive(tmp_path / "log.mcap") as records:  # as a kill at this moment would leave it
            assert list(records) == raw
        log.add_order(Order((look,)))
        log.add_order(Order((look,)))
        log.flush()
        for _ in range(2):
            log.add_message(state)
    assert is_drive(tmp_path / "log.mcap")
    with open_drive(tmp_path / "log.mcap") as records:
        read = list(records)
    assert read[:4] == [*raw, look, look]
    assert len(read) == 6
    assert isinstance(read[5], Outcome)
    assert encode(read[4]) == encode(state)
    with (tmp_path / "log.mcap").open("rb") as stream:
        topics = Counter(channel.topic for _, channel, _ in make_reader(stream).iter_messages())
    assert topics["/raw"] == topics["/order"] == 1  # each message has 16 bytes of the index
    assert (
        read_log(tmp_path / "log.mcap").outcome.reason
        == "the drive was ended before the end of the path; drawbar never steered"
    )


def test_a_drives_steps_and_what_is_drawn_of_them_fill_few_megabytes_an_hour(tmp_path, build):
    simulation, frame = build("articulated"), LocalFrame(latitude=50.0, longitude=4.0)
    scene = Scene(path=simulation.path, vehicle=simulation.configuration.vehicle, frame=frame)
    file, steps = tmp_path / "log.mcap", 400
    with DriveLog(file, simulation.header(), scene) as log:
        begin = file.stat().st_size
        for record in islice(simulation.steps(), steps):
            log.add_step(round(record.measurement.time * 1e9), record)
    hourly = 3600.0 / simulation.configuration.sample_time * (file.stat().st_size - begin) / steps * 1e-6
    print(f"\n{hourly:.1f} MB an hour")
    assert hourly < 22.0
    with file.open("rb") as stream:
        topics = Counter(channel.topic for _, channel, _ in make_reader(stream).iter_messages())
    assert topics == dict.fromkeys(("/step", "/tf", "/plan", "/tractor/fix", "/trailer/fix"), steps) | {
        "/path": 1,
        "/bodies": 1,
    }


def test_a_runs_log_fills_less_than_40_megabytes_an_hour(tmp_path, build):
    simulation, file, steps = build("articulated"), tmp_path / "log.mcap", 900
    with Recorder(file, simulation.header()) as log:
        begin = file.stat().st_size
        for record in islice(simulation.steps(), steps):
            log.write(record)
    hourly = 3600.0 / simulation.configuration.sample_time * (file.stat().st_size - begin) / steps * 1e-6
    assert 15.0 < hourly < 40.0


def test_a_drive_of_an_earlier_drawbar_is_refused_by_name(tmp_path, build):
    simulation, frame = build("articulated"), LocalFrame(latitude=50.0, longitude=4.0)
    scene = Scene(path=simulation.path, vehicle=simulation.configuration.vehicle, frame=frame)
    with DriveLog(tmp_path / "log.mcap", simulation.header(), scene) as log:
        log._add_plain("/raw/sensors", b"", 10**9)
    with open_drive(tmp_path / "log.mcap") as records, pytest.raises(DrawbarError, match="an earlier drawbar wrote it"):
        list(records)


@pytest.mark.parametrize("status", [Status.OK, Status.FINISHED])
def test_a_drive_has_finished_where_its_path_has_ended(tmp_path, build, status):
    simulation, frame = build("articulated"), LocalFrame(latitude=50.0, longitude=4.0)
    scene = Scene(path=simulation.path, vehicle=simulation.configuration.vehicle, frame=frame)
    record = dataclasses.replace(next(iter(simulation.steps())), status=status)
    with DriveLog(tmp_path / "log.mcap", simulation.header(), scene) as log:
        log.add_step(10**9, record)
    assert read_log(tmp_path / "log.mcap").outcome.finished == (status is Status.FINISHED)


def test_a_simulated_run_is_no_drive(tmp_path):
    configuration = load_configuration("articulated")
    path, _ = build_path(configuration)
    with Recorder(tmp_path / "log.mcap", run_header(configuration, path, None, seed=0)):
        pass
    assert not is_drive(tmp_path / "log.mcap")
