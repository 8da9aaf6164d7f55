"""What `import drawbar` offers is there, and nothing heavy is imported for the rest."""

import subprocess
import sys

import pytest

import drawbar
from drawbar.errors import ConfigurationError, DrawbarError, StorageError


@pytest.mark.parametrize("name", drawbar.__all__)
def test_every_name_is_there(name):
    assert getattr(drawbar, name).__module__.startswith("drawbar.")
    assert name in dir(drawbar)


def test_a_name_that_is_not_there_tells_which_are():
    with pytest.raises(AttributeError, match="has no attribute 'simulat'; it offers Autopilot, Bound"):
        drawbar.simulat  # noqa: B018


def test_the_import_alone_loads_no_library():
    program = "import drawbar, sys; print({'casadi', 'numpy', 'scipy', 'pydantic', 'plotly'} & set(sys.modules))"
    assert (
        subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout == "set()\n"
    )


@pytest.mark.parametrize("seed", [-1, 1.5, "0"])
def test_a_seed_that_is_none_is_refused(seed):
    with pytest.raises(ConfigurationError, match=rf"seed = {seed!r} is not allowed; give a whole number"):
        drawbar.simulate(drawbar.load_configuration("articulated"), seed=seed)


def test_files_and_folders_are_named_by_texts_too(tmp_path):
    for ask in (drawbar.read_log, drawbar.write_report):
        with pytest.raises(DrawbarError, match=r"none.*cannot be read"):
            ask(str(tmp_path / "none"))
    with pytest.raises(StorageError, match="cannot be written"):
        drawbar.Recorder(str(tmp_path / "none" / "log.mcap"), None)
