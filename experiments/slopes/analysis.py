"""How far from the path each estimator lets a slope, a lost receiver, and nothing at all take both bodies."""

from collections.abc import Iterator

from drawbar.experiment.elements import Element, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.vehicle.parameters import BODIES


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the table."""
    settings = measured.experiment.settings
    variants = [variant.name for variant in settings.variants]
    yield Table(
        name="slopes",
        caption="Largest distance from the path in a run, tractor / trailer, cm, mean over the seeds.",
        header=["what the estimator knows of slopes", *variants],
        rows=[[case.name, *(_cell(measured, f"{case.name}: {name}") for name in variants)] for case in settings.cases],
    )


def _cell(measured: MeasuredExperiment, case: str) -> str:
    return " / ".join(f"{measured.statistic(case, f'{body} largest').mean:.1f}" for body in BODIES)
