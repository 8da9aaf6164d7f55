"""`drawbar stand-in`: a machine's devices stood in for, the simulated machine behind them."""

import tempfile
from pathlib import Path as FilePath
from typing import Annotated, Literal

import typer

from drawbar.cli.options import ConfigurationName, Pace, changing, configured_devices, console
from drawbar.configurations import CONFIGURATION_NAME


def _names_or_list(faults: list[str] | None) -> list[str] | None:
    """Return the faults asked for; `list` prints what there is and ends the command, whatever else is given."""
    from drawbar.machine.stand_in.fault_plan import LIST
    from drawbar.machine.stand_in.faults import FAULTS

    if LIST in (faults or []):
        for name, each in FAULTS.items():
            console.print(f"{name}: {each.text}", soft_wrap=True)
        raise typer.Exit
    return faults


def stand_in(
    configuration: ConfigurationName,
    changes: Annotated[list[str] | None, changing("speed=0.8")] = None,
    fault: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME[@20s]",
            help="break something, so long after it has first been steered; list: what there is",
            callback=_names_or_list,
            is_eager=True,
        ),
    ] = None,
    boards: Annotated[Literal["aio-v4", "aio-26"], typer.Option(help="firmware of the steer boards")] = "aio-v4",
    pace: Pace = 1,
) -> None:
    """Be the machine: the simulated one behind the devices that the configuration names.

    Receivers, boards, sensors, ISOBUS, and the caster of corrections where its host is this computer (127.0.0.1).
    With --pace it is so many times as fast as real time, and so must be the drive.
    """
    from drawbar.driving.devices.pace import refuse_elsewhere
    from drawbar.driving.messaging.process_options import ProcessOptions
    from drawbar.driving.stand_in.stand_in_machine import Firmware
    from drawbar.driving.stand_in.stand_in_main import serve
    from drawbar.extras import require_extra
    from drawbar.machine.stand_in.fault_plan import planned_fault

    require_extra("drawbar stand-in", "machine")
    faults = [planned_fault(text) for text in fault or []]
    config = configured_devices(configuration, changes)
    assert config.devices is not None
    refuse_elsewhere(config.devices, pace)
    with tempfile.TemporaryDirectory(prefix="drawbar-") as folder:
        file = FilePath(folder) / CONFIGURATION_NAME
        file.write_text(config.to_toml(), "utf-8")
        options = ProcessOptions(folder=folder, run=folder, configuration=str(file), pace=pace)
        firmware = Firmware(boards)
        raise SystemExit(
            serve(
                options,
                faults,
                lambda words: console.print(f"fault: {words}", soft_wrap=True),
                firmware,
                lambda: console.print("the simulated machine is there; end it by Ctrl-C"),
            )
        )
