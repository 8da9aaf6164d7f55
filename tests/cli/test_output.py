"""Standard output that cannot be written is one message."""

import subprocess
import sys
from pathlib import Path

import pytest

FULL = Path("/dev/full")


@pytest.mark.skipif(not FULL.exists(), reason="this system has no /dev/full")
@pytest.mark.parametrize("arguments", [("config", "articulated"), ("--version",)], ids=["long", "short"])
def test_a_full_disk_behind_standard_output_is_one_message(arguments):
    with FULL.open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "drawbar", *arguments], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert (done.returncode, done.stderr) == (2, "error: output cannot be written: No space left on device\n")
