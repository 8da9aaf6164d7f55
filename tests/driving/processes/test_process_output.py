"""What processes write reaches memory at once, and the run's folder where the disk lets it."""

import os
import subprocess
import sys
import threading
import time

import pytest

from drawbar.driving.processes import process_output
from drawbar.driving.processes.process_output import ProcessOutput

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")


@pytest.fixture
def output(tmp_path, monkeypatch):
    monkeypatch.setattr(process_output, "_PERIOD", 0.01)
    output = ProcessOutput(tmp_path / "messages.txt")
    yield output
    output.close()


def say(output, text):
    for word in text.split():
        subprocess.run([sys.executable, "-c", f"print({word!r})"], stdout=output.descriptor, check=True)


def test_processes_write_one_behind_the_other_and_the_file_has_it_soon(output, tmp_path):
    say(output, "one two")
    assert output.text == "one\ntwo\n"
    end = time.monotonic() + 5.0
    while (tmp_path / "messages.txt").read_text() != "one\ntwo\n":
        assert time.monotonic() < end
    say(output, "three")
    output.close()
    assert output.closed
    assert (tmp_path / "messages.txt").read_text() == output.text == "one\ntwo\nthree\n"


def test_a_disk_that_takes_nothing_for_a_while_gets_all_of_it_later(output, tmp_path):
    os.rename(tmp_path / "messages.txt", tmp_path / "away.txt")
    say(output, "one")
    time.sleep(0.1)
    assert output.trouble == "No such file or directory"
    os.rename(tmp_path / "away.txt", tmp_path / "messages.txt")
    say(output, "two")
    output.close()
    assert not output.trouble
    assert (tmp_path / "messages.txt").read_text() == "one\ntwo\n"


def test_a_disk_that_hangs_keeps_neither_writers_nor_the_end_waiting(output, monkeypatch):
    disk = threading.Event()
    monkeypatch.setattr(process_output, "_ENDING", 0.1)
    monkeypatch.setattr(output, "_copy", disk.wait)
    say(output, "one")
    begin = time.monotonic()
    output.close()
    assert time.monotonic() - begin < 2.0
    assert output.text == "one\n"
    assert output.trouble == "the disk hangs"
    disk.set()
