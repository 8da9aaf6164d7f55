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
FAILING = {
    "returns_nothing": ("    def command(self, estimate, reference):\n        pass\n", r"returned None, not two", 5),
    "returns_three": (
        "    def command(self, *given):\n        return 0.0, 1, 2\n",
        r"returned \(0\.0, 1, 2\), not two",
        5,
    ),
    "returns_texts": (
        "    def command(self, *given):\n        return '0', '1'\n",
        r"returned \('0', '1'\), not two",
        5,
    ),
    "takes_one": ("    def command(self, estimate):\n        return 0.0, 0.0\n", r"takes 2 positional arguments", 5),
    "calls_another": (
        "    def command(self, *given):\n        from numpy.linalg import inv\n\n        return inv([[0.0]])\n",
        r"LinAlgError: Singular matrix",
        8,
    ),
}


@pytest.mark.parametrize("case", UNMADE)
def test_one_that_cannot_be_made_is_refused(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text, kind = UNMADE[case]
    (tmp_path / f"unmade_{case}.py").write_text(text, "utf-8")
    with pytest.raises(ConfigurationError, match=rf'"unmade_{case}:Mine": {kind}: .*\.py:\d+\)'):
        Simulation(load_configuration("pure-pursuit", [f"controller={{model='unmade_{case}:Mine'}}"]))


@pytest.mark.parametrize("case", FAILING)
def test_a_command_that_fails_is_reported_by_its_line_in_the_users_file(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text, reason, line = FAILING[case]
    (tmp_path / f"failing_{case}.py").write_text(HEAD + text, "utf-8")
    run = Simulation(load_configuration("pure-pursuit", [f"controller={{model='failing_{case}:Mine'}}"]))
    with pytest.raises(ConfigurationError, match=rf"{reason}.*failing_{case}\.py:{line}\)"):
        next(run.steps())


def test_a_class_that_is_not_complete_is_reported_by_its_line_in_the_users_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "incomplete.py").write_text(HEAD + "    pass\n", "utf-8")
    with pytest.raises(ConfigurationError, match=r"abstract.*incomplete\.py:4\)"):
        Simulation(load_configuration("pure-pursuit", ["controller={model='incomplete:Mine'}"]))
