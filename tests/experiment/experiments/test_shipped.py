"""Every shipped experiment can be read: its configurations are possible, its expectations name figures that it has."""

from pathlib import Path

import pytest

from drawbar.experiment.analysis import load_analysis
from drawbar.experiment.experiment import FILE_NAME, load_experiment

FOLDER = Path(__file__).parents[3] / "experiments"
NAMES = sorted(file.parent.name for file in FOLDER.glob(f"*/{FILE_NAME}"))


@pytest.mark.parametrize("name", NAMES)
def test_an_experiment_can_be_driven(name: str) -> None:
    experiment = load_experiment(FOLDER / name)
    assert experiment.settings.seeds >= 1
    assert set(experiment.settings.expected) <= set(experiment.configurations)
    load_analysis(experiment.folder)
    assert (experiment.folder / "README.md").read_text("utf-8").startswith(f"# {experiment.settings.title}\n")


def test_the_experiments_of_the_paper_are_there() -> None:
    assert {"trajectory-error", "slip-estimates", "steering", "execution-times", "robustness"} <= set(NAMES)
