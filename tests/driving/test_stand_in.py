"""`drawbar stand-in` with faults, and a drive against it: two programs, real sockets on loopback, real time."""

import subprocess
import sys

import pytest
from patience import ENGAGE, PATIENT, watch

from drawbar.config import load_configuration
from drawbar.driving.crew import CONFIGURATION_NAME, Crew
from drawbar.driving.demonstration import with_stand_ins
from drawbar.driving.front_end import FrontEnd
from drawbar.messages import SupervisorState
from drawbar.safety.causes import Cause

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
FAULTS = ("--fault", "receivers-silent@3s", "--fault", "board-silent@7s")
QUICK = ["safety.timing.angle=0.5", "safety.timing.angle_lost=1.0"]


@pytest.fixture
def configuration(tmp_path):
    """Return a configuration with devices at free ports, and its file."""
    configuration = with_stand_ins(load_configuration("articulated", ["path.radii=[8.0]", *PATIENT, *QUICK]))
    file = tmp_path / CONFIGURATION_NAME
    file.write_text(configuration.to_toml(), "utf-8")
    return configuration, file


@pytest.fixture
def stand_in(configuration, tmp_path):
    """Return the file in which a stand-in with faults says what happens."""
    words = tmp_path / "stand-in.txt"
    command = [sys.executable, "-m", "drawbar", "stand-in", str(configuration[1]), *FAULTS]
    with words.open("wb") as file:
        process = subprocess.Popen(command, stdout=file, stderr=file)
    yield words
    process.terminate()
    assert process.wait(10.0) == 0


def test_a_drive_against_a_stand_in_whose_receivers_and_then_a_board_fall_silent(configuration, stand_in, tmp_path):
    with Crew(configuration[0], tmp_path, stand_ins=False) as crew:
        front = FrontEnd(crew, demonstrates=True)
        watch(front, lambda front: front.state and front.state.state is SupervisorState.DEGRADED, ENGAGE)
        assert front.state.cause == Cause.FIX_LOST.value
        assert "both receivers fall silent" in stand_in.read_text()
        state = watch(front, lambda front: not front.state.steers, 30.0)
        assert state.state is SupervisorState.FAULT
        assert state.cause in (Cause.STEERING_LOST.value, Cause.LET_GO.value, Cause.SILENT.value)
        assert "front wheels' board says nothing" in stand_in.read_text()
        front.close()


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["--fault", "list"], 0, ["fixes-jump: both receivers' positions jump 1 m to the left", "bus-off: "]),
        (["--fault", "nothing@3s"], 1, ["there is no fault 'nothing'", "receivers-silent"]),
        (["--fault", "bus-off"], 1, ["nothing that could break so"]),
    ],
)
def test_which_faults_there_are_is_told(configuration, arguments, code, words):
    command = [sys.executable, "-m", "drawbar", "stand-in", str(configuration[1]), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60.0, check=False)
    said = " ".join((done.stdout + done.stderr).split())
    for part in words:
        assert part in said
    assert (done.returncode != 0) == code
