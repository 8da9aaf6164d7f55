"""Tables of one body's tube: rows of text, the same for the console and the page."""

from collections.abc import Sequence

import numpy as np

from drawbar.control.settings import Nominal
from drawbar.control.tube.tube import SubsystemTube
from drawbar.report.tables import Row
from drawbar.report.tube.recorded import Finding
from drawbar.report.tube.units import scale, shown, title, with_unit

_SMALLEST = 1e-9
"""Excess, as it is shown, below which its size means nothing."""
SET_COLUMNS = ("seen error", "true error", "excess")
_ERRORS = {
    Nominal.PREDICTED: "e⁺ = B K e + w; the nominal state starts at the estimate and carries no error on",
    Nominal.PROPAGATED: "e⁺ = (A + B K) e + w; the nominal state runs on its own",
    Nominal.OPTIMISED: "e⁺ = (A + B K) e + w; the nominal state is chosen within the set",
}


def law_text(tube: SubsystemTube) -> str:
    """Return gain and error model in a line each."""
    gains = [
        f"{gain:.3g} {'rad/m' if unit == 'm' else 'rad/rad'} on {title(state)}"
        for state, unit, gain in zip(tube.model.states, tube.model.units, tube.gain.tolist(), strict=True)
        if gain
    ]
    return f"K: {', '.join(gains) or 'none'}\n{_ERRORS[tube.nominal]}"


def set_rows(tube: SubsystemTube) -> list[Row]:
    """Return the half-widths of the sets of x^ - x̄ and x - x̄, and how far Z exceeds the smallest set."""
    axes = np.eye(len(tube.gain))
    excess = np.full(len(tube.gain), np.nan)
    if tube.invariant_set is not None:
        excess[tube.invariant_set.bounded] = tube.invariant_set.excess
    widths = zip(tube.seen(axes).tolist(), tube.support(axes).tolist(), excess.tolist(), strict=True)
    return [
        (title(state), [_half_width(seen, unit), _half_width(true, unit), _excess(over, unit)])
        for state, unit, (seen, true, over) in zip(tube.model.states, tube.model.units, widths, strict=True)
    ]


def _half_width(value: float, unit: str) -> str:
    return f"±{shown(value, unit)}" if np.isfinite(value) else shown(value, unit)


def _excess(value: float, unit: str) -> str:
    factor, name = scale(unit)
    if np.isnan(value):
        return "–"
    return with_unit(f"{factor * value:.0e}" if factor * value >= _SMALLEST else f"< {_SMALLEST:.0e}", name)


def unbounded_text(tube: SubsystemTube) -> str:
    """Return which errors have no bound, and why; empty where all have one."""
    if tube.invariant_set is None:
        return "No bounds are declared: there is no set, and nothing is tightened."
    free = [title(state) for i, state in enumerate(tube.model.states) if i not in tube.invariant_set.bounded]
    if not free:
        return ""
    return (
        f"No bound: {', '.join(free)}. With this K nothing brings such an error back, so disturbances add up "
        f"without end; the set is that of the others, which do not depend on it."
    )


def bound_columns(tube: SubsystemTube) -> list[str]:
    """Return the names of the bounds."""
    return [title(name) for name in tube.bounds]


def bound_rows(tube: SubsystemTube) -> list[Row]:
    """Return what there was of each bound, what every source takes, and what is left."""
    bounds = list(tube.bounds.values())
    rows: list[Row] = [("original", [shown(bound.original, bound.unit) for bound in bounds])]
    if any(bound.reach != bound.original for bound in bounds):
        rows.append(("what the cylinder follows", [shown(bound.reach, bound.unit) for bound in bounds]))
    declared = {s.name: s for s in tube.invariant_set.sources} if tube.invariant_set else {}
    for name in bounds[0].contributions:
        source = declared.get(name)
        label = f"{title(name)}, {shown(source.bound, source.unit)}" if source and source.unit else title(name)
        rows.append((f"– {label}", [shown(bound.contributions[name], bound.unit) for bound in bounds]))
    rows.append(("left", [_left(bound.tightened, bound.unit) for bound in bounds]))
    return rows


def _left(value: float, unit: str) -> str:
    return shown(value, unit) if value > 0.0 else f"nothing ({shown(value, unit)})"


def undeclared_text(tube: SubsystemTube) -> str:
    """Return what else could be declared, with units."""
    declared = {source.name for source in tube.invariant_set.sources} if tube.invariant_set else set[str]()
    pairs = zip(tube.model.disturbances, tube.model.disturbance_units, strict=True)
    others = [f"{name} ({unit})" for name, unit in pairs if name not in declared]
    return f"Not declared: {', '.join(others)}"


FINDING_COLUMNS = ("median", "99 %", "largest", "declared", "beyond")


def finding_rows(findings: Sequence[Finding]) -> list[Row]:
    """Return the recorded magnitudes beside each declared bound."""
    return [
        (
            title(finding.name),
            [
                *(shown(float(value), finding.unit) for value in np.quantile(finding.magnitudes, (0.5, 0.99, 1.0))),
                shown(finding.declared, finding.unit) if finding.declared else "–",
                f"{finding.beyond}" if finding.declared else "–",
            ],
        )
        for finding in findings
    ]
