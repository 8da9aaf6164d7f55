"""For how long the log of a drive finds room is told before the drive begins."""

import shutil
from types import SimpleNamespace

import pytest

from drawbar.config import RecordingSettings
from drawbar.driving.preparation.disk_room import growth, room_note
from drawbar.errors import StorageError

HOURLY = growth(0.2)
ROOM = RecordingSettings().room


@pytest.fixture
def disk(monkeypatch):
    disk = SimpleNamespace(total=10**12, free=0)
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: disk)
    return disk


@pytest.mark.parametrize(("rate", "measured"), [(5.0, 30e6), (20.0, 93e6)])
def test_the_log_is_expected_to_grow_a_quarter_faster_than_was_measured(rate, measured):
    """docs/driving.md, "How soon commands leave"."""
    assert 1.2 < growth(1.0 / rate) / measured < 1.3


@pytest.mark.parametrize(("hours", "told"), [(1.01, "enough for 1.0 h"), (9.9, "enough for 9.9 h"), (10.1, "")])
def test_less_than_a_days_room_is_told(disk, tmp_path, hours, told):
    disk.free = round(hours * HOURLY)
    note = room_note(tmp_path, 0.2, ROOM)
    assert bool(note) is bool(told)
    assert told in note


def test_as_much_room_as_is_set_is_enough(disk, tmp_path):
    disk.free = round(5.0 * HOURLY)
    assert room_note(tmp_path, 0.2, ROOM)
    assert not room_note(tmp_path, 0.2, 4.0 * 3600.0)
    assert "enough for 1.6 h" in room_note(tmp_path, 0.05, 4.0 * 3600.0)  # at 20 Hz a log grows faster


def test_less_than_an_hours_room_is_refused(disk, tmp_path):
    disk.free = round(0.99 * HOURLY)
    with pytest.raises(StorageError, match=r"has 37 MB left; the log of an hour's drive takes 37 MB: make room, or .*"):
        room_note(tmp_path, 0.2, ROOM)


def test_a_disk_that_does_not_tell_what_is_left_is_not_refused(disk, tmp_path):
    disk.total = 0
    assert not room_note(tmp_path, 0.2, ROOM)
