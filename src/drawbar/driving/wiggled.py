"""Wiggled: that the actuators have passed their wiggle test, kept from `drawbar check --wiggle` until `drawbar drive`.

It holds for the very same actuators, until the computer restarts, and for LONGEST at most.
"""

import hashlib
import json
import os
import time
from pathlib import Path

from platformdirs import user_state_path

from drawbar.config import Configuration

LONGEST = 12.0 * 3600.0
"""s; a working day"""
_BOOT = Path("/proc/sys/kernel/random/boot_id")


def keep_passed(configuration: Configuration) -> None:
    """Keep that the actuators of a configuration have passed now."""
    file = _file()
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_suffix(f".{os.getpid()}")
    part.write_text(json.dumps({"actuators": _actuators(configuration), "boot": _boot(), "at": _running()}), "utf-8")
    os.replace(part, file)


def forget_passed() -> None:
    """Forget that any have passed: they are tried again."""
    _file().unlink(missing_ok=True)


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
    return user_state_path("drawbar") / "wiggled.json"


def _actuators(configuration: Configuration) -> str:
    """Return what tells the actuators of a configuration from others."""
    devices, vehicle = configuration.devices, configuration.vehicle
    if devices is None:
        return ""
    parts = [each.model_dump_json() if each else "" for each in (devices.tractor_board, devices.trailer_board)]
    parts.append(devices.isobus.model_dump_json() if devices.isobus else "")
    limits = (vehicle.tractor_steering_limit, vehicle.trailer_steering_limit)
    return hashlib.sha256(repr((parts, limits)).encode()).hexdigest()


def _boot() -> str:
    """Return what tells this run of the computer from all others; empty: it does not say."""
    try:
        return _BOOT.read_text("ascii").strip()
    except OSError:
        return ""


def _running() -> float:
    """Return the time since the computer was started, sleep included, s."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)
