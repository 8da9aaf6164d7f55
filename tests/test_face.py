"""What `import drawbar` offers is there, and nothing heavy is imported for the rest."""

import subprocess
import sys

import pytest

import drawbar


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
