import dataclasses
import os
import pathlib
import signal
import subprocess
import sys

import arbitrary_logs
import numpy as np
import pytest
from arbitrary_logs import arbitrary_step, assert_identical, header, write, write_as_json
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from drawbar.errors import DrawbarError, StorageError
from drawbar.guidance.figure_eight import figure_eights
from drawbar.recording import chunk
from drawbar.recording.log import read_log
from drawbar.recording.path_table import RecordedPoints
from drawbar.recording.recorder import Recorder
from drawbar.recording.table import number_names


def test_every_field_survives_the_round_trip(tmp_path):
    records = write(tmp_path / "log.mcap", 50)
    log = read_log(tmp_path / "log.mcap")
    assert len(log.records) == 50
    for written, read in zip(records, log.records, strict=True):
        assert_identical(written, read)
    assert_identical(log.header, header())
    assert log.outcome.finished
    assert np.all(np.diff(log.wall_time) >= 0.0)


def test_a_log_is_found_in_the_folder_of_its_run(tmp_path):
    write(tmp_path / "log.mcap", 1)
    assert len(read_log(tmp_path).records) == 1
    with pytest.raises(DrawbarError, match=r"nothing: cannot be read"):
        read_log(tmp_path / "nothing")


def test_the_path_can_be_made_again_exactly(tmp_path):
    write(tmp_path / "log.mcap", 1)
    path = read_log(tmp_path / "log.mcap").header.path.path()
    assert_identical(path, figure_eights([1.0], 1.0))


def test_a_run_without_truth_reads_back_without_truth(tmp_path):
    record = dataclasses.replace(arbitrary_step(1), truth=None)
    with Recorder(tmp_path / "log.mcap", header()) as recorder:
        recorder.write(record)
    log = read_log(tmp_path / "log.mcap")
    assert log.records[0].truth is None
    assert np.isnan(log.column("truth.tractor.x")).all()
    assert log.column("command.time") == [record.command.time]


def test_numpy_scalars_are_numbers(tmp_path):
    step = arbitrary_step(2)
    steering = dataclasses.replace(step.tractor_steering, nominal=np.float64(0.25), saturated=np.bool_(True))
    with Recorder(tmp_path / "log.mcap", header()) as recorder:
        recorder.write(dataclasses.replace(step, tractor_steering=steering))
    read = read_log(tmp_path / "log.mcap").records[0].tractor_steering
    assert (read.nominal, read.saturated) == (0.25, True)


def test_any_mcap_tool_reads_the_log(tmp_path):
    records = write(tmp_path / "log.mcap", 3)
    with (tmp_path / "log.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        messages = list(reader.iter_decoded_messages(topics=["/step"], log_time_order=False))
    for (_, _, message, decoded), record in zip(messages, records, strict=True):
        assert message.log_time == round(record.measurement.time * 1e9)
        for name in number_names(record):
            if name.endswith(".deviation.2") or not name.rpartition(".")[2].isdigit():
                np.testing.assert_equal(float(value_of(decoded, name)), float(value_of(record, name)), err_msg=name)
        for body in ("tractor", "trailer"):
            poses = getattr(record.plan, body).poses
            np.testing.assert_array_equal(np.reshape(getattr(decoded.plan, body).poses, poses.shape), poses)


def value_of(signal, name):
    """Return a number by its dotted name."""
    for part in name.split("."):
        signal = signal[int(part)] if part.isdigit() else getattr(signal, part)
    return signal


def test_an_exception_becomes_the_outcome_and_travels_on(tmp_path):
    def run():
        with Recorder(tmp_path / "log.mcap", header()) as recorder:
            recorder.write(arbitrary_step(0))
            _ = 1 / 0

    with pytest.raises(ZeroDivisionError):
        run()
    log = read_log(tmp_path / "log.mcap")
    assert len(log.records) == 1
    assert not log.outcome.finished
    assert log.outcome.reason == "ZeroDivisionError: division by zero"


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (DrawbarError("At 3.0 s it was lost."), "At 3.0 s it was lost."),
        (KeyboardInterrupt(), "interrupted at the keyboard"),
    ],
)
def test_what_a_user_is_meant_to_read_has_no_class_name(tmp_path, error, reason):
    with pytest.raises(type(error)), Recorder(tmp_path / "log.mcap", header()):
        raise error
    assert read_log(tmp_path / "log.mcap").outcome.reason == reason


@pytest.mark.parametrize("count", [2, 3000, 3001, 100_003])
def test_recorded_points_are_few_and_the_worst_is_among_them(count):
    points = np.column_stack([np.arange(count), -np.arange(count)]).astype(float)
    worst = count * 2 // 3
    deviations = np.where(np.arange(count) == worst, 0.4, 0.1)
    recorded = RecordedPoints.of(points, deviations)
    assert min(count, 1500) <= len(recorded.points) <= 3001
    assert recorded.points[recorded.worst, 0] == worst
    assert recorded.deviation == 0.4
    assert recorded.points[0, 0] == 0.0
    assert np.diff(recorded.points[:, 0]).max() <= np.ceil(count / 3000)


def test_one_run_at_a_time_records_into_a_file(tmp_path):
    """A second one loses nothing of the first; it may once that has ended."""
    file = tmp_path / "log.mcap"
    with Recorder(file, header()) as recorder:
        recorder.write(arbitrary_step(1))
        with pytest.raises(StorageError, match=r"another run is recorded there; wait until it has ended, or choose"):
            Recorder(file, header())
        recorder.write(arbitrary_step(2))
    assert len(read_log(file).records) == 2
    assert len(write(file, 1)) == len(read_log(file).records)


def test_a_killed_process_leaves_every_step_of_a_real_machine(tmp_path):
    script = f"""
import os, signal, sys, time
sys.path.insert(0, {str(pathlib.Path(arbitrary_logs.__file__).parent)!r})
import pathlib
import arbitrary_logs as t
recorder = t.Recorder(pathlib.Path({str(tmp_path / "log.mcap")!r}), t.header())
for seed in range(7):
    step = t.arbitrary_step(seed)
    time.sleep(0.02)
    recorder.write(step)
os.kill(os.getpid(), signal.SIGKILL)
"""
    killed = subprocess.run([sys.executable, "-c", script], env=os.environ, check=False)
    assert killed.returncode == -signal.SIGKILL
    log = read_log(tmp_path / "log.mcap")
    for seed, read in enumerate(log.records):
        assert_identical(arbitrary_step(seed), read)
    assert len(log.records) == 7
    assert not log.outcome.finished
    assert "killed" in log.outcome.reason


def test_steps_that_come_fast_wait_20_milliseconds_at_most(tmp_path, monkeypatch):
    now, file = 10**9, tmp_path / "log.mcap"
    monkeypatch.setattr("drawbar.recording.recorder.time.time_ns", lambda: now)
    with Recorder(file, header()) as recorder:
        for seed, (milliseconds, kept) in enumerate([(0, 1), (10, 1), (9, 1), (1, 4), (19, 4), (1, 6)]):
            now += milliseconds * 1_000_000
            recorder.write(arbitrary_step(seed))
            assert len(read_log(file).records) == kept
    assert len(read_log(file).records) == 6


def test_steps_that_come_fast_are_not_written_twice(tmp_path, monkeypatch):
    now = 10**9
    monkeypatch.setattr(chunk, "CHUNK_BYTES", 20_000)
    monkeypatch.setattr("drawbar.recording.recorder.time.time_ns", lambda: now)
    with Recorder(tmp_path / "log.mcap", header()) as recorder:
        for seed in range(200):
            now += 3_000_000
            recorder.write(arbitrary_step(seed))
    with (tmp_path / "log.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    chunked = sum(each.chunk_length + each.message_index_length for each in summary.chunk_indexes)
    begin = summary.chunk_indexes[0].chunk_start_offset
    end = summary.chunk_indexes[-1].chunk_start_offset
    assert end - begin < chunked < (tmp_path / "log.mcap").stat().st_size
    assert len(read_log(tmp_path / "log.mcap").records) == 200


def test_a_log_of_several_chunks_is_whole_indexed_and_readable_at_any_moment(tmp_path, monkeypatch, every_step_at_once):
    monkeypatch.setattr(chunk, "CHUNK_BYTES", 3_000)  # two or three steps
    file = tmp_path / "log.mcap"
    with Recorder(file, header()) as recorder:
        for seed in range(20):
            recorder.write(arbitrary_step(seed))
            assert len(read_log(file).records) == seed + 1  # as a kill at this moment would leave it
    assert read_log(file).outcome.finished
    with file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert len(list(reader.iter_messages(topics=["/step"]))) == 20
        summary = reader.get_summary()
    assert summary.statistics.message_count == 20
    assert summary.statistics.chunk_count == len(summary.chunk_indexes) > 5


def test_logs_of_earlier_versions_are_read(tmp_path):
    write_as_json(tmp_path / "log.mcap", 3)
    log = read_log(tmp_path / "log.mcap")
    for seed, read in enumerate(log.records):
        assert_identical(arbitrary_step(seed), read)
    assert len(log.records) == 3


@pytest.mark.parametrize("content", [b"", b"\x89MCAP0\r\n", b"not a log", b"\x00" * 100])
def test_what_is_no_log_is_refused(tmp_path, content):
    file = tmp_path / "log.mcap"
    file.write_bytes(content)
    with pytest.raises(DrawbarError, match=r"log\.mcap: .*give the log\.mcap that drawbar run or drawbar drive wrote"):
        read_log(file)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with names")
def test_a_pipe_in_the_place_of_a_log_is_refused_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "log.mcap")
    with pytest.raises(DrawbarError, match=r"log\.mcap: is a pipe or a device, not a file; give the log\.mcap"):
        read_log(tmp_path / "log.mcap")


def test_a_missing_file_and_an_unwritable_folder_are_named(tmp_path):
    with pytest.raises(DrawbarError, match="No such file"):
        read_log(tmp_path / "none.mcap")
    with pytest.raises(DrawbarError, match="cannot be written"):
        Recorder(tmp_path / "none" / "log.mcap", header())
