"""acados on the problems of the shipped configurations, beside drawbar: `python -m drawbar.benchmark.acados FOLDER`.

FOLDER is where `pip install --no-deps --target FOLDER comma-deps-acados` has put acados. Shipped configurations are
driven in closed loop; at each sample acados is given the same problem from the same trajectory, with each of its
solvers of quadratic programs.
"""

import sys
from argparse import ArgumentParser
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from rich.console import Console
from rich.progress import Progress

from drawbar.benchmark.acados.comparison import AcadosProbe, rows
from drawbar.benchmark.acados.installation import PACKAGE, installed_version, silent, template
from drawbar.benchmark.closed_loop import probed_runs
from drawbar.benchmark.figures import machine, one_core
from drawbar.benchmark.tables import acados_table
from drawbar.errors import DrawbarError

STAGES, STEPS = 15, 200
LOOPS = ("paper", "paper-centralised", "articulated", "articulated-centralised")


def compare(folder: Path, name: str, steps: int, changes: list[str]) -> Iterator[dict[str, Any]]:
    """Drive a shipped configuration; yield the figures of each of its solvers and of acados'.

    Args:
        folder: in which acados is.
        name: of the configuration.
        steps: samples of the closed loop, 2 or more.
        changes: KEY=VALUE, to the configuration.

    Raises:
        DrawbarError: there is no acados, or its solvers cannot be built.
    """
    with TemporaryDirectory() as work:
        make = partial(AcadosProbe, template(folder), Path(work))
        (probes,) = probed_runs(name, [STAGES], steps, with_peers=False, changes=changes, make=make)
        for probe in probes:
            assert isinstance(probe, AcadosProbe)
            yield from rows(probe)


def main() -> int:
    """Print the table; return an exit code."""
    parser = ArgumentParser(prog="python -m drawbar.benchmark.acados")
    parser.add_argument("folder", type=Path, help="where pip has put acados")
    parser.add_argument("--steps", type=int, default=STEPS, help=f"samples of each closed loop (default: {STEPS})")
    parser.add_argument("--only", action="append", choices=LOOPS, help="drive this configuration; may be repeated")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change the configurations")
    options = parser.parse_args()
    if options.steps < 2:
        parser.error(f"--steps {options.steps}: must be 2 or more")
    one_core()
    try:
        with silent(), Progress(console=Console(stderr=True), transient=True) as progress:
            loops = progress.track(options.only or LOOPS, description="closed loops")
            found = [row for name in loops for row in compare(options.folder, name, options.steps, options.set)]
    except DrawbarError as error:
        print(error, file=sys.stderr)
        return 2
    console = Console()
    console.print(acados_table(found, STAGES))
    about = f"{PACKAGE} {installed_version(options.folder)}, on {machine()['processor']}"
    console.print(about, markup=False, highlight=False)
    return 0


if __name__ == "__main__":
    sys.exit(main())
