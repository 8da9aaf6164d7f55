"""`drawbar check`: a machine's devices listened to, their boards' memories written, and its steerings tried."""

from typing import TYPE_CHECKING, Annotated

import typer

from drawbar.cli.options import ConfigurationName, agreed, changing, configured_devices, console

if TYPE_CHECKING:
    from collections.abc import Iterable

    from drawbar.config import Configuration
    from drawbar.driving.preparation.finding import Finding
    from drawbar.machine.hardware.devices import DeviceSettings


def check(
    configuration: ConfigurationName,
    changes: Annotated[list[str] | None, changing("speed=0.8")] = None,
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

    config = configured_devices(configuration, changes)
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
