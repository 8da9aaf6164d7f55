"""`drawbar calibrate` and `drawbar identify`: a machine's numbers, from logs or by moving it a little."""

from collections.abc import Sequence
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated

import typer

from drawbar.cli.options import RunLogFile, RunLogFileIfAny, agreed, console
from drawbar.cli.whole_files import write_whole
from drawbar.errors import ConfigurationError, DrawbarError

if TYPE_CHECKING:
    from drawbar.config import Configuration
    from drawbar.driving.preparation.hand_calibration import CalibrationResult
    from drawbar.driving.preparation.push_calibration import PushCalibration
    from drawbar.signals import Actuation, BodyActuation

_NOTED_LATENCY = 0.02
"""of fixes, from which on it is worth a setting, s"""
_SHORTEST = 10.0
"""drive that shows anything, s"""
_FAR = 0.1
"""share of a drive too far from the line, from which on it is reported"""
WIDE = ("--set guidance.maximum_start_distance=900", "--set sanity.lost=1000")
"""with which a drive by hand estimates far from its line, too"""


def calibrate(
    configuration: Annotated[FilePath, typer.Argument(metavar="FILE", help="configuration of the machine")],
    log: RunLogFileIfAny = None,
    push: Annotated[
        bool, typer.Option("--push", help="instead of a log: move a bare valve or motor a little; asks twice before")
    ] = False,
) -> None:
    """Find what a drive shows: of sensors, wheels and antenna by hand; of the steerings where drawbar steered.

    What is found is written beside FILE, as NAME.calibrated.toml, which extends it: drive with that file. Nothing is
    moved but with --push, which finds direction, dead bands, rates and the sensor's scale of a valve or motor without
    a loop of its own. docs/calibration.md describes what to drive.
    """
    from drawbar.config import load_configuration

    config = load_configuration(str(configuration))
    if push == (log is not None):
        raise DrawbarError("calibrate needs a log or --push, one of them; give the folder of a drive, or --push")
    found, source = (_in_log(log), _drive_of(log)) if log is not None else (_pushed(config), "--push")
    for each in found:
        _tell(each)
    if not any(each.sets for each in found):
        console.print("nothing is written")
        raise SystemExit(1)
    _write(configuration, found, source)
    if any(".memory." in key for each in found for key in each.sets):
        console.print("the boards do not know it yet: write it to them by drawbar check --store, or by AgOpenGPS")


def _in_log(log: FilePath) -> "list[CalibrationResult]":
    from drawbar.config import recorded_configuration
    from drawbar.driving.preparation.dead_bands import dead_bands
    from drawbar.driving.preparation.hand_calibration import calibrate as evaluate
    from drawbar.driving.preparation.hand_drive import HandDrive
    from drawbar.driving.preparation.steering_memory import steering_memory
    from drawbar.messages import GateState
    from drawbar.recording.drive_records import open_drive
    from drawbar.recording.log import read_log

    content = read_log(log)
    recorded = recorded_configuration(content.header.configuration, [], str(log))
    if recorded.devices is None:
        raise ConfigurationError(f"{log}: was not recorded on a machine; give the log of a `drawbar drive`")
    with open_drive(log) as records:
        states = [each for each in records if isinstance(each, GateState) and each.steers]
    for shortcoming in content.shortcomings:
        console.print(f"{log}: {shortcoming}", style="bold yellow", soft_wrap=True)
    drive = HandDrive.of(content)
    if len(drive.times) * recorded.sample_time < _SHORTEST:
        raise DrawbarError(f"{log}: is less than {_SHORTEST:g} s of driving; give the log of a longer drive")
    if drive.far_from_line > _FAR:
        console.print(
            f"in {100.0 * drive.far_from_line:.0f} % of the drive the vehicle was too far from the line, where nothing "
            f"is estimated: drive again, without engaging, by `drawbar drive {' '.join(WIDE)}`",
            style="yellow",
            soft_wrap=True,
        )
    return [*evaluate(recorded, drive), *dead_bands(states), *steering_memory(recorded, content.records)]


def remember(configuration: FilePath, log: FilePath) -> None:
    """Write what a drive has shown of both steerings to the configuration's calibrated file; print why not the rest."""
    from drawbar.config import recorded_configuration
    from drawbar.driving.preparation.steering_memory import steering_memory
    from drawbar.recording.log import read_log

    content = read_log(log)
    recorded = recorded_configuration(content.header.configuration, [], str(log))
    found = list(steering_memory(recorded, content.records))
    for each in found:
        _tell(each)
    if any(each.sets for each in found):
        _write(configuration, found, _drive_of(log))
    else:
        console.print("nothing of the steerings is kept for the next drive")


def _pushed(config: "Configuration") -> "list[CalibrationResult]":
    """Push the bare valve if the operator wants it, twice; return what that shows."""
    from drawbar.cli.interrupts import ended_by_signals
    from drawbar.driving.preparation.push_calibration import (
        PushCalibration,
        ReceiverMotion,
        bare_valve_settings,
        open_bare_valve,
    )
    from drawbar.extras import require_extra
    from drawbar.machine.calibration.pushing import CalibrationLimits

    require_extra("drawbar calibrate --push", "machine")
    settings = bare_valve_settings(config)
    limits = CalibrationLimits()
    console.print(
        "The valve or motor turns the front wheels by some degrees to both sides, for about three minutes. Roll "
        f"straight ahead between {limits.slowest} and {limits.fastest} m/s, better near 1 m/s, somebody on the seat "
        "with the switch held, nobody near the machine. Ctrl-C or letting the switch go ends it."
    )
    if not agreed("Is the field ahead clear, and is somebody on the seat?", "Move the front wheels now?"):
        raise SystemExit(1)
    assert config.devices is not None
    with ended_by_signals(), closing(ReceiverMotion(config.devices.tractor_receiver)) as motion:
        valve = open_bare_valve(settings, config.vehicle.wheelbase, motion)
        with closing(valve):
            pushing = PushCalibration(valve, settings)
            with console.status(Progress(pushing)):
                found = pushing.run()
    if pushing.reason:
        raise DrawbarError(pushing.reason)
    return found


class Progress:
    """How far pushes are, for a terminal."""

    def __init__(self, pushing: "PushCalibration") -> None:
        """Take the pushes."""
        self._pushing = pushing

    def __rich__(self) -> str:
        """Return it in words."""
        from drawbar.driving.preparation.push_calibration import PUSHES
        from drawbar.machine.calibration.valve import RUNS

        rates = self._pushing.rates
        if rates is not None:
            return f"rate and lag: push {min(rates.done + 1, 2 * PUSHES)} of {2 * PUSHES}"
        if self._pushing.started:
            return f"dead band: run {min(self._pushing.bands.done + 1, 2 * RUNS)} of {2 * RUNS}"
        return "waiting for the vehicle to roll and for the switch to be held"


def _drive_of(log: FilePath) -> str:
    """Return by what a drive is known: its folder's name, or that of a log which was renamed."""
    from drawbar.recording.log import LOG_NAME

    return log.resolve().parent.name if log.name == LOG_NAME else log.name


def _write(configuration: FilePath, found: "Sequence[CalibrationResult]", source: str) -> None:
    from drawbar.config import load_configuration
    from drawbar.driving.preparation.calibrated_file import calibrated_file, calibrated_text

    file = calibrated_file(configuration)
    text = calibrated_text(configuration, found, datetime.now(UTC).date(), source)
    try:
        write_whole(file, lambda part: part.write_text(text, "utf-8"))
    except OSError as error:
        raise DrawbarError(f"{file}: cannot be written ({error.strerror}); choose another folder") from error
    load_configuration(str(file))
    console.print(f"written: {file}", soft_wrap=True)


def _tell(found: "CalibrationResult") -> None:
    from rich.text import Text

    value = found.value
    if value.accepted:
        text = f"{found.name}: {value.text} {value.unit}"
        console.print(Text(text + "".join(f"\n    {key} = {each}" for key, each in found.sets.items())))
    for refusal in value.refusals:
        console.print(Text(f"{found.name}: {refusal}", style="yellow"))


def identify(log: RunLogFile) -> None:
    """Find dead time, lag and rate of both steerings, late fixes, askew roll sensors and wrong scales in a log."""
    from drawbar.config import recorded_configuration
    from drawbar.driving.preparation.steering_memory import longest_steering
    from drawbar.estimation.identification import identify as evaluate
    from drawbar.recording.log import read_log
    from drawbar.report.masts import mounting_text

    content = read_log(log)
    for shortcoming in content.shortcomings:
        console.print(f"{log}: {shortcoming}", style="bold yellow", soft_wrap=True)
    recorded = recorded_configuration(content.header.configuration, [], str(log))
    steered = longest_steering(content.records)
    if len(steered) * recorded.sample_time < _SHORTEST:
        raise DrawbarError(f"{log}: steers for less than {_SHORTEST:g} s without a gap; give the log of a longer run")
    steps = ((record.measurement, record.command) for record in steered)
    found = evaluate(steps, recorded.vehicle, recorded.actuation, recorded.sample_time)
    _tell_steering("front wheels", found.tractor)
    _tell_steering("joint", found.trailer)
    console.print(
        f"stated: vehicle.dead_time = {recorded.vehicle.dead_time} s, "
        f"vehicle.steering_lag = {recorded.vehicle.steering_lag} s, "
        f"vehicle.tractor_steering_rate = {recorded.vehicle.tractor_steering_rate:.3g} rad/s, "
        f"vehicle.trailer_steering_rate = {recorded.vehicle.trailer_steering_rate:.3g} rad/s",
        soft_wrap=True,
    )
    for body in ("tractor", "trailer"):
        if text := mounting_text(content, body):
            console.print(text, soft_wrap=True)
    latency = steered[-1].actuation.fix_latency
    if latency > _NOTED_LATENCY:
        console.print(
            f"fixes: at least {latency:.2f} s later than told; add it to latency of [devices.tractor_receiver] and "
            "[devices.trailer_receiver], elsewhere to sensors.fixes.age",
            soft_wrap=True,
        )
    _tell_scales(steered[-1].actuation)


def _tell_scales(known: "Actuation") -> None:
    """Print what the angles of hitch and joint were multiplied by, where they were."""
    for name, scale, advice in (
        ("hitch angle", known.hitch_scale, "multiply devices.sensors.hitch_angles by that"),
        ("joint", known.joint_scale, "divide its board's counts_per_degree by that"),
    ):
        if scale:
            console.print(
                f"{name}: {1.0 + scale:.2f} times what its sensor shows; {advice}, or calibrate it", soft_wrap=True
            )


def _tell_steering(name: str, found: "BodyActuation") -> None:
    console.print(
        f"{name}: dead time {found.dead_time:.2f} ± {found.dead_time_deviation:.2f} s, "
        f"lag {found.lag:.2f} ± {found.lag_deviation:.2f} s, rate {found.rate:.3f} ± {found.rate_deviation:.3f} rad/s",
        soft_wrap=True,
    )
