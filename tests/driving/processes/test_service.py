"""The templates of systemd units are what systemd takes, and a drive finds its wiggle test where they say."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from patience import ENGAGE, PATIENT, watch

from drawbar.config import load_configuration
from drawbar.configurations import CONFIGURATION_NAME
from drawbar.driving.operator.front_end import FrontEnd
from drawbar.driving.preparation.wiggle_record import keep_passed
from drawbar.driving.processes.drive_processes import DriveProcesses
from drawbar.driving.stand_in.demonstration import with_stand_ins

UNITS = sorted((Path(__file__).parents[3] / "docs" / "systemd").glob("*.service"))


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
        ["systemd-analyze", "verify", "--man=no", str(copy)], capture_output=True, text=True, timeout=300, check=False
    )
    ours = [line for line in run.stderr.splitlines() if copy.name in line]
    assert ours == []


def test_a_drive_is_fed_by_its_gate_and_ended_in_order():
    text = (UNITS[0].parent / "drawbar@.service").read_text("utf-8")
    for line in ("Type=notify", "NotifyAccess=all", "WatchdogSec=2", "KillMode=mixed", "KillSignal=SIGINT"):
        assert line in text.splitlines()


@pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
def test_a_drive_without_a_home_hears_of_a_wiggle_test_that_is_passed_meanwhile(tmp_path, monkeypatch):
    assert "StateDirectory=drawbar" in (UNITS[0].parent / "drawbar@.service").read_text("utf-8").splitlines()
    monkeypatch.setenv("STATE_DIRECTORY", str(tmp_path / "state"))
    monkeypatch.setenv("XDG_STATE_HOME", "/proc/nowhere")
    configuration = with_stand_ins(load_configuration("articulated", ["path.radii=[8.0]", *PATIENT]))
    (tmp_path / CONFIGURATION_NAME).write_text(configuration.to_toml(), "utf-8")
    with DriveProcesses(configuration, tmp_path, stand_ins=True) as processes:
        front = FrontEnd(processes, demonstrates=False)
        watch(front, lambda front: front.controller is not None, ENGAGE)
        assert front.controller.wiggled == 0
        keep_passed(configuration)
        watch(front, lambda front: front.controller.wiggled == 1, ENGAGE)
        front.close()
