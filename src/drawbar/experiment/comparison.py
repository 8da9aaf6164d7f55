"""Comparison of a product with others over the same variants: mean distances side by side, and who is nearer where."""

from collections.abc import Sequence

from drawbar.experiment.elements import Element, Table, Text
from drawbar.experiment.measured import MeasuredExperiment

_CAPTION = (
    "Mean distance of the points on the ground from the path, tractor / trailer, cm, mean over the seeds; in brackets "
    "how many runs came to the end, where not all did."
)


def comparison(measured: MeasuredExperiment, product: str, figures: Sequence[str]) -> list[Element]:
    """Return a table of the variants that other cases than the product are driven in, and who is nearer in which.

    Args:
        measured: with cases named `CASE: VARIANT`.
        product: name of the case that the others are held against.
        figures: mean distances of both bodies, by name.
    """
    settings = measured.experiment.settings
    cases = [case.name for case in settings.cases]
    others = [case for case in cases if case != product]
    variants = [each.name for each in settings.variants]
    driven = [each for each in variants if any(f"{case}: {each}" in measured.runs for case in others)]
    rows = [[variant, *(measured.means(f"{case}: {variant}", figures) for case in cases)] for variant in driven]
    lines = [f"Comparators whose mean distance is below that of `{product}` on both bodies:", ""]
    for case in others:
        nearer = [each for each in driven if _nearer(measured, f"{case}: {each}", f"{product}: {each}", figures)]
        lines.append(f"- `{case}`: {'; '.join(nearer) or 'never'}")
    lines += ["", "`…-ideal` knows the true state, which no machine does: it shows the limit."]
    return [
        Table(name="comparators", caption=_CAPTION, header=["", *cases], rows=rows),
        Text(text="\n".join(lines)),
    ]


def _nearer(measured: MeasuredExperiment, one: str, other: str, figures: Sequence[str]) -> bool:
    """Return whether the first of two cases has less of every figure; NaN is not less."""
    if one not in measured.runs:
        return False
    return all(measured.statistic(one, name).mean < measured.statistic(other, name).mean for name in figures)
