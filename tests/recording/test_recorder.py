import dataclasses
import json
import os
import pathlib
import signal
import subprocess
import sys
import types
import typing
from datetime import UTC, datetime
from enum import IntEnum, IntFlag

import msgspec
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

from drawbar.errors import DrawbarError
from drawbar.guidance.figure_eight import figure_eights
from drawbar.recording import chunks
from drawbar.recording.log import PathTable, RecordedPoints, RunHeader, encode_special, read_log
from drawbar.recording.recorder import Recorder
from drawbar.signals import StepRecord
from drawbar.vehicle.parameters import VehicleParameters

SHAPES = {"closest": (4,), "samples": (3, 4), "poses": (3, 3), "steerings": (2,), "deviation": (3,)}


def arbitrary(kind, name, rng):
    """Return a random value of a signal's type; every seventh number is missing."""
    if isinstance(kind, types.UnionType):
        kind = kind.__args__[0]
    if dataclasses.is_dataclass(kind):
        hints = typing.get_type_hints(kind)
        return kind(**{field: arbitrary(hint, field, rng) for field, hint in hints.items()})
    if kind is float:
        if name == "time":
            return float(rng.exponential())
        return float("nan") if rng.random() < 1 / 7 else float(rng.normal() * 1e3)
    if isinstance(kind, type) and issubclass(kind, IntEnum | IntFlag):
        return list(kind)[int(rng.integers(len(kind)))]
    if kind in (int, bool):
        return kind(rng.integers(0, 2))
    array = rng.normal(size=SHAPES[name])
    array.flat[0] = np.nan
    return array


def arbitrary_step(seed):
    return arbitrary(StepRecord, "", np.random.default_rng(seed))


def header():
    return RunHeader(
        configuration_name="articulated",
        configuration="[vehicle]\nwheelbase = 1.4 # ü\n",
        seed=3,
        started=datetime(2026, 5, 4, 3, 2, 1, tzinfo=UTC),
        vehicle=VehicleParameters(joint_sign=-1),
        path=PathTable.of(figure_eights([1.0], 1.0)),
        path_name="eights",
        path_note="as recorded",
        recorded=RecordedPoints.of(np.array([[0.0, 0.1], [3.0, 0.2]]), np.array([0.1, 0.2])),
        estimate_bounds={"longitudinal_slip": (0.25, 1.0)},
    )


def assert_identical(left, right):
    """Exact equality, fields in depth, where NaN equals NaN and arrays keep shape and type."""
    assert type(left) is type(right)
    if dataclasses.is_dataclass(left):
        for field in dataclasses.fields(left):
            assert_identical(getattr(left, field.name), getattr(right, field.name))
    elif isinstance(left, np.ndarray):
        assert left.dtype == right.dtype
        np.testing.assert_array_equal(left, right, strict=True)
    else:
        assert left == right or (left != left and right != right)


def write(file, count):
    records = [arbitrary_step(seed) for seed in range(count)]
    with Recorder(file, header()) as recorder:
        for record in records:
            recorder.write(record)
    return records


def test_every_field_survives_the_round_trip(tmp_path):
    records = write(tmp_path / "log.mcap", 50)
    log = read_log(tmp_path / "log.mcap")
    assert len(log.records) == 50
    for written, read in zip(records, log.records, strict=True):
        assert_identical(written, read)
    assert_identical(log.header, header())
    assert log.outcome.finished
    assert np.all(np.diff(log.wall_time) >= 0.0)


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
        messages = list(make_reader(stream, validate_crcs=True).iter_messages(topics=["/step"]))
    assert {m[2].log_time for m in messages} == {round(r.measurement.time * 1e9) for r in records}
    schema, channel, message = messages[0]
    assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
    properties = json.loads(schema.data)["properties"]
    assert properties.keys() == json.loads(message.data).keys()


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


def test_a_killed_process_leaves_every_step(tmp_path):
    script = f"""
import os, signal, sys
sys.path.insert(0, {str(pathlib.Path(__file__).parent)!r})
import pathlib
import test_recorder as t
recorder = t.Recorder(pathlib.Path({str(tmp_path / "log.mcap")!r}), t.header())
for seed in range(7):
    recorder.write(t.arbitrary_step(seed))
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


def test_a_last_message_cut_at_any_byte_is_left_out(tmp_path):
    file = tmp_path / "log.mcap"
    with Recorder(file, header()) as recorder:
        recorder.write(arbitrary_step(0))
        one = file.stat().st_size
        recorder.write(arbitrary_step(1))
        data = file.read_bytes()
    for end in range(one, len(data) + 1):
        file.write_bytes(data[:end])
        log = read_log(file)
        assert len(log.records) == (2 if end == len(data) else 1)
        assert_identical(log.records[0], arbitrary_step(0))
        assert not log.outcome.finished


def test_zeros_behind_a_cut_are_as_if_they_were_not_there(tmp_path, monkeypatch):
    monkeypatch.setattr(chunks, "CHUNK_BYTES", 8_000)  # two or three steps
    file, steps = tmp_path / "log.mcap", write(tmp_path / "log.mcap", 9)
    whole = file.read_bytes()
    for end in range(len(whole) // 3, len(whole) - 2_000, 137):  # as a file system leaves it where the power failed
        file.write_bytes(whole[:end])
        cut = len(read_log(file).records)
        file.write_bytes(whole[:end] + bytes(100_000))
        found = read_log(file).records
        assert cut - 1 <= len(found) <= cut
        for step, record in zip(steps, found, strict=False):
            assert_identical(step, record)


def test_a_flipped_bit_in_a_complete_log_is_named(tmp_path):
    file, said = tmp_path / "log.mcap", set()
    steps = write(file, 2)
    whole = file.read_bytes()
    first, size = whole.index(b"zstd") + 12, int.from_bytes(whole[(at := whole.index(b"zstd") + 4) : at + 8], "little")
    positions, unseen = range(first, first + size, 97), []
    for position in positions:
        data = bytearray(whole)
        data[position] ^= 1
        file.write_bytes(data)
        try:
            unseen.append(read_log(file).records)
        except DrawbarError as error:
            said.add(str(error))
    assert all("log.mcap: is damaged" in text for text in said)
    assert len(unseen) <= 0.1 * len(positions)  # zstd does not look at one bit of 600
    for records in unseen:
        for record, written in zip(records, steps, strict=True):
            assert_identical(record, written)


def test_a_log_of_several_chunks_is_whole_indexed_and_readable_at_any_moment(tmp_path, monkeypatch):
    monkeypatch.setattr(chunks, "CHUNK_BYTES", 8_000)  # two or three steps
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


def test_logs_without_chunks_of_earlier_versions_are_read(tmp_path):
    file = tmp_path / "log.mcap"
    encoder = msgspec.json.Encoder(enc_hook=encode_special)
    with file.open("wb") as stream:
        writer = Writer(stream, use_chunking=False)
        writer.start(profile="drawbar")
        writer.add_attachment(0, 0, "run.json", "application/json", encoder.encode(header()))
        channel = writer.register_channel("/step", "json", writer.register_schema("StepRecord", "jsonschema", b"{}"))
        for seed in range(3):
            writer.add_message(channel, seed, encoder.encode(arbitrary_step(seed)), seed, seed)
        writer.finish()
    log = read_log(file)
    for seed, read in enumerate(log.records):
        assert_identical(arbitrary_step(seed), read)
    assert len(log.records) == 3


@pytest.mark.parametrize("content", [b"", b"\x89MCAP0\r\n", b"not a log", b"\x00" * 100])
def test_what_is_no_log_is_refused(tmp_path, content):
    file = tmp_path / "log.mcap"
    file.write_bytes(content)
    with pytest.raises(DrawbarError, match=r"log\.mcap: .*give the log\.mcap that drawbar run wrote"):
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
