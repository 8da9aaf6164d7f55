"""The experiment that experiments/README.md shows, as its reader makes it."""

import re
from pathlib import Path

from drawbar.experiment.analysis import load_analysis
from drawbar.experiment.experiment import load_experiment
from drawbar.experiment.task import Result

README = Path(__file__).parents[2] / "experiments" / "README.md"


def test_the_example_names_figures_that_its_analysis_has(tmp_path: Path, short_result: Result) -> None:
    text = README.read_text("utf-8")
    for language, file in (("toml", "experiment.toml"), ("python", "analysis.py")):
        (example,) = re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)
        (tmp_path / file).write_text(example, "utf-8")
    settings = load_experiment(tmp_path).settings
    figures = load_analysis(tmp_path).figures(short_result)
    named = {name for expected in settings.expected.values() for name in expected}
    (side_by_side,) = re.findall(r'`side_by_side = \["(.*?)"\]`', text)
    assert {*named, side_by_side} <= figures.keys()
