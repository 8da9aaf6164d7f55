import dataclasses
import os
import pathlib
import re
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
from mcap_ros2.decoder import DecoderFactory

from drawbar.errors import DrawbarError
from drawbar.guidance.figure_eight import figure_eights
from drawbar.recording import chunks
from drawbar.recording.columns import read_columns
from drawbar.recording.log import PathTable, RecordedPoints, RunHeader, encode_special, read_log
from drawbar.recording.recorder import Recorder
from drawbar.recording.table import number_names
from drawbar.signals import StepRecord
from drawbar.step.layout import packed
from drawbar.vehicle.parameters import VehicleParameters

SHAPES = {"closest": (4,), "samples": (3, 4), "poses": (3, 3), "steerings": (2,), "deviation": (3,)}
PREDICTED = ("poses", "steerings")
"""what is recorded in single precision"""


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
    return array.astype(np.float32).astype(float) if name in PREDICTED else array


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


@pytest.fixture
def every_step_at_once(monkeypatch):
    monkeypatch.setattr("drawbar.recording.recorder._HELD_BACK", 0)


def test_a_killed_process_leaves_every_step_of_a_real_machine(tmp_path):
    script = f"""
import os, signal, sys, time
sys.path.insert(0, {str(pathlib.Path(__file__).parent)!r})
import pathlib
import re
import test_recorder as t
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
    monkeypatch.setattr("drawbar.recording.recorder.time.monotonic_ns", lambda: now)
    with Recorder(file, header()) as recorder:
        for seed, (milliseconds, kept) in enumerate([(0, 1), (10, 1), (9, 1), (1, 4), (19, 4), (1, 6)]):
            now += milliseconds * 1_000_000
            recorder.write(arbitrary_step(seed))
            assert len(read_log(file).records) == kept
    assert len(read_log(file).records) == 6


def test_a_last_message_cut_at_any_byte_is_left_out(tmp_path, every_step_at_once):
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
    monkeypatch.setattr(chunks, "CHUNK_BYTES", 3_000)  # two or three steps
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


@pytest.fixture
def long_log(tmp_path, monkeypatch):
    """Return the file of a log of 40 steps in chunks of three, and its steps."""
    monkeypatch.setattr(chunks, "CHUNK_BYTES", 3_000)
    monkeypatch.setattr("drawbar.recording.recorder._HELD_BACK", 2**64)  # no chunk ends before it is full
    records = [dataclasses.replace(arbitrary_step(seed), step=seed) for seed in range(40)]
    with Recorder(tmp_path / "log.mcap", header()) as recorder:
        for record in records:
            recorder.write(record)
    return tmp_path / "log.mcap", records


def demand_a_chunk_at_most(log, steps):
    """Demand what is left of a damaged log to be as it was, all but one chunk, and told rightly what is lost."""
    found = {record.step for record in log.records}
    for record in log.records:
        assert_identical(record, steps[record.step])
    lost = sorted(set(range(len(steps))) - found)
    assert len(lost) <= 3
    assert (lost == []) or lost == list(range(lost[0], lost[-1] + 1))
    if not lost:
        return
    said = " ".join(log.losses)
    if lost[-1] == len(steps) - 1:
        assert f"what came after step {lost[0] - 1} is lost" in said
    else:
        single = f"step {lost[0]} is lost"
        assert (single if len(lost) == 1 else f"steps {lost[0]} to {lost[-1]} are lost") in said
        assert re.search(r"bytes \d+ to \d+ are damaged", said)


def test_a_flipped_bit_costs_the_chunk_that_it_is_in(long_log):
    file, steps = long_log
    whole, losses, refused = file.read_bytes(), 0, list[tuple[int, str]]()
    header_end = whole.index(b"drawbar/msg/StepRecord")
    data_end = whole.rindex(b"outcome")
    rng = np.random.default_rng(7)
    for position in range(0, len(whole), 311):
        data = bytearray(whole)
        data[position] ^= 1 << int(rng.integers(8))
        file.write_bytes(data)
        try:
            log = read_log(file)
        except DrawbarError as error:
            refused.append((position, str(error)))
            continue
        demand_a_chunk_at_most(log, steps)
        losses += bool(log.losses)
        if header_end < position < data_end - 20 and len(log.records) == len(steps):
            assert log.outcome.finished or log.losses
    assert losses > 50
    assert all(position < header_end and "log.mcap: " in said for position, said in refused)


@pytest.mark.parametrize("length", [1, 8, 700, 3000])
def test_bytes_that_are_missing_cost_the_chunks_that_they_are_in(long_log, length):
    file, steps = long_log
    whole = file.read_bytes()
    begin, end = whole.index(b"zstd") + 20, whole.rindex(b"zstd")
    for position in range(begin, end - length, 4993):
        file.write_bytes(whole[:position] + whole[position + length :])
        log = read_log(file)
        assert len(log.records) >= len(steps) - (6 if length < 3000 else 9)
        assert log.losses or len(log.records) == len(steps)
        for record in log.records:
            assert_identical(record, steps[record.step])


def test_what_damage_costs_is_told_with_its_bytes_and_steps(long_log):
    file, _ = long_log
    whole = file.read_bytes()
    places = [found.start() for found in re.finditer(b"zstd", whole)]
    data = bytearray(whole)
    data[places[2] + 500] ^= 16
    file.write_bytes(data)
    log, columns = read_log(file), read_columns(file, ["measurement.time"])
    begin = places[2] - 41
    assert [record.step for record in log.records] == [*range(6), *range(9, 40)]
    assert log.outcome.finished
    (said,) = log.losses
    assert re.fullmatch(rf"bytes {begin} to \d+ are damaged: steps 6 to 8 are lost", said)
    assert columns.losses == log.losses
    np.testing.assert_array_equal(columns.column("measurement.time"), log.column("measurement.time"))


def test_a_damaged_last_chunk_that_is_open_costs_what_is_behind(tmp_path, every_step_at_once):
    file, steps = tmp_path / "log.mcap", [dataclasses.replace(arbitrary_step(seed), step=seed) for seed in range(6)]
    recorder = Recorder(file, header())
    for step in steps:
        recorder.write(step)
    data = bytearray(file.read_bytes())
    recorder.give_up()
    size = len(packed(steps[0])) + 35
    data[len(data) - 2 * size] ^= 0x40  # the operation code of the last message but one
    file.write_bytes(data)
    log = read_log(file)
    assert [record.step for record in log.records] == [0, 1, 2, 3]
    assert re.fullmatch(r"bytes \d+ to \d+ are damaged: what came after step 3 is lost", log.losses[0])


def test_a_log_whose_header_is_damaged_says_so_or_names_it(long_log):
    file, _ = long_log
    whole = file.read_bytes()
    place = whole.index(b'"seed":3')
    file.write_bytes(whole.replace(b'"seed":3', b'"seed":4'))
    log = read_log(file)
    assert (log.header.seed, len(log.records)) == (4, 40)
    assert "they hold what was known before the first step" in log.losses[0]
    file.write_bytes(whole[:place] + b"}" + whole[place + 1 :])
    with pytest.raises(
        DrawbarError, match=r"log\.mcap: is damaged.*bytes \d+ to \d+ are .*what was known before the first step"
    ):
        read_log(file)


def test_steps_that_come_fast_are_not_written_twice(tmp_path, monkeypatch):
    now = 10**9
    monkeypatch.setattr(chunks, "CHUNK_BYTES", 20_000)
    monkeypatch.setattr("drawbar.recording.recorder.time.monotonic_ns", lambda: now)
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
    monkeypatch.setattr(chunks, "CHUNK_BYTES", 3_000)  # two or three steps
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


def write_as_json(file, count):
    """Write a log as earlier versions did, without chunks."""
    encoder = msgspec.json.Encoder(enc_hook=encode_special)
    with file.open("wb") as stream:
        writer = Writer(stream, use_chunking=False)
        writer.start(profile="drawbar")
        writer.add_attachment(0, 0, "run.json", "application/json", encoder.encode(header()))
        channel = writer.register_channel("/step", "json", writer.register_schema("StepRecord", "jsonschema", b"{}"))
        for seed in range(count):
            writer.add_message(channel, seed, encoder.encode(arbitrary_step(seed)), seed, seed)
        writer.finish()


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
