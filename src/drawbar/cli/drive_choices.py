"""Drive choices: what `drawbar drive` is to drive, by its options; what cannot be is refused before anything starts."""

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

from drawbar.cli.options import console

if TYPE_CHECKING:
    from drawbar.cli.pages import Pages
    from drawbar.config import Configuration

_NEAREST = "nearest"
"""--track: the line at which the vehicle stands"""
LIVE_PORT = 8765
"""of --live, where none is given: Foxglove's own"""


def demand_no_pages(pages: "Pages") -> None:
    """Raise ConfigurationError where options of the console are given although it is not to be served."""
    from drawbar.errors import ConfigurationError

    given = [f"--{each.name}" for each in fields(pages) if (getattr(pages, each.name) or None) != each.default]
    if given:
        raise ConfigurationError(f"without --console no pages are served; add it, or leave out {', '.join(given)}")


def demand_no_live_port(port: int) -> None:
    """Raise ConfigurationError where the port of the live log is given although it is not to be shown."""
    from drawbar.errors import ConfigurationError

    if port != LIVE_PORT:
        raise ConfigurationError("without --live no live log is served; add it, or leave out --live-port")


def demand_real_time(pace: int) -> None:
    """Raise ConfigurationError where the console would show a drive at another pace."""
    from drawbar.errors import ConfigurationError

    if pace != 1:
        raise ConfigurationError(f"--console shows a drive in real time; leave out --pace {pace}, or --console")


def demand_what_is_remembered(configuration: str, changes: list[str], *, shadow: bool) -> None:
    """Raise ConfigurationError where a drive shows nothing of the machine's steerings, or that cannot be written."""
    from drawbar.config import load_configuration
    from drawbar.driving.devices.pace import shown_pace
    from drawbar.errors import ConfigurationError

    if shadow:
        raise ConfigurationError("--remember keeps what steering shows, --shadow steers nothing; leave out one of them")
    if not Path(configuration).is_file():
        raise ConfigurationError(
            f"--remember writes beside a configuration's file, {configuration} is none; give a file, or leave out "
            "--remember"
        )
    devices = load_configuration(configuration, changes).devices
    if devices is None or shown_pace(devices) is not None:
        which = "[devices] are not configured" if devices is None else "`drawbar stand-in` runs at these devices"
        raise ConfigurationError(
            f"--remember keeps how the steerings of your machine move, and stand-ins would be driven: {which}; leave "
            "out --remember, or drive the machine"
        )


def chosen_track(name: str, track: str, changes: list[str]) -> str:
    """Return the name of the line that --track means."""
    from drawbar.config import load_configuration
    from drawbar.driving.preparation.nearest_line import nearest_track, standing
    from drawbar.errors import ConfigurationError

    if track != _NEAREST:
        return track
    config = load_configuration(name, changes)
    if config.devices is None:
        raise ConfigurationError(
            "--track nearest: without [devices] there is no vehicle that stands anywhere; give --track NAME"
        )
    with console.status("listening where the vehicle stands …"):
        nearest = nearest_track(config, standing(config.devices))
    console.print(f"the nearest line is {nearest!r}", soft_wrap=True)
    return nearest


def configured(name: str, changes: list[str], pace: int) -> tuple["Configuration", bool]:
    """Return what to drive, and whether all of its devices are stand-ins."""
    from drawbar.config import load_configuration
    from drawbar.driving.devices.pace import demand_stand_in
    from drawbar.driving.preparation.matching_settings import demand_matching_settings
    from drawbar.driving.stand_in.demonstration import with_stand_ins
    from drawbar.machine.hardware.corrections.corrections import new_client

    config = load_configuration(name, changes)
    demand_matching_settings(config)
    stand_ins = config.devices is None
    if config.devices is not None:
        demand_stand_in(config.devices, pace)
        if config.devices.corrections is not None:
            new_client(config.devices.corrections)  # what it lacks is said before anything starts
    else:
        config = with_stand_ins(config)
        time_passes = "in real time" if pace == 1 else f"{pace} times as fast as real time"
        console.print(f"no [devices] are configured: driving stand-ins of all of them on this computer, {time_passes}")
    return config, stand_ins


def tell_room(folder: Path, config: "Configuration") -> None:
    """Print for how long the disk has room for the log, where that is not long; StorageError: for less than an hour."""
    from drawbar.driving.preparation.disk_room import room_note

    if note := room_note(folder, config.sample_time, config.recording.room):
        console.print(note, style="yellow", soft_wrap=True)
