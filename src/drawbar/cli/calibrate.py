"""`drawbar calibrate` and `drawbar identify`: a machine's numbers from logs."""

from datetime import UTC, datetime
from itertools import groupby
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated

import typer

from drawbar.cli.options import RunLogFile, console
from drawbar.errors import ConfigurationError, DrawbarError

if TYPE_CHECKING:
    from drawbar.driving.calibrating import Found
    from drawbar.signals import BodyActuation


def calibrate(
    configuration: Annotated[FilePath, typer.Argument(metavar="FILE", help="configuration of the machine")],
    log: RunLogFile,
) -> None:
    """Find sensors' zeros and scales, the wheels' pulses, mounting roll, antenna's place and dead bands in a drive.

    What is found is written beside FILE, as NAME.calibrated.toml, which extends it: drive with that file. Nothing is
    moved. docs/calibration.md says what to drive.
    """
    from drawbar.config import load_configuration, recorded_configuration
    from drawbar.driving.calibrated_file import calibrated_file, calibrated_text
    from drawbar.driving.calibrating import calibrate as evaluate
    from drawbar.driving.hand_drive import HandDrive
    from drawbar.driving.loop_drive import dead_bands
    from drawbar.messages import GateState
    from drawbar.recording.drive_records import open_drive
    from drawbar.recording.log import read_log

    load_configuration(str(configuration))
    content = read_log(log)
    recorded = recorded_configuration(content.header.configuration, [], str(log))
    if recorded.devices is None:
        raise ConfigurationError(f"{log}: is the log of no real machine; give the log of a `drawbar drive`")
    with open_drive(log) as records:
        states = [each for each in records if isinstance(each, GateState) and each.steers]
    found = [*evaluate(recorded, HandDrive.of(content)), *dead_bands(states)]
    for each in found:
        _tell(each)
    if not any(each.sets for each in found):
        console.print("nothing is written")
        raise SystemExit(1)
    file = calibrated_file(configuration)
    text = calibrated_text(configuration, found, datetime.now(UTC).date(), log.name)
    try:
        file.write_text(text, "utf-8")
    except OSError as error:
        raise DrawbarError(f"{file}: cannot be written ({error.strerror}); choose another folder") from error
    load_configuration(str(file))
    console.print(f"written: {file}", soft_wrap=True)
    if any(".memory." in key for each in found for key in each.sets):
        console.print("the boards do not know it yet: enter their numbers by AgOpenGPS, or what else sets them up")


def _tell(found: "Found") -> None:
    from rich.text import Text

    value = found.value
    if value.accepted:
        text = f"{found.name}: {value.value:.6g} ± {value.deviation:.2g} {value.unit}"
        console.print(Text(text + "".join(f"\n    {key} = {each}" for key, each in found.sets.items())))
    for refusal in value.refusals:
        console.print(Text(f"{found.name}: {refusal}", style="yellow"))


def identify(log: RunLogFile) -> None:
    """Find dead time and lag of both steerings in the log of a run or a drive, for `vehicle` of the configuration."""
    from drawbar.config import recorded_configuration
    from drawbar.estimation.identification import identify as evaluate
    from drawbar.recording.log import read_log
    from drawbar.signals import Flag

    content = read_log(log)
    recorded = recorded_configuration(content.header.configuration, [], str(log))
    stretches = groupby(content.records, key=lambda record: bool(record.flags & Flag.RELEASED))
    steered = max((list(records) for released, records in stretches if not released), key=len, default=[])
    if len(steered) * recorded.sample_time < 10.0:
        raise DrawbarError(f"{log}: steers for less than 10 s; give the log of a longer run")
    steps = ((record.measurement, record.command) for record in steered)
    found = evaluate(steps, recorded.vehicle, recorded.actuation, recorded.sample_time)
    _tell_steering("front wheels", found.tractor)
    _tell_steering("joint", found.trailer)
    console.print(
        f"stated: vehicle.dead_time = {recorded.vehicle.dead_time} s, "
        f"vehicle.steering_lag = {recorded.vehicle.steering_lag} s"
    )


def _tell_steering(name: str, found: "BodyActuation") -> None:
    console.print(
        f"{name}: dead time {found.dead_time:.2f} ± {found.dead_time_deviation:.2f} s, "
        f"lag {found.lag:.2f} ± {found.lag_deviation:.2f} s"
    )
