"""Every fault of this experiment once in real time: real processes, sockets and signals, one drive for each.

`python experiments/faults/real_time.py` drives all variants of two cases, with boards and on the bus, by the same
alterations. It keeps what came of each in real_time.csv beside it, and as a table in real_time.md. What is in that file
is not driven again, so that Ctrl-C may end it at any time, and the next call goes on. A drive takes some 45 s.
"""

import argparse
import csv
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from datetime import date
from pathlib import Path
from types import SimpleNamespace

from analysis import RESPONSES, allowed, figures
from socket_drive import NotDrivenError, SocketDrive

from drawbar.benchmark.figures import processor
from drawbar.config import Configuration
from drawbar.errors import DrawbarError
from drawbar.experiment.experiment import Experiment, load_experiment
from drawbar.experiment.trial import WATCHED, Trial
from drawbar.safety.causes import BY_CODE

FOLDER = Path(__file__).parent
KEPT = FOLDER / "real_time.csv"
CASES = ("2 m/s, curve", "2 m/s, curve, steered by the bus")
LONGEST = 400.0
"""of a drive, with its start and its end, s"""
NUMBERS = {"seen": 2, "released": 2, "stood": 2, "steered, cm": 0, "largest, cm": 0, "late, ms": 0}
"""columns with figures, and their digits"""
HEADER = ("case", "fault", "expected", "observed", "as expected", "cause", *NUMBERS)
NOT_DRIVEN, FAILED = "not driven", 1
EXPLAINED = """\
# Faults in real time

Made by `python experiments/faults/real_time.py` ([README.md](README.md)): each fault once, on stand-ins over sockets,
by real processes, signals and clocks; seed 0. {machine}

Times from the fault on, s: until the gate's state changed (seen), until nothing turned a wheel (released), until the
vehicle stood. The largest distance of either body from the path, cm: while drawbar steers, and until the vehicle
stands. Late: by how much the stand-in itself was late at most, ms.

{driven} faults driven, {held} as expected, {excluded} that no such drive can have{missing}.

"""


def driven(experiment: Experiment, case: str, run: Path) -> dict[str, float]:
    """Drive a case in real time, with seed 0; return its figures.

    Raises:
        DrawbarError: a process did not start.
        NotDrivenError: the fault is one that no such drive can have.
        RuntimeError: the fault's place was not reached.
    """
    task = experiment.tasks(1)[case][0]
    configuration = Configuration.model_validate(tomllib.loads(task.configuration))
    drives: list[SocketDrive] = []

    def drive(configuration, path, seed, _):
        drives.append(SocketDrive(configuration, path, seed, run))
        return drives[0]

    try:
        trial = Trial(configuration, 0, drive)
        for alteration in task.alterations:
            alteration.apply(trial)
        trial.approach()
        if task.fault is not None:
            task.fault.apply(trial)
        trial.watch()
    finally:
        for each in drives:
            each.close()
    columns = {f"watch.{name}": trial.column(name) for name in WATCHED}
    return {**figures(SimpleNamespace(columns=columns)), "late": 1e3 * drives[0].late}


def named(case: str) -> dict[str, str]:
    """Return the first cells of a row."""
    place, _, fault = case.partition(": ")
    return {"case": place, "fault": fault}


def row(experiment: Experiment, case: str, found: Mapping[str, float]) -> dict[str, str]:
    """Return a row of the table."""
    expected = experiment.expected[case]["response"]
    numbers = (found[name] for name in ("detected", "released", "stands", "steered", "largest", "late"))
    cause = found["cause"]
    return {
        **named(case),
        "expected": allowed(expected),
        "observed": RESPONSES[int(found["response"])],
        "as expected": "yes" if expected.holds(found["response"]) else "no",
        "cause": BY_CODE[int(cause)].name if cause in BY_CODE else "",
        **{
            name: f"{value:.{digits}f}" if math.isfinite(value) else ""
            for (name, digits), value in zip(NUMBERS.items(), numbers, strict=True)
        },
    }


def not_driven(experiment: Experiment, case: str, reason: str) -> dict[str, str]:
    """Return the row of a fault that no such drive can have."""
    expected = allowed(experiment.expected[case]["response"])
    return dict.fromkeys(HEADER, "") | {
        **named(case),
        "expected": expected,
        "observed": NOT_DRIVEN,
        "cause": reason,
    }


def drive_one(experiment: Experiment, case: str) -> int:
    """Print the row of one case as JSON; return an exit code."""
    with tempfile.TemporaryDirectory(prefix="drawbar-faults-") as folder:
        try:
            print(json.dumps(row(experiment, case, driven(experiment, case, Path(folder)))))
        except NotDrivenError as error:
            print(json.dumps(not_driven(experiment, case, str(error))))
        except (DrawbarError, RuntimeError) as error:
            print(error, file=sys.stderr)
            return FAILED
    return 0


def in_a_process(case: str) -> dict[str, str] | str:
    """Drive a case in a process of its own; return its row, or why there is none."""
    command = [sys.executable, __file__, "--one", case]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            told, complaint = process.communicate(timeout=LONGEST)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
            told, complaint = process.communicate()
    lines = complaint.strip().splitlines() or [f"exit code {process.returncode}"]
    return json.loads(told) if process.returncode == 0 else lines[-1]


def kept_rows(file: Path) -> dict[str, dict[str, str]]:
    """Return the rows that are there already, by the names of their cases."""
    if not file.exists():
        return {}
    with file.open(encoding="utf-8", newline="") as lines:
        return {f"{each['case']}: {each['fault']}": each for each in csv.DictReader(lines)}


def keep(file: Path, cases: list[str], rows: Mapping[str, dict[str, str]]) -> None:
    """Write the rows of cases, in their order, and the table."""
    ordered = [rows[case] for case in cases if case in rows]
    with file.open("w", encoding="utf-8", newline="") as lines:
        writer = csv.DictWriter(lines, HEADER, lineterminator="\n")
        writer.writeheader()
        writer.writerows(ordered)
    counted = [each for each in ordered if each["observed"] != NOT_DRIVEN]
    left = len(cases) - len(ordered)
    text = EXPLAINED.format(
        machine=f"{os.cpu_count()} cores of an {processor()}, {date.today()}.",
        driven=len(counted),
        held=sum(each["as expected"] == "yes" for each in counted),
        excluded=len(ordered) - len(counted),
        missing=f"; {left} not driven yet" if left else "",
    )
    table = [HEADER, ["---"] * len(HEADER), *([each[name] for name in HEADER] for each in ordered)]
    file.with_suffix(".md").write_text(text + "".join(f"| {' | '.join(cells)} |\n" for cells in table), "utf-8")


def drive_all(experiment: Experiment, wanted: list[str], file: Path, jobs: int) -> int:
    """Drive the cases whose names hold one of some texts, so many at once, and keep the rows; return an exit code."""
    cases = [case for case in experiment.configurations if named(case)["case"] in CASES]
    rows = kept_rows(file)
    due = [case for case in cases if case not in rows and any(text in case for text in wanted or [""])]
    failed = 0
    with ThreadPoolExecutor(jobs) as pool:
        coming = {pool.submit(in_a_process, case): case for case in due}
        try:
            for number, each in enumerate(as_completed(coming), 1):
                found, place = each.result(), f"{number} of {len(due)}: {coming[each]}"
                if isinstance(found, str):
                    failed += 1
                    print(f"{place}: not driven, {found}", flush=True)
                    continue
                rows[coming[each]] = found
                keep(file, cases, rows)
                failed += found["as expected"] == "no"
                held = f", NOT EXPECTED, but {found['expected']}" if found["as expected"] == "no" else ""
                print(f"{place}: {found['observed']}{held}; {found['cause']} {found['seen']}", flush=True)
        except KeyboardInterrupt:
            pool.shutdown(cancel_futures=True)  # those under way have been interrupted too
            print(f"interrupted; call it again to go on. What was driven is in {file}", file=sys.stderr)
            return 128 + signal.SIGINT
    return int(failed > 0)


def main() -> int:
    """Drive what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", default=[], metavar="TEXT", help="cases whose names hold this text")
    parser.add_argument("--jobs", type=int, default=1, help="drives at once (each takes half a core)")
    parser.add_argument(
        "--out", type=Path, default=KEPT, help=f"table of results (default: {KEPT.name} beside this file)"
    )
    parser.add_argument("--one", metavar="CASE", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    experiment = load_experiment(FOLDER)
    if asked.one:
        return drive_one(experiment, asked.one)
    return drive_all(experiment, asked.only, asked.out, asked.jobs)


if __name__ == "__main__":
    sys.exit(main())
