"""Comparison of a product with others over the same variants: mean distances side by side, and who is nearer where."""

from collections.abc import Sequence

from drawbar.experiment.elements import Element, Table, Text
from drawbar.experiment.measured import MeasuredExperiment

_CAPTION = (
    "Distance of the points on the ground from the path, tractor / trailer, cm: mean over the seeds, and the largest "
    "of all; in brackets how many runs came to the end, where not all did."
)


def comparison(
    measured: MeasuredExperiment, product: str, means: Sequence[str], largest: Sequence[str]
) -> list[Element]:
    """Return a table of the variants that other cases than the product are driven in, and who is nearer in which.

    Args:
        measured: with cases named `CASE: VARIANT`.
        product: name of the case that the others are held against.
        means: figures' names: mean distances of both bodies.
        largest: likewise, their largest distances.
    """
    settings = measured.experiment.settings
    cases = [case.name for case in settings.cases]
    others = [case for case in cases if case != product]
    variants = [each.name for each in settings.variants]
    driven = [each for each in variants if any(f"{case}: {each}" in measured.runs for case in others)]
    rows = [[each, *(_distances(measured, f"{case}: {each}", means, largest) for case in cases)] for each in driven]
    lines = [f"Comparators whose mean distance is below that of `{product}` on both bodies:", ""]
    for case in others:
        nearer = [each for each in driven if _nearer(measured, f"{case}: {each}", f"{product}: {each}", means)]
        lines.append(f"- `{case}`: {'; '.join(nearer) or 'never'}")
    lines += ["", "`…-ideal` knows the true state, which no machine does: it shows the limit."]
    return [
        Table(name="comparators", caption=_CAPTION, header=["", *cases], rows=rows),
        Text(text="\n".join(lines)),
    ]


def _distances(measured: MeasuredExperiment, case: str, means: Sequence[str], largest: Sequence[str]) -> str:
    """Return means and largest distances of both bodies; empty for a case that was not driven."""
    if case not in measured.runs:
        return ""
    found = " / ".join(f"{measured.statistic(case, name).mean:.1f}" for name in means)
    most = " / ".join(f"{measured.statistic(case, name).largest:.0f}" for name in largest)
    return measured.with_finished(case, f"{found}, {most}")


def _nearer(measured: MeasuredExperiment, one: str, other: str, figures: Sequence[str]) -> bool:
    """Return whether the first of two cases has less of every figure; NaN is not less."""
    if one not in measured.runs:
        return False
    return all(measured.statistic(one, name).mean < measured.statistic(other, name).mean for name in figures)
