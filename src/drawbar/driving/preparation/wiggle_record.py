"""Wiggle record: the actuators have passed the wiggle test; kept from `drawbar check --wiggle` until `drawbar drive`.

It holds for the very same actuators, until the computer restarts, and for LONGEST at most. It is kept in the folder
that systemd gives a service (`STATE_DIRECTORY`), else in the user's own.
"""

import hashlib
import json
import os
import time
from pathlib import Path

from platformdirs import user_state_path

from drawbar.config import Configuration
from drawbar.errors import StorageError

LONGEST = 12.0 * 3600.0
"""s; a working day"""
_BOOT = Path("/proc/sys/kernel/random/boot_id")


def keep_passed(configuration: Configuration) -> None:
    """Keep that the actuators of a configuration have passed now.

    Raises:
        StorageError: it cannot be kept.
    """
    _write({"actuators": _actuators(configuration), "boot": _boot(), "at": _running()})


def forget_passed() -> None:
    """Forget that any have passed: they are tried again.

    It is written as `keep_passed` does it, so that a folder that cannot be written shows before anything is moved.

    Raises:
        StorageError: nothing can be kept.
    """
    _write({})


def _write(content: dict[str, str | float]) -> None:
    file = _file()
    part = file.with_suffix(f".{os.getpid()}")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        part.write_text(json.dumps(content), "utf-8")
        os.replace(part, file)
    except OSError as error:
        raise StorageError(
            f"{file}: a passed wiggle test cannot be kept there ({error.strerror}); set STATE_DIRECTORY to a folder "
            "that `drawbar check` may write and `drawbar drive` reads (docs/service.md)"
        ) from error


def has_passed(configuration: Configuration) -> bool:
    """Return whether the actuators of a configuration have passed, and that still holds."""
    try:
        kept = json.loads(_file().read_text("utf-8"))
        age = _running() - float(kept["at"])
    except (OSError, ValueError, KeyError, TypeError):
        return False
    known = kept.get("actuators") == _actuators(configuration) and kept.get("boot") == _boot() != ""
    return known and 0.0 <= age <= LONGEST


def _file() -> Path:
    given = os.environ.get("STATE_DIRECTORY", "").partition(":")[0]  # systemd: several are joined by colons
    return (Path(given) if given else user_state_path("drawbar")) / "wiggled.json"


def _actuators(configuration: Configuration) -> str:
    """Return what identifies the actuators of a configuration."""
    devices, vehicle = configuration.devices, configuration.vehicle
    if devices is None:
        return ""
    parts = [each.model_dump_json() if each else "" for each in (devices.tractor_board, devices.trailer_board)]
    parts.append(devices.isobus.model_dump_json() if devices.isobus else "")
    limits = (vehicle.tractor_steering_limit, vehicle.trailer_steering_limit)
    return hashlib.sha256(repr((parts, limits)).encode()).hexdigest()


def _boot() -> str:
    """Return what identifies this boot of the computer; empty: it is not known."""
    try:
        return _BOOT.read_text("ascii").strip()
    except OSError:
        return ""


def _running() -> float:
    """Return the time since the computer was started, sleep included, s."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)
