"""Comparison of a product with others over the same variants: distances side by side, and who is nearer where."""

from drawbar.experiment.elements import Element, Table, Text
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.vehicle.parameters import BODIES

_CAPTION = (
    "Distance of the points on the ground from the path, tractor / trailer, cm: mean over the seeds, and the largest "
    "of all; in brackets how many runs came to the end, where not all did."
)
_SPREADS = (
    "The same runs: standard deviation of the signed distance, and 95 % of the distance, means over the seeds, cm."
)


def comparison(measured: MeasuredExperiment, product: str) -> list[Element]:
    """Return tables of the variants that other cases than the product are driven in, and who is nearer in which.

    Args:
        measured: with cases named `CASE: VARIANT`, and figures as of `distance_figures`.
        product: name of the case that the others are held against.
    """
    settings = measured.experiment.settings
    cases = [case.name for case in settings.cases]
    others = [case for case in cases if case != product]
    variants = [each.name for each in settings.variants]
    driven = [each for each in variants if any(f"{case}: {each}" in measured.runs for case in others)]
    lines = [f"Comparators whose mean distance is below that of `{product}` on both bodies:", ""]
    for case in others:
        nearer = [each for each in driven if _nearer(measured, f"{case}: {each}", f"{product}: {each}")]
        lines.append(f"- `{case}`: {'; '.join(nearer) or 'never'}")
    lines += ["", "`…-ideal` knows the true state, which no machine does: it shows the limit."]
    header = ["", *cases]
    return [
        Table(
            name="comparators",
            caption=_CAPTION,
            header=header,
            rows=[[each, *(_distances(measured, f"{case}: {each}") for case in cases)] for each in driven],
        ),
        Table(
            name="spreads",
            caption=_SPREADS,
            header=header,
            rows=[[each, *(_spreads(measured, f"{case}: {each}") for case in cases)] for each in driven],
        ),
        Text(text="\n".join(lines)),
    ]


def _distances(measured: MeasuredExperiment, case: str) -> str:
    """Return means and largest distances of both bodies; empty for a case that was not driven."""
    if case not in measured.runs:
        return ""
    most = " / ".join(f"{measured.statistic(case, f'{body} largest').largest:.0f}" for body in BODIES)
    return measured.with_finished(case, f"{_means(measured, case, 'mean')}, {most}")


def _spreads(measured: MeasuredExperiment, case: str) -> str:
    """Return standard deviations and 95 % of both bodies; empty for a case that was not driven."""
    if case not in measured.runs:
        return ""
    return f"{_means(measured, case, 'SD')}, {_means(measured, case, '95 %')}"


def _means(measured: MeasuredExperiment, case: str, figure: str) -> str:
    return " / ".join(f"{measured.statistic(case, f'{body} {figure}').mean:.1f}" for body in BODIES)


def _nearer(measured: MeasuredExperiment, one: str, other: str) -> bool:
    """Return whether the first of two cases has less of both mean distances; NaN is not less."""
    if one not in measured.runs:
        return False
    names = [f"{body} mean" for body in BODIES]
    return all(measured.statistic(one, name).mean < measured.statistic(other, name).mean for name in names)
