"""`drawbar tune`: search settings for the least error and the least steering."""

from pathlib import Path as FilePath
from typing import Annotated

import typer

from drawbar.cli.options import (
    Cluster,
    ConfigurationName,
    Jobs,
    changing,
    console,
    continued_later,
    one_cluster,
    written,
)


def tune(
    configuration: ConfigurationName,
    more: Annotated[list[str] | None, typer.Argument(metavar="RANGES", help="more of --parameters")] = None,
    parameters: Annotated[
        list[str] | None,
        typer.Option(metavar="KEY=LOW..HIGH", help="what is searched; on a logarithmic scale with :log behind it"),
    ] = None,
    trials: Annotated[int, typer.Option(min=1, help="in all; the configuration's own values are the first")] = 64,
    changes: Annotated[list[str] | None, changing("tuning.seeds=10")] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the search")] = 0,
    jobs: Jobs = None,
    cluster: Cluster = "",
    out: Annotated[
        FilePath | None,
        typer.Option(parser=written, metavar="PATH", help="folder for the results; default: runs/NAME-tune"),
    ] = None,
) -> None:
    """Search weights or look-ahead for the least error and the least steering; the same command continues."""
    from drawbar.extras import require_extra

    require_extra("drawbar tune", "experiments")
    from drawbar.experiment.tuning import command  # imports the extras
    from drawbar.experiment.tuning.parameters import read_space

    one_cluster(jobs, cluster)
    space = read_space(configuration, changes or [], [*(parameters or []), *(more or [])])
    folder = out or FilePath("runs") / f"{space.configuration.name}-tune"
    budget = command.Budget(trials=trials, seed=seed, jobs=jobs, address=cluster)
    with continued_later():
        command.tune(console, space, folder, budget)
