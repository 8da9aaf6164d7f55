"""Logs that are cut or damaged: what is sound is read, and what is lost is told."""

import dataclasses
import re
from io import BytesIO

import numpy as np
import pytest
from arbitrary_logs import arbitrary_step, assert_identical, header, write
from mcap.reader import make_reader

from drawbar.errors import DrawbarError
from drawbar.recording import chunk
from drawbar.recording.chunk import FRAME, LEVEL
from drawbar.recording.columns import read_columns
from drawbar.recording.log import read_log
from drawbar.recording.recorder import Recorder
from drawbar.step.layout import packed


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
    monkeypatch.setattr(chunk, "CHUNK_BYTES", 3_000)  # two or three steps
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


@pytest.mark.parametrize("content", [b"", bytes(100)], ids=["no byte", "zeros"])
def test_a_log_of_nothing_is_refused_as_empty(tmp_path, content):
    (tmp_path / "log.mcap").write_bytes(content)
    with pytest.raises(DrawbarError, match=r"log\.mcap: .*it is empty, as a full disk"):
        read_log(tmp_path / "log.mcap")


@pytest.fixture(params=[None, LEVEL], ids=["as it is", "compressed"])
def long_log(request, tmp_path, monkeypatch):
    """Return the file of a log of 40 steps in chunks of three, and its steps."""
    monkeypatch.setattr(chunk, "CHUNK_BYTES", 3_000)
    monkeypatch.setattr("drawbar.recording.recorder._HELD_BACK", 2**64)  # no chunk ends before it is full
    monkeypatch.setattr("time.time_ns", lambda: 1_800_000_000_000_000_000)  # the same bytes each time
    records = [dataclasses.replace(arbitrary_step(seed), step=seed) for seed in range(40)]
    with Recorder(tmp_path / "log.mcap", header(), level=request.param) as recorder:
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
    begin, *_, end = marks(whole)
    for position in range(begin + 65, end - length, 4993):
        file.write_bytes(whole[:position] + whole[position + length :])
        log = read_log(file)
        assert len(log.records) >= len(steps) - (6 if length < 3000 else 9)
        assert log.losses or (len(log.records) == len(steps) and log.outcome.finished)
        for record in log.records:
            assert_identical(record, steps[record.step])


def marks(whole):
    """Return where the 14 chunks of a long log begin, the outcome behind them, and where the file ends."""
    chunks_begin = [each.chunk_start_offset for each in make_reader(BytesIO(whole)).get_summary().chunk_indexes]
    assert len(chunks_begin) == 14
    return [*chunks_begin, whole.index(b"\x07\0\0\0outcome") - FRAME.size, len(whole)]


BEHIND_38 = r"bytes \d+ to \d+ are damaged: what came after step 38 is lost"


@pytest.mark.parametrize(
    ("begin", "end", "lost", "said"),
    [
        pytest.param((4, 0), (5, 0), {12, 13, 14}, "steps 12 to 14 are lost", id="a chunk"),
        pytest.param(
            (13, 0), (14, 0), {39}, r"bytes may be missing before byte \d+: steps may be lost", id="the last chunk"
        ),
        pytest.param((13, 4), (15, -36), {39}, BEHIND_38, id="from its length to the footer's"),
        pytest.param((13, -20), (15, -28), {39}, BEHIND_38, id="from an index to the footer"),
        pytest.param((14, 20), (14, 30), set(), BEHIND_38.replace("38", "39"), id="some of the outcome"),
    ],
)
def test_bytes_that_are_missing_between_what_looks_sound_are_reported(long_log, begin, end, lost, said):
    file, steps = long_log
    whole = file.read_bytes()
    places = marks(whole)
    file.write_bytes(whole[: places[begin[0]] + begin[1]] + whole[places[end[0]] + end[1] :])
    log = read_log(file)
    assert {record.step for record in log.records} == set(range(len(steps))) - lost
    assert len(log.losses) == 1
    assert re.fullmatch(said, log.losses[0])


def test_damage_behind_the_outcome_costs_no_step(long_log):
    file, steps = long_log
    data = bytearray(file.read_bytes())
    data[data.index(b"its end", marks(data)[14]) + len(b"its end") + 1] ^= 4  # the length of the data's end
    file.write_bytes(data)
    log = read_log(file)
    assert len(log.records) == len(steps)
    assert log.outcome.finished
    assert re.fullmatch(r"bytes \d+ to \d+ are damaged: no step is lost", *log.losses)


def test_what_damage_costs_is_reported_with_its_bytes_and_steps(long_log):
    file, _ = long_log
    whole = file.read_bytes()
    begin = marks(whole)[2]
    data = bytearray(whole)
    data[begin + 541] ^= 16
    file.write_bytes(data)
    log, columns = read_log(file), read_columns(file, ["measurement.time"])
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
