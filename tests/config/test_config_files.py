"""Files of configurations: what each must be, and how one extends another."""

import re
from pathlib import Path

import pytest
from configurations import SMALLEST, Write, refusal

from drawbar.config import load_configuration
from drawbar.configurations import shipped_names
from drawbar.control.settings import TubeSettings
from drawbar.errors import ConfigurationError


def test_a_file_may_begin_with_a_byte_order_mark(write: Write) -> None:
    assert load_configuration(write(b"\xef\xbb\xbf" + SMALLEST.encode())).name == "mine"


@pytest.mark.parametrize("double", ['name = "a"\nname = "b"', "[vehicle]\n[vehicle]", "speed = 1.0\nspeed.x = 1"])
def test_a_duplicate_key_is_refused_with_its_line(write: Write, double: str) -> None:
    file = write(double + "\nspeed = 1.0\n")
    assert refusal(file).startswith(f"{file}: is not valid TOML: ")
    assert "twice" in refusal(file)
    assert "line 2" in refusal(file)


@pytest.mark.parametrize(
    "content",
    [
        bytes(range(256)),
        'name = "ü"'.encode("latin-1"),
        b"\x89PNG\r\n",
        "name = ü",
        "a = " + "[" * 20000,
        "n = " + "9" * 5000,
    ],
    ids=["binary", "latin-1", "picture", "no TOML", "deep", "digits"],
)
def test_a_file_that_is_no_toml_is_refused(write: Write, content: str | bytes) -> None:
    file = write(content)
    assert refusal(file).startswith(file)


def test_what_is_wrong_with_text_of_windows_is_reported_with_what_to_do(write: Write) -> None:
    file = write('name = "a"\n[path]\nfile = "C:\\Users\\Jo\\field"\n')
    assert "at line 3" in refusal(file)
    assert "write the path with / or in single quotes" in refusal(file)
    assert "backslash" not in refusal(write('name = "a"\npath = "C:/x" y\n'))
    encoded = write('name = "Süd"\n'.encode("utf-16"))
    assert refusal(encoded) == f"{encoded}: byte 0 is not UTF-8 text; save the file as UTF-8."


def test_a_file_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    for source in (str(tmp_path), str(tmp_path / "none.toml"), "", "a\0b"):
        message = refusal(source)
        what = "cannot be read as a" if source == str(tmp_path) else "is neither a file nor a shipped"
        assert message.startswith(f"{source}: {what} configuration")
        assert "did you mean" not in message
        assert ", ".join(shipped_names()) in message


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="this system has no file without end")
def test_a_file_without_end_is_no_configuration() -> None:
    with pytest.raises(ConfigurationError, match=r"/dev/zero: is longer than a million characters"):
        load_configuration("/dev/zero")


def test_the_nearest_name_is_suggested() -> None:
    assert refusal("articulatd").startswith(
        "articulatd: is neither a file nor a shipped configuration (did you mean articulated?); give"
    )


def test_a_recorded_line_is_beside_the_file_that_names_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine").mkdir()
    base, mine = tmp_path / "mine" / "base.toml", tmp_path / "mine.toml"
    base.write_text('extends = "articulated"\nname = "base"\npath.file = "fields/home"\n')
    mine.write_text('extends = "mine/base.toml"\nname = "mine"\n')
    monkeypatch.chdir(tmp_path)
    beside = str(tmp_path / "mine" / "fields" / "home")
    for source in ("mine/base.toml", mine, str(base)):
        found = load_configuration(source)
        assert found.path.file == beside
        (tmp_path / "copy.toml").write_text(found.to_toml())
        assert load_configuration("copy.toml").path.file == beside, "wherever a run's folder is"
    assert load_configuration(base, ["path.file=fields/other"]).path.file == str(tmp_path / "fields" / "other")
    assert load_configuration(base, ["speed=0.5"]).path.file == beside
    assert load_configuration("articulated").path.file == ""


def test_toml_that_is_no_configuration_is_refused() -> None:
    message = refusal(str(Path(__file__).parents[2] / "pyproject.toml"))
    assert "has no key build-system, project, tool" in message


def test_a_file_extends_another_with_only_what_differs(tmp_path: Path) -> None:
    (tmp_path / "base.toml").write_text('extends = "articulated"\nname = "base"\nestimator.window = 7\n')
    (tmp_path / "mine.toml").write_text('extends = "base.toml"\nname = "mine"\nspeed = 0.5\ntube.tractor.yaw = -1.0\n')
    mine, shipped = load_configuration(str(tmp_path / "mine.toml")), load_configuration("articulated")
    assert (mine.name, mine.speed, mine.estimator.window) == ("mine", 0.5, 7)
    assert (mine.tube.tractor.yaw, mine.tube.tractor.lateral) == (-1.0, shipped.tube.tractor.lateral)
    assert (
        mine.model_copy(
            update={"name": "articulated", "speed": 1.0, "estimator": shipped.estimator, "tube": shipped.tube}
        )
        == shipped
    )


def test_an_extended_section_of_another_model_starts_anew(write: Write) -> None:
    mine = load_configuration(write('extends = "paper"\nname = "mine"\nestimator.model = "articulated"\n'))
    assert mine.estimator == load_configuration("articulated").estimator
    assert mine.controller == load_configuration("paper").controller


def test_an_empty_section_takes_back_what_the_extended_file_says(write: Write) -> None:
    mine = load_configuration(write('extends = "articulated"\nname = "mine"\n[tube]\ntrailer = {}\n'))
    assert mine.tube.trailer == TubeSettings().trailer != load_configuration("articulated").tube.trailer
    assert mine.tube.tractor == load_configuration("articulated").tube.tractor


@pytest.mark.parametrize("base", ['"nowhere"', "3", '"mine.toml"', f'"{"a" * 5000}"', '"a\\u0000b"'])
def test_a_base_that_is_none_is_refused(write: Write, base: str) -> None:
    assert ", ".join(shipped_names()) in refusal(write(f'extends = {base}\nname = "mine"\n'))


def test_a_base_that_is_none_is_reported_with_the_file_that_names_it(write: Write) -> None:
    assert "mine.toml: extends = 'articulatd': is neither" in refusal(write('extends = "articulatd"\n'))
    assert "mine.toml: extends = '': is neither" in refusal(write('extends = ""\n'))


@pytest.mark.parametrize("base", ["../one.toml", "again/one.toml"])
def test_files_that_extend_each_other_are_refused(tmp_path: Path, base: str) -> None:
    (tmp_path / "below").mkdir()
    (tmp_path / "below" / "again").symlink_to(tmp_path)
    (tmp_path / "one.toml").write_text('extends = "below/two.toml"\n')
    (tmp_path / "below" / "two.toml").write_text(f'extends = "{base}"\n')
    assert "none that extends this one" in refusal(str(tmp_path / "one.toml"))


@pytest.mark.parametrize(
    ("given", "shown"),
    [
        ("[actuation]\nodd = -1.0", "actuation.residual = -1.0: must be greater than 0"),
        ("[sensors.fixes]\noptimism = 0.5", "sensors.fixes.inflation = 0.5: must be greater than or equal to 1"),
        ("[tube.work]\nspeed = [0.0, 1.0]", "tube.operating_range.speed.0 = 0.0: must be greater than 0"),
    ],
)
def test_a_wrong_value_of_a_former_key_is_shown_under_the_present_one(tmp_path: Path, given: str, shown: str) -> None:
    (file := tmp_path / "old.toml").write_text(f'extends = "articulated"\n{given}\n')
    with pytest.raises(ConfigurationError, match=re.escape(shown)):
        load_configuration(str(file))
