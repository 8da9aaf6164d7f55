"""The parsers' fuzzers for a moment each; DRAWBAR_FUZZ_LINES=1000 takes so many thousand inputs of each."""

import importlib.util
import os
from pathlib import Path
from types import ModuleType

import pytest

THOUSANDS = int(os.environ.get("DRAWBAR_FUZZ_LINES", "1"))


def program(place: str) -> ModuleType:
    """Return a program beside this file, which is none of the tests, as a module."""
    specification = importlib.util.spec_from_file_location("fuzz", Path(__file__).parent / place)
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", ["Rtcm", "caster", "Boards", "Nmea2000", "Isobus", "Sentences", "records"])
def test_nothing_that_comes_raises(name: str) -> None:
    fuzzers = program("fuzz.py")
    target = getattr(fuzzers, name)
    fuzzers.fuzz(target() if isinstance(target, type) else target, 1000 * THOUSANDS, 1)


def test_nothing_that_receivers_send_raises_and_no_intact_frame_is_lost() -> None:
    program("gnss/fuzz.py").fuzz(2000 * THOUSANDS, 1)
