"""Columns read in a stream are those of the whole log."""

import importlib.util
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drawbar.errors import DrawbarError
from drawbar.recording import blocks, columns
from drawbar.recording.blocks import reported
from drawbar.recording.columns import read_columns
from drawbar.recording.log import read_log
from drawbar.recording.stream import records_beside_chunks

_SPECIFICATION = importlib.util.spec_from_file_location("recorded", Path(__file__).with_name("test_recorder.py"))
assert _SPECIFICATION is not None
assert _SPECIFICATION.loader is not None
t = importlib.util.module_from_spec(_SPECIFICATION)
_SPECIFICATION.loader.exec_module(t)


def test_columns_are_those_of_the_whole_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(columns, "_BLOCK", 7)
    t.write(tmp_path / "log.mcap", 30)
    whole, streamed = read_log(tmp_path / "log.mcap"), read_columns(tmp_path / "log.mcap")
    for name in reported(has_truth=True):
        expected = whole.column(name)
        exact = name.endswith(blocks.WIDE)
        np.testing.assert_allclose(streamed.column(name), expected, rtol=0.0 if exact else 1e-7, err_msg=name)
    assert (streamed.steps, streamed.has_truth, streamed.outcome) == (30, True, whole.outcome)
    np.testing.assert_array_equal(streamed.wall_time, whole.wall_time)


@pytest.fixture
def chunked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a log of 30 steps in chunks of two or three."""
    monkeypatch.setattr(t.chunks, "CHUNK_BYTES", 8_000)
    t.write(tmp_path / "log.mcap", 30)
    return tmp_path / "log.mcap"


@pytest.fixture
def parsed(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Return a list that grows by the number of steps whenever steps are parsed."""
    counts, parse = list[int](), columns._parsed

    def watched(*given: Any) -> Iterator[columns.Block]:
        for block in parse(*given):
            counts.append(len(block.wall_time))
            yield block

    monkeypatch.setattr(columns, "_parsed", watched)
    return counts


def demand_the_same(left: columns.ColumnLog, right: columns.ColumnLog) -> None:
    assert (left.steps, left.has_truth, left.outcome) == (right.steps, right.has_truth, right.outcome)
    np.testing.assert_array_equal(left.wall_time, right.wall_time)
    for name in reported(has_truth=left.has_truth):
        np.testing.assert_array_equal(left.column(name), right.column(name), err_msg=name)


def test_what_stands_beside_the_chunks_is_what_parsing_finds(
    chunked: Path, parsed: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = read_columns(chunked)
    assert parsed == []
    monkeypatch.setattr(columns, "decode_block", lambda content: None)
    demand_the_same(read_columns(chunked), kept)
    assert sum(parsed) == 30


def test_steps_of_a_chunk_with_nothing_beside_it_are_parsed(chunked: Path, parsed: list[int]) -> None:
    whole, data = read_columns(chunked), chunked.read_bytes()
    for end in range(len(data) // 2, len(data), 501):  # as kills at any moment leave it
        chunked.write_bytes(data[:end])
        parsed.clear()
        cut = read_columns(chunked)
        assert len(read_log(chunked).records) == cut.steps > 10
        assert sum(parsed) <= 3
        for name in reported(has_truth=True):
            np.testing.assert_array_equal(cut.column(name), whole.column(name)[: cut.steps], err_msg=name)


@pytest.mark.parametrize("place", [0, 5, -1])
def test_what_is_damaged_beside_a_chunk_is_parsed_instead(chunked: Path, parsed: list[int], place: int) -> None:
    whole, data = read_columns(chunked), bytearray(chunked.read_bytes())
    with chunked.open("rb") as stream:
        ends = [end for end, _ in records_beside_chunks(stream)]
    data[ends[place] - 9] ^= 4
    chunked.write_bytes(data)
    demand_the_same(read_columns(chunked), whole)
    assert 0 < sum(parsed) <= 30


def test_columns_that_do_not_stand_beside_the_chunks_are_parsed(chunked: Path, parsed: list[int]) -> None:
    log, name = read_columns(chunked, ["truth.speed", "measurement.time"]), "truth.speed"
    assert (log.has_truth, sum(parsed)) == (True, 30)
    np.testing.assert_allclose(log.column(name), read_log(chunked).column(name), rtol=1e-7)


def test_a_truth_that_comes_and_goes_stands_beside_no_chunk(tmp_path: Path, parsed: list[int]) -> None:
    with t.Recorder(tmp_path / "log.mcap", t.header()) as recorder:
        for seed in range(2):
            recorder.write(t.dataclasses.replace(t.arbitrary_step(seed), **({"truth": None} if seed else {})))
    assert len(read_log(tmp_path / "log.mcap").records) == 2
    with (tmp_path / "log.mcap").open("rb") as stream:
        assert not list(records_beside_chunks(stream))


def test_a_number_that_stays_the_same_is_kept_once(tmp_path: Path) -> None:
    still, moving = "command.speed", "measurement.time"
    steps = [t.dataclasses.replace(t.arbitrary_step(seed), command=t.arbitrary_step(0).command) for seed in range(9)]
    with t.Recorder(tmp_path / "log.mcap", t.header()) as recorder:
        for step in steps:
            recorder.write(step)
    log = read_columns(tmp_path / "log.mcap", [still, moving])
    assert [len(column) for column in log.blocks[0].columns] == [1, 9]
    np.testing.assert_allclose(log.column(still), np.full(9, steps[0].command.speed), rtol=1e-7)


def test_without_truth_its_columns_are_missing(tmp_path: Path) -> None:
    with t.Recorder(tmp_path / "log.mcap", t.header()) as recorder:
        recorder.write(t.dataclasses.replace(t.arbitrary_step(1), truth=None))
    log = read_columns(tmp_path / "log.mcap")
    assert not log.has_truth
    assert np.isnan(log.column("truth.tractor.x")).all()
    assert log.column("measurement.time").shape == (1,)


def test_a_log_without_steps_has_empty_columns(tmp_path: Path) -> None:
    t.write(tmp_path / "log.mcap", 0)
    assert read_columns(tmp_path / "log.mcap").column("measurement.time").shape == (0,)


def test_what_is_no_log_is_refused(tmp_path: Path) -> None:
    (tmp_path / "log.mcap").write_bytes(b"not a log")
    with pytest.raises(DrawbarError, match=r"log\.mcap: "):
        read_columns(tmp_path / "log.mcap")
