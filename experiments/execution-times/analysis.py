"""The paper's table of execution times beside ours, and what decentralised costs per centralised."""

from collections.abc import Iterator, Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from drawbar.benchmark.bench import STAGES
from drawbar.benchmark.closed_loop import probed_runs
from drawbar.benchmark.figures import machine, on_one_core
from drawbar.experiment.elements import Element, Picture, Table, Text
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.statistics import Statistic
from drawbar.experiment.task import Result
from drawbar.report.style import ESTIMATOR, INK, REFERENCE, TRACTOR, TRAILER

SOLVERS = ("tractor", "trailer", "estimator")
PHASES = ("preparation", "feedback", "overall")
FILLED = 30
"""steps until the estimator's window is full: they do not count"""
STEPS = 500
"""samples of each solver by itself"""
PAPER = {
    ("tractor", "preparation"): (1179.1, 1181.6, 1319.9),
    ("tractor", "feedback"): (29.3, 31.3, 117.3),
    ("tractor", "overall"): (1208.4, 1212.9, 1437.2),
    ("trailer", "preparation"): (1248.7, 1254.0, 1323.4),
    ("trailer", "feedback"): (28.8, 54.1, 150.5),
    ("trailer", "overall"): (1277.5, 1308.1, 1473.9),
    ("centralised", "preparation"): (6546.2, 6663.2, 6926.0),
    ("centralised", "feedback"): (52.1, 134.5, 314.0),
    ("centralised", "overall"): (6598.3, 6797.7, 7240.0),
}
"""minimum, average and maximum, µs, on an Intel Core 2 Quad Q9100 at 2.26 GHz"""
PAIRS = {"paper": "paper-centralised", "articulated": "articulated-centralised"}
COLOURS = {"tractor": TRACTOR, "trailer": TRAILER, "centralised": INK, "estimator": ESTIMATOR}
Times = Mapping[tuple[str, str], Mapping[str, np.ndarray]]
"""by case and solver: the times of every sample by phase, µs"""


def figures(result: Result) -> dict[str, float]:
    """Return the medians of one run, `SOLVER PHASE`, µs; NaN where there is no such solver.

    The median, since a single interruption by the operating system outweighs hundreds of samples in an average.
    """
    return {
        f"{solver} {phase}": float(np.median(times))
        for solver in SOLVERS
        for phase, times in _in_the_loop(result, solver).items()
    }


def _in_the_loop(result: Result, solver: str) -> dict[str, np.ndarray]:
    """Return the times of one solver in one run by phase, µs; a centralised controller's is the tractor's."""
    prepare, feedback = (result.columns[f"{solver}_times.{name}"][FILLED:] for name in ("prepare", "feedback"))
    return _phases(prepare, feedback)


def _phases(prepare: np.ndarray, feedback: np.ndarray) -> dict[str, np.ndarray]:
    times = (1e6 * prepare, 1e6 * feedback, 1e6 * (prepare + feedback))
    return dict(zip(PHASES, times, strict=True))


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the machine, the table of the solvers by themselves, the ratios, and the same in the loop."""
    with on_one_core():
        alone = {key: times for case in measured.cases for key, times in _by_itself(case).items()}
    loop = {key: times for case in measured.cases for key, times in _pooled(measured, case).items()}
    facts = machine()
    yield Text(text=f"Measured on one core of: {facts['processor']}, {facts['system']}, Python {facts['python']}.")
    yield _table_by_itself(alone)
    yield Text(text=_ratios(measured, alone))
    yield Picture(
        name="times",
        caption="Overall time of one sample of each solver by itself: average, with a line from minimum to maximum, "
        "logarithmic. Hollow: the paper's, on its processor of 2008.",
        draw=lambda figure: _draw(figure, alone),
        size=(8.0, 3.4),
    )
    yield _table_in_the_loop(loop)


def _by_itself(case: str) -> dict[tuple[str, str], dict[str, np.ndarray]]:
    """Measure a case's solvers in C, each from the states that a closed loop brings it to."""
    (probes,) = probed_runs(case, (STAGES,), STEPS, with_peers=False)
    full = slice(STAGES + 1, STAGES + 1 + STEPS - 1)  # the last preparation is not complete
    return {
        (case, probe.name.removeprefix(f"{case}-") if probe.name != case else "centralised"): _phases(
            np.array(probe.prepare[full]), np.array(probe.feedback[full])
        )
        for probe in probes
    }


def _pooled(measured: MeasuredExperiment, case: str) -> dict[tuple[str, str], dict[str, np.ndarray]]:
    """Return the times of all runs of a case, from the closed loop."""
    names = {"centralised": "tractor"} if case.endswith("centralised") else {solver: solver for solver in SOLVERS}
    runs = measured.runs[case].results
    return {
        (case, name): {
            phase: np.concatenate([_in_the_loop(result, solver)[phase] for result in runs]) for phase in PHASES
        }
        for name, solver in names.items()
    }


def _table_by_itself(alone: Times) -> Table:
    paper = [
        ["the paper", solver, phase, *(f"{value:.1f}" for value in values)] for (solver, phase), values in PAPER.items()
    ]
    ours = [
        [*key, phase, *(f"{value:.2f}" for value in (times.min(), times.mean(), times.max()))]
        for key, by_phase in alone.items()
        for phase, times in by_phase.items()
    ]
    return Table(
        name="times",
        caption="Execution times of one sample, µs; ours: of the solver by itself, as `drawbar bench` measures it (a "
        f"call repeated from the same state, the shortest counts), N = {STAGES}, {STEPS} samples of a closed loop.",
        header=["", "solver", "phase", "minimum", "average", "maximum"],
        rows=[*paper, *ours],
    )


def _table_in_the_loop(loop: Times) -> Table:
    rows = [
        [*key, phase, *(f"{value:.2f}" for value in (times.min(), times.mean(), times.max()))]
        + [f"{value:.2f}" for value in np.percentile(times, (50.0, 99.0))]
        for key, by_phase in loop.items()
        for phase, times in by_phase.items()
    ]
    return Table(
        name="loop",
        caption="The same, called once per sample from Python between everything else that a control step does: caches "
        "are cold, and about a microsecond per call is Python's. The longest times are interruptions by the operating "
        "system, which weigh on the average. µs, all samples of all seeds.",
        header=["", "solver", "phase", "minimum", "average", "maximum", "50 %", "99 %"],
        rows=rows,
    )


def _ratios(measured: MeasuredExperiment, alone: Times) -> str:
    bodies = ("tractor", "trailer")
    paper = 100.0 * sum(PAPER[body, "overall"][1] for body in bodies) / PAPER["centralised", "overall"][1]
    lines = [
        "Both decentralised controllers together per centralised controller, overall times (the paper's text: less "
        "than half; its conclusion: less than 75 %):",
        "",
        f"- the paper's table, averages: {paper:.0f} %: {_holds(paper)}",
    ]
    for pair in PAIRS.items():
        ratio, loop = _ratio_by_itself(alone, *pair), _ratio_in_the_loop(measured, *pair)
        lines += [
            f"- `{pair[0]}` per `{pair[1]}`, by themselves, averages: {ratio:.0f} %: {_holds(ratio)}",
            f"- the same in the loop, medians, over the seeds: {loop.text(0)} %: {_holds(loop.mean)}",
        ]
    return "\n".join(lines)


def _ratio_by_itself(alone: Times, decentralised: str, centralised: str) -> float:
    both = sum(alone[decentralised, body]["overall"].mean() for body in ("tractor", "trailer"))
    return float(100.0 * both / alone[centralised, "centralised"]["overall"].mean())


def _ratio_in_the_loop(measured: MeasuredExperiment, decentralised: str, centralised: str) -> Statistic:
    tractor, trailer = (measured.values(decentralised, f"{body} overall") for body in ("tractor", "trailer"))
    whole = measured.values(centralised, "tractor overall")
    return Statistic.of([100.0 * (a + b) / c for a, b, c in zip(tractor, trailer, whole, strict=False)])


def _holds(percent: float) -> str:
    """Say which of the paper's two statements about its own ratio holds for one."""
    if percent < 50.0:
        return "both statements hold"
    return "only the weaker statement holds" if percent < 75.0 else "neither statement holds"


def _draw(figure: Figure, alone: Times) -> None:
    axes = figure.subplots()
    rows = [("the paper", solver, PAPER[solver, "overall"]) for solver in ("tractor", "trailer", "centralised")]
    for (case, solver), by_phase in alone.items():
        times = by_phase["overall"]
        rows.append((case, solver, (times.min(), times.mean(), times.max())))
    for place, (case, solver, (least, mean, most)) in enumerate(rows):
        colour = COLOURS[solver]
        axes.plot([least, most], [place, place], color=colour, lw=1.0)
        axes.plot([mean], [place], "o", color=colour, mfc="white" if case == "the paper" else colour, ms=6.0)
        text = f"{mean:.0f}" if mean >= 100.0 else f"{mean:.1f}"
        axes.annotate(text, (most, place), xytext=(7, 0), textcoords="offset points", va="center", size=8.0)
    axes.set(xscale="log", xlabel="one sample, µs", ylim=(len(rows) - 0.4, -0.6), xlim=(None, 2e4))
    axes.set_yticks(range(len(rows)), [f"{case}: {solver}" for case, solver, _ in rows])
    axes.axhline(2.5, color=REFERENCE, lw=0.8)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
