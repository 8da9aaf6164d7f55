"""`drawbar check` and `drawbar stand-in`: a machine's devices, listened to or stood in for."""

import tempfile
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated

import typer

from drawbar.cli.options import ConfigurationName, console

if TYPE_CHECKING:
    from drawbar.config import Configuration

Changes = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="change one value, e.g. speed=0.8")
]


def check(
    configuration: ConfigurationName,
    changes: Changes = None,
    seconds: Annotated[float, typer.Option(min=0.5, help="to listen to each device")] = 5.0,
) -> None:
    """Listen to every device that the configuration names, and say what is missing. Nothing is moved."""
    from rich.text import Text

    from drawbar.driving import check as checking
    from drawbar.driving.place import local_frame

    config = _with_devices(configuration, changes)
    assert config.devices is not None
    failed = False
    for finding in checking.check(config.devices, local_frame(config), seconds):
        console.print(Text(f"{finding.device}: {'; '.join(finding.facts) or 'not heard'}"))
        for problem in finding.problems:
            console.print(Text(f"  - {problem}", style="yellow"))
        failed |= bool(finding.problems)
    if failed:
        raise SystemExit(1)
    console.print("every device was heard, and nothing is missing", style="green")


def stand_in(configuration: ConfigurationName, changes: Changes = None) -> None:
    """Be the machine: the simulated one behind the receivers, boards and sensors that the configuration names."""
    from drawbar.driving.orders import Orders
    from drawbar.driving.stand_in_main import serve

    config = _with_devices(configuration, changes)
    with tempfile.TemporaryDirectory(prefix="drawbar-") as folder:
        file = FilePath(folder) / "config.toml"
        file.write_text(config.to_toml(), "utf-8")
        console.print("the simulated machine is there; end it by Ctrl-C")
        raise SystemExit(serve(Orders(folder=folder, run=folder, configuration=str(file))))


def _with_devices(name: str, changes: list[str] | None) -> "Configuration":
    from drawbar.config import load_configuration
    from drawbar.errors import ConfigurationError

    config = load_configuration(name, changes or [])
    if config.devices is None:
        raise ConfigurationError(
            f"{name} names no devices; add a section [devices] (docs/driving.md), or try `drawbar drive`, which "
            "stands in for all of them"
        )
    return config
