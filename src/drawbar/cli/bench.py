"""`drawbar bench`: measure what the solvers cost."""

from pathlib import Path as FilePath
from typing import Annotated

import typer

from drawbar.cli.options import console, written


def bench(
    json: Annotated[
        FilePath | None, typer.Option(parser=written, metavar="PATH", help="also write the figures to this file")
    ] = None,
) -> None:
    """Measure the solvers: phases, floor, bounds, growth, other solvers beside them, and the whole step in C."""
    from drawbar.benchmark.bench import run_benchmark

    run_benchmark(console, json)
