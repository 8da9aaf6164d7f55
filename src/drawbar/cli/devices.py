"""`drawbar check` and `drawbar stand-in`: a machine's devices, listened to or stood in for."""

import tempfile
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from drawbar.cli.options import ConfigurationName, Pace, agreed, changing, console
from drawbar.configurations import CONFIGURATION_NAME

if TYPE_CHECKING:
    from collections.abc import Iterable

    from drawbar.config import Configuration
    from drawbar.driving.preparation.finding import Finding
    from drawbar.machine.hardware.devices import DeviceSettings

Changes = Annotated[list[str] | None, changing("speed=0.8")]


def check(
    configuration: ConfigurationName,
    changes: Changes = None,
    seconds: Annotated[float, typer.Option(min=0.5, help="to listen to each device")] = 5.0,
    wiggle: Annotated[
        bool, typer.Option("--wiggle", help="then move each steering by 2° to both sides; asks twice before")
    ] = False,
    store: Annotated[
        bool,
        typer.Option("--store", help="write the configured memory to AgOpenGPS boards first; asks twice before"),
    ] = False,
) -> None:
    """Listen to every configured device, and print what is missing. Without --wiggle nothing is moved.

    The wiggle test tries sign, range and delay of both steerings while the vehicle rolls straight ahead; without it
    `drawbar drive` does not engage. It holds until the computer restarts, for 12 hours at most.
    """
    from drawbar.extras import require_extra

    require_extra("drawbar check", "machine")
    from drawbar.driving.devices.path_frame import local_frame
    from drawbar.driving.preparation import check as checking  # imports the extra
    from drawbar.driving.preparation.matching_settings import demand_matching_settings

    config = _with_devices(configuration, changes)
    demand_matching_settings(config)
    assert config.devices is not None
    oldest = config.safety.engage.correction_age
    frame = local_frame(config)
    if not _tell(checking.check(config.devices, frame, seconds, config.sample_time, oldest=oldest)):
        raise SystemExit(1)
    console.print("every device reports, and nothing is missing", style="green")
    if store and not _store(config.devices):
        raise SystemExit(1)
    if wiggle and not _wiggle(config):
        raise SystemExit(1)


def _tell(findings: "Iterable[Finding]") -> bool:
    """Print what was found of each device; return whether nothing is missing."""
    from rich.text import Text

    fine = True
    for finding in findings:
        console.print(Text(f"{finding.device}: {'; '.join(finding.facts) or 'reports nothing'}"))
        for problem in finding.problems:
            console.print(Text(f"  - {problem}", style="yellow"))
        fine &= not finding.problems
    return fine


def _store(devices: "DeviceSettings") -> bool:
    """Write the boards' memories if the operator wants it, twice; return whether all were."""
    from drawbar.driving.preparation.board_memory import store_board_memories

    console.print(
        "The boards are to store [devices.tractor_board.memory] and [devices.trailer_board.memory], all values: "
        "each write wears them out, and a board whose motor changes restarts."
    )
    if not agreed("Does the vehicle stand, with nobody at the steering?", "Write to the boards now?"):
        return False
    return _tell(store_board_memories(devices))


def _wiggle(config: "Configuration") -> bool:
    """Make the wiggle test if the operator wants it, twice; return whether it is passed."""
    from rich.text import Text

    from drawbar.cli.interrupts import ended_by_signals
    from drawbar.driving.preparation.wiggle import FASTEST, ROLLS, SLOWEST, wiggle_both
    from drawbar.driving.preparation.wiggle_record import forget_passed, keep_passed

    console.print(
        "The wiggle test turns the front wheels, then the joint, by 2° to the left first, to the right and back (a "
        "joint turns to the left where the drawbar then points to the left of the trailer): watch whether they do, "
        "since a sensor and a motor that are both the wrong way round pass, and so do boards that are exchanged. Roll "
        "straight ahead at "
        f"{SLOWEST} to {FASTEST} m/s, somebody on the seat, nobody near the machine; it begins once the vehicle rolls, "
        f"within {ROLLS:.0f} s. Ctrl-C ends it."
    )
    if not agreed("Is the field ahead clear, and is somebody on the seat?", "Move the steering now?"):
        return False
    forget_passed()
    passed = True
    with ended_by_signals():
        for name, found in wiggle_both(config):
            if found.passed:
                console.print(Text(f"{name}: gain {found.gain:.2f}, delay {found.delay:.2f} s"))
            for refusal in found.refusals:
                console.print(Text(f"  - {name}: {refusal}", style="yellow"))
            passed &= found.passed
    if passed:
        keep_passed(config)
        console.print("the wiggle test is passed: `drawbar drive` may engage", style="green")
    return passed


def _or_list(faults: list[str] | None) -> list[str] | None:
    """Return the faults asked for; `list` prints what there is and ends the command, whatever else is given."""
    from drawbar.machine.stand_in.faults import FAULTS, LIST

    if LIST in (faults or []):
        for name, each in FAULTS.items():
            console.print(f"{name}: {each.text}", soft_wrap=True)
        raise typer.Exit
    return faults


def stand_in(
    configuration: ConfigurationName,
    changes: Changes = None,
    fault: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME[@20s]",
            help="break something, so long after it has first been steered; list: what there is",
            callback=_or_list,
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
    from drawbar.machine.stand_in.faults import planned_fault

    require_extra("drawbar stand-in", "machine")
    faults = [planned_fault(text) for text in fault or []]
    config = _with_devices(configuration, changes)
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
