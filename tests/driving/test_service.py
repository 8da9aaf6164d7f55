"""The templates of systemd units are what systemd takes."""

import shutil
import subprocess
from pathlib import Path

import pytest

UNITS = sorted((Path(__file__).parents[2] / "docs" / "systemd").glob("*.service"))


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed")
@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: unit.name)
def test_systemd_accepts_it(unit, tmp_path):
    lines = unit.read_text("utf-8").splitlines()
    programs = [
        line.replace(line.partition("=")[2].split()[0], "/bin/true") if line.startswith("Exec") else line
        for line in lines
    ]
    copy = tmp_path / unit.name.replace("@", "@can0")
    copy.write_text("\n".join(line for line in programs if not line.startswith("User=")), "utf-8")
    run = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", str(copy)], capture_output=True, text=True, timeout=60, check=False
    )
    ours = [line for line in run.stderr.splitlines() if copy.name in line]
    assert ours == []


def test_a_drive_is_fed_by_its_gate_and_ended_in_order():
    text = (UNITS[0].parent / "drawbar@.service").read_text("utf-8")
    for line in ("Type=notify", "NotifyAccess=all", "WatchdogSec=2", "KillMode=mixed", "KillSignal=SIGINT"):
        assert line in text.splitlines()
