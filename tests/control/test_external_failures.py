"""A controller of one's own that fails is told by its name and line, and the run has its report."""

import pytest

from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.simulation import Simulation

HEAD = "from drawbar import Controller\n\n\nclass Mine(Controller):\n"
COMMAND = "    def command(self, estimate, reference):\n        return 0.0, 0.0\n"
UNMADE = {
    "abstract": (HEAD + "    pass\n", "TypeError"),
    "init": (HEAD + "    def __init__(self, *given):\n        raise KeyError('gain')\n\n" + COMMAND, "KeyError"),
    "syntax": ("class Mine(\n", "SyntaxError"),
}


@pytest.mark.parametrize("case", UNMADE)
def test_one_that_cannot_be_made_is_refused(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text, kind = UNMADE[case]
    (tmp_path / f"unmade_{case}.py").write_text(text, "utf-8")
    with pytest.raises(ConfigurationError, match=rf'"unmade_{case}:Mine": {kind}: .*\.py:\d+\)'):
        Simulation(load_configuration("pure-pursuit", [f"controller={{model='unmade_{case}:Mine'}}"]))
