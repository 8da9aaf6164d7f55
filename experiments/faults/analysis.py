"""What the machine did about each fault: its response, how soon, how it stopped, and how far from the line it came."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from drawbar.config import load_configuration
from drawbar.errors import DrawbarError
from drawbar.experiment.declaration import Expectation
from drawbar.experiment.elements import Element, Table, Text
from drawbar.experiment.measured import MeasuredExperiment
from drawbar.experiment.task import Result
from drawbar.messages import SupervisorState
from drawbar.safety.causes import BY_CODE

RESPONSES = {
    0: "drives on",
    2: "slower",
    3: "stops",
    4: "releases",
    5: "never engages",
    6: "boards release",
    7: "beyond the envelope",
}
ACTIVE, DEGRADED = SupervisorState.ACTIVE, SupervisorState.DEGRADED
STOPPING = {SupervisorState.STOPPING, SupervisorState.STOPPED}
RELEASED = {SupervisorState.FAULT, SupervisorState.OVERRIDE, SupervisorState.ESTOP}
NO_FAULT = "no fault"
SLOW = ("0.5 m/s", "1 m/s", "2 m/s")
"""speeds at which a fault may cost MOST"""
MOST = 30.0
"""extra distance from the line while drawbar steers, in any run, cm"""
BUS = "by the bus"
"""cases in which the tractor keeps the speed that drawbar commands"""
LONG = "nominal"
"""cases without a fault, driven for long"""
REFUSED = [
    ("F1 wrong unit", "vehicle.wheelbase=140.0"),
    ("F2 negative length", "vehicle.wheelbase=-1.4"),
    ("F3 unknown key", "vehicle.wheelbas=1.4"),
    ("F4 not a number", "speed=nan"),
    ("F6 a command that outlives the gate's patience", "safety.timing.command=5.0"),
    ("F6 limits above the boards' own", "vehicle.tractor_steering_limit=1.2"),
    ("P4 a curve that is too tight", "path.radii=[2.0]"),
]
"""configurations that must be refused, and what is wrong with them"""


def figures(result: Result) -> dict[str, float]:
    """Return the figures of one run: `response` by its number, times in s, ways in m, distances in cm."""
    watched = {name.removeprefix("watch."): column for name, column in result.columns.items()}
    time, states, driving = watched["time"], set(watched["state"].astype(int)), watched["driving"] > 0
    response = 7 if watched["beyond"][-1] else _response(states, driving)
    changed = ~driving if response == 6 else watched["state"] != ACTIVE
    stands = (watched["speed"] < 0.05) & (np.cumsum(changed) > 0)
    until = int(np.argmax(stands)) if stands.any() else len(time) - 1
    errors = np.abs([watched["tractor"], watched["trailer"]])[:, : until + 1].max(axis=0)
    left = ~driving | np.isin(
        watched["state"].astype(int), list(RELEASED)
    )  # a board may hold its last set point after that
    steered = np.cumsum(left)[: until + 1] == 0
    first = int(np.argmax(changed))
    return {
        "response": float(response),
        "detected": _first(time, changed),
        "released": _first(time, ~driving),
        "stands": _first(time, stands),
        "way": float(watched["way"][until]) if stands.any() else math.nan,
        "steered": 100.0 * float(errors[steered].max(initial=0.0)),
        "largest": 100.0 * float(errors.max()),
        "beyond the envelope": float(watched["beyond"][-1]),
        "cause": float(watched["cause"][first]) if changed.any() else math.nan,
        "watched": float(time[-1]),
    }


def _response(states: set[int], driving: np.ndarray) -> int:
    if not driving.any():
        return 5
    if states & RELEASED:
        return 4
    if states & STOPPING:
        return 3
    if states & {DEGRADED}:
        return 2
    return 0 if driving[-1] else 6


def _first(time: np.ndarray, holds: np.ndarray) -> float:
    return float(time[np.argmax(holds)]) if holds.any() else math.nan


def report(measured: MeasuredExperiment) -> Iterator[Element]:
    """Yield the tables."""
    driven = [case for case in measured.cases if " m/s, " in case]
    variants = list(dict.fromkeys(case.partition(": ")[2] for case in driven))
    yield Text(text=_summary(measured, driven))
    yield _driven_table(measured, driven, variants)
    yield _engaging_table(
        measured, [case for case in measured.cases if case not in driven and not case.startswith(LONG)]
    )
    yield Table(
        name="refused",
        caption="Configurations that are refused.",
        header=["fault", "what is given", "what drawbar says"],
        rows=[[name, f"`{change}`", _refusal(change)] for name, change in REFUSED],
    )


def _driven_table(measured: MeasuredExperiment, driven: Sequence[str], variants: Sequence[str]) -> Table:
    rows = [_row(measured, variant, [case for case in driven if case.endswith(f": {variant}")]) for variant in variants]
    return Table(
        name="faults",
        caption="Every fault on straight and curve, all speeds and seeds. Observed: runs by response. Times from the "
        "fault on until the gate's state changed, until no board turned its wheel, until it stood: the longest, "
        "s. More than without the fault: the largest distance of either body from the path, less that of the same run "
        "without the fault, cm, the worst. First while drawbar steers, to 2 m/s and at 3 m/s. Then until the vehicle "
        "stands as well, where it is released and nobody takes the wheel: with a driver who brakes after 0.7 s "
        "with 1.5 m/s², and with a tractor that obeys the bus (2 m/s).",
        header=[
            "fault",
            "expected",
            "observed",
            "first cause",
            "seen",
            "released",
            "stood",
            "way, m",
            "steered, to 2 m/s",
            "3 m/s",
            "until it stands, to 2 m/s",
            "3 m/s",
            "by the bus",
        ],
        rows=rows,
    )


def _engaging_table(measured: MeasuredExperiment, cases: Sequence[str]) -> Table:
    return Table(
        name="before-engaging",
        caption="The same before it is engaged, with an operator who engages as soon as that is possible.",
        header=["fault", "expected", "observed"],
        rows=[
            [case.replace(": " + NO_FAULT, "").removeprefix("before engaging: "), *_responses(measured, [case])]
            for case in cases
        ],
    )


def _summary(measured: MeasuredExperiment, driven: Sequence[str]) -> str:
    verdicts = measured.verdicts()
    cases, wrong = {each.case for each in verdicts}, {each.case for each in verdicts if not each.holds}
    slow = [case for case in driven if case.startswith(SLOW) and not case.endswith(NO_FAULT)]
    near = sum(_extra(measured, [case], "steered") <= MOST for case in slow)
    faultless = [
        case for case in measured.cases if case.endswith(NO_FAULT) and (case in driven or case.startswith(LONG))
    ]
    hours = sum(sum(measured.values(case, "watched")) for case in faultless) / 3600.0
    false = sum(value != 0.0 for case in faultless for value in measured.values(case, "response"))
    beyond = sum(sum(measured.values(case, "beyond the envelope")) for case in driven)
    return (
        f"{len(cases - wrong)} of {len(cases)} cases as expected; {near} of {len(slow)} at up to 2 m/s never more than "
        f"{MOST:.0f} cm farther from the line while drawbar steers than without the fault; {beyond:.0f} set points "
        "beyond the envelope on the wire; "
        f"{false} false stops in {hours:.2f} h of driving without a fault."
    )


def _row(measured: MeasuredExperiment, variant: str, cases: Sequence[str]) -> list[str]:
    causes = Counter(value for case in cases for value in measured.values(case, "cause") if math.isfinite(value))
    cause = ", ".join(BY_CODE[int(code)].name if int(code) else "-" for code, _ in causes.most_common(2))
    worst = {name: _largest(measured, cases, name) for name in ("detected", "released", "stands", "way")}
    bus = [case for case in cases if BUS in case]
    slow = [case for case in cases if case.startswith(SLOW) and case not in bus]
    fast = [case for case in cases if not case.startswith(SLOW)]
    extra = [_extra(measured, [*slow, *bus], "steered"), _extra(measured, fast, "steered")]
    extra += [_extra(measured, each, "largest") for each in (slow, fast, bus)]
    times = (_text(value, 2) for value in worst.values())
    return [variant, *_responses(measured, cases), cause, *times, *(_text(each, 0) for each in extra)]


def _responses(measured: MeasuredExperiment, cases: Sequence[str]) -> list[str]:
    """Return the response that is expected of cases, and how often which was observed."""
    expected = measured.experiment.expected[cases[0]]["response"]
    found = Counter(int(value) for case in cases for value in measured.values(case, "response") if math.isfinite(value))
    observed = ", ".join(f"{RESPONSES[number]} {count}" for number, count in found.most_common())
    return [allowed(expected), observed]


def allowed(expected: Expectation) -> str:
    """Return all responses of a single run that are as expected."""
    *others, last = [text for number, text in RESPONSES.items() if expected.holds(number)]
    return " or ".join([*([", ".join(others)] if others else []), last])


def _extra(measured: MeasuredExperiment, cases: Sequence[str], figure: str) -> float:
    """Return by how much a fault's distance exceeds the largest one of the same run without it, cm."""
    extra = []
    for case in cases:
        without = f"{case.partition(': ')[0]}: {NO_FAULT}"
        pairs = zip(measured.values(case, figure), measured.values(without, "largest"), strict=True)
        extra += [max(one - other, 0.0) for one, other in pairs]
    return max(extra, default=math.nan)


def _largest(measured: MeasuredExperiment, cases: Sequence[str], figure: str) -> float:
    values = [value for case in cases for value in measured.values(case, figure) if math.isfinite(value)]
    return max(values, default=math.nan)


def _text(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "–"


def _refusal(change: str) -> str:
    """Return what is said of a configuration with one change; it must be refused."""
    from drawbar.simulation import Simulation

    try:
        Simulation(load_configuration("articulated", [change]))
    except DrawbarError as error:
        return str(error).replace("\n", " ").replace("|", "\\|")
    return "**taken**"
