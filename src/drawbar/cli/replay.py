"""`drawbar replay`: recompute a recorded run, and show where it differs."""

from typing import TYPE_CHECKING, Annotated

import typer

from drawbar.cli.options import RunLogFile, console
from drawbar.errors import DrawbarError

if TYPE_CHECKING:
    from drawbar.recompute import Replay


def replay(
    log: RunLogFile,
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="try another setting, e.g. controller.tractor.lateral=50"),
    ] = None,
) -> None:
    """Recompute a run from its recorded measurements, and compare estimates, plans and commands number by number.

    A drive is recomputed from the raw bytes of its receivers and sensors, and its fixes are compared as well.

    With the same build of drawbar on the same machine every number is the recorded one; else, or with --set, the first
    difference is told. Exit code 1: a number differs although no setting was changed.
    """
    from drawbar.recording.drive_records import is_drive
    from drawbar.report.tables import counted

    if is_drive(log):
        from drawbar.extras import require_extra

        require_extra("drawbar replay of a drive", "machine")
        from drawbar.driving.evaluation.replay import replay_drive  # imports the extra

        recomputed = replay_drive(log, changes or [])
    else:
        from drawbar.recompute import replay as recompute
        from drawbar.recording.log import read_log

        recomputed = recompute(read_log(log), changes or [])
    if not recomputed.records:
        raise DrawbarError(f"{log}: holds no step to recompute; give the log of a run that was longer")
    console.print(f"{log}: {counted(len(recomputed.records), 'step')} recomputed", soft_wrap=True)
    if recomputed.cut:
        console.print(f"what follows cannot be recomputed: {recomputed.cut}", style="bold yellow", soft_wrap=True)
    if not recomputed.differences:
        console.print("every number is the recorded one, bit for bit")
        return
    _tell(recomputed)
    raise SystemExit(0 if changes else 1)


def _tell(recomputed: "Replay") -> None:
    """Print the first difference, and the signals that differ most."""
    first = recomputed.differences[0]
    console.print(
        f"first difference: step {first.step}, {first.signal}: recorded {first.recorded!r}, "
        f"recomputed {first.recomputed!r}, difference {first.size:.3g}"
    )
    groups: dict[str, tuple[int, float]] = {}
    for each in recomputed.differences:  # the numbers of an array are one signal
        name = each.signal.rstrip("0123456789").rstrip(".")
        step, largest = groups.get(name, (each.step, 0.0))
        groups[name] = step, max(largest, recomputed.largest[each.signal])
    console.print("signals that differ: first step, largest difference")
    for name, (step, largest) in groups.items():
        console.print(f"  {name:34s} {step:6d}  {largest:9.3g}")
