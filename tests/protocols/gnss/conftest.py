"""The golden files of receivers, and shorthands for one epoch through the whole way."""

import datetime
import math
from collections.abc import Callable
from typing import Any

import pytest
from golden import load

from drawbar.machine.stand_in.receiver import Report
from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.settings import EpochSettings
from drawbar.protocols.gnss.stream import EpochStream

NOON = datetime.datetime(2026, 11, 22, 12, 0, 0, tzinfo=datetime.UTC)


@pytest.fixture(scope="session")
def golden() -> Callable[[str], Any]:
    """Return a function that reads a golden file, which only some machines have beside the repository."""
    return load


@pytest.fixture(scope="session")
def report() -> Callable[..., Report]:
    """Return a function that makes a report some seconds after noon."""

    def report(seconds: float = 0.0, **changes: Any) -> Report:
        usual: dict[str, Any] = {"latitude": 50.8768724267, "longitude": 4.7020576117, "height": 88.018}
        time = changes.pop("begin", NOON) + datetime.timedelta(seconds=seconds)
        return Report(**{"time": time, "speed": 1.0, "course": 0.3} | usual | changes)

    return report


@pytest.fixture(scope="session")
def once() -> Callable[..., Epoch]:
    """Return a function that takes one epoch's bytes to the epoch."""

    def once(data: bytes, **settings: Any) -> Epoch:
        stream = EpochStream(EpochSettings(**settings))
        (epoch,) = stream.push(data, 100.0) + stream.poll(100.02)
        assert stream.due == math.inf
        return epoch

    return once
