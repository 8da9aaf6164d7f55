"""How far from the path a lasting jump of one antenna takes both bodies, by its size."""

from collections.abc import Iterator, Mapping, Sequence

from drawbar.experiment.elements import Element, Table
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.vehicle.parameters import BODIES

NONE = "no jump"


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the table."""
    cases = {antenna: _by_size(measured, antenna) for antenna in BODIES}
    (undisturbed,) = (case for case in measured.cases if case.endswith(NONE))
    rows = [
        [f"{antenna}'s antenna", _largest(measured, [undisturbed]), *(_largest(measured, each) for each in by.values())]
        for antenna, by in cases.items()
    ]
    yield Table(
        name="jumps",
        caption="Largest distance from the path of any run, eight directions and all seeds, tractor / trailer, cm.",
        header=["jump of", "0 m", *cases[BODIES[0]]],
        rows=rows,
    )


def _by_size(measured: MeasuredExperiment, antenna: str) -> Mapping[str, Sequence[str]]:
    """Return the cases in which one antenna jumps, by the size of the jump."""
    cases: dict[str, list[str]] = {}
    for case in measured.cases:
        variant = case.partition(": ")[2]
        if variant.startswith(antenna):
            cases.setdefault(variant.removeprefix(f"{antenna} ").partition(",")[0], []).append(case)
    return cases


def _largest(measured: MeasuredExperiment, cases: Sequence[str]) -> str:
    largest = (max(measured.statistic(case, f"{body} largest").largest for case in cases) for body in BODIES)
    return " / ".join(f"{each:.0f}" for each in largest)
