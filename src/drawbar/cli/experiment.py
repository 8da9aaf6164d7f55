"""`drawbar experiment`: many seeds of every case, their tables and figures."""

from pathlib import Path
from typing import Annotated

import typer

from drawbar.cli.options import Cluster, Jobs, console, continued_later, one_cluster


def experiment(
    name: Annotated[str, typer.Argument(metavar="NAME", help="folder in experiments/, or its path; all: every one")],
    seeds: Annotated[int | None, typer.Option(min=1, help="runs of each case; default: as the experiment says")] = None,
    only: Annotated[
        list[str] | None,
        typer.Option(metavar="TEXT", help="drive the cases whose names hold this only; may be repeated"),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="write the results to FOLDER/NAME; default: into the experiment's folder"),
    ] = None,
    jobs: Jobs = None,
    cluster: Cluster = "",
) -> None:
    """Drive every case of an experiment with many seeds, and write its tables and figures."""
    from drawbar.extras import require_extra

    require_extra("drawbar experiment", "experiments")
    from drawbar.experiment.command import run_experiments  # imports the extras

    one_cluster(jobs, cluster)
    with continued_later():
        met = run_experiments(console, name, seeds=seeds, only=only or (), out=out, jobs=jobs, address=cluster)
    raise SystemExit(0 if met else 1)
