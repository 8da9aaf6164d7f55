"""What a plain installation lacks is told before anything else happens, with the command that installs it."""

from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

import pytest
from short_run import Drawbar

from drawbar import extras
from drawbar.cli.calibrate import _pushed
from drawbar.cli.log import _writer
from drawbar.config import load_configuration
from drawbar.errors import DrawbarError
from drawbar.recording import drive_records

MACHINE = '[devices.tractor_receiver]\ntransport = "udp://127.0.0.1:1"\n'


@pytest.fixture
def without(monkeypatch: pytest.MonkeyPatch):
    """Return the function after which a package is not installed."""

    def hide(*packages: str) -> None:
        def found(name: str) -> Distribution:
            if name in packages:
                raise PackageNotFoundError(name)
            return distribution(name)

        monkeypatch.setattr(extras, "distribution", found)

    return hide


@pytest.mark.parametrize(
    ("arguments", "package", "who"),
    [
        ("drive --seconds 0.1", "foxglove-sdk", "drawbar drive"),
        ("drive --console --seconds 0.1", "nicegui", "drawbar drive --console"),
        ("check my.toml", "pysbf2", "drawbar check"),
        ("stand-in my.toml", "pyserial", "drawbar stand-in"),
        ("experiment all", "distributed", "drawbar experiment"),
        ("tune paper --parameters guidance.look_ahead=0..3", "optuna", "drawbar tune"),
    ],
)
def test_a_command_tells_what_it_lacks(
    drawbar: Drawbar, without, tmp_path: Path, arguments: str, package: str, who: str
) -> None:
    (tmp_path / "my.toml").write_text(f'extends = "articulated"\nname = "my"\n{MACHINE}', "utf-8")
    without(package)
    code, said = drawbar(*arguments.split())
    assert code == 2
    assert f"{who} needs what is not installed here ({package}); install it with: " in said
    assert "-m pip install " in said


def test_the_replay_of_a_drive_tells_what_it_lacks(
    drawbar: Drawbar, without, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "log.mcap").touch()
    monkeypatch.setattr(drive_records, "is_drive", lambda log: True)
    without("pyubx2")
    code, said = drawbar("replay", "log.mcap")
    assert code == 2
    assert "drawbar replay of a drive needs what is not installed here (pyubx2)" in said


def test_pushing_a_valve_tells_what_it_lacks(without) -> None:
    without("python-can")
    with pytest.raises(DrawbarError, match=r"calibrate --push needs what is not installed here \(python-can\)"):
        _pushed(load_configuration("articulated"))


def test_a_log_for_ros_tells_what_it_lacks(without) -> None:
    without("mcap-ros2-support")
    with pytest.raises(DrawbarError, match=r"--ros2 needs what is not installed here \(mcap-ros2-support\)"):
        _writer("--ros2", Path("log.mcap"))


def test_what_an_export_lacks_is_told_before_the_log_is_read(drawbar: Drawbar, without, tmp_path: Path) -> None:
    (tmp_path / "log.mcap").touch()
    without("mcap-ros2-support")
    code, said = drawbar("log", "export", "log.mcap", "--csv", "a.csv", "--ros2", "b.mcap")
    assert code == 2
    assert "--ros2 needs what is not installed here (mcap-ros2-support)" in said


def test_what_is_installed_is_not_missed() -> None:
    for extra in ("console", "experiments", "machine", "physics"):
        assert extras.require_extra("nobody", extra) is None
        assert extras.install_command(extra).count(">=") >= 1, "and there is something to miss"


def test_a_drive_with_its_console_lacks_both_extras_in_one_message(drawbar: Drawbar, without) -> None:
    without("pyserial", "nicegui")
    code, said = drawbar("drive", "--console")
    assert code == 2
    assert "not installed here (nicegui, pyserial)" in said.replace("\n", " ")
