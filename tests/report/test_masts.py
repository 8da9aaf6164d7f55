"""What the report says of masts whose lean nobody measures."""

import math

import pytest

from drawbar.config import load_configuration
from drawbar.report.masts import doubt_text, mast_doubt
from drawbar.simulation import Simulation

MASTS = "vehicle.masts={tractor={up=2.5}, trailer={up=2.0}}"
FIELD = "machine.terrain={slope=0.0873, creep=0.36}"


def doubts(*changes: str) -> tuple[float, float]:
    with Simulation(load_configuration("articulated", ["path.radii=[8.0]", *changes])) as simulation:
        log = simulation.log()
    return mast_doubt(log, "tractor"), mast_doubt(log, "trailer")


def test_on_a_soft_slope_the_doubt_is_what_the_masts_lean() -> None:
    tractor, trailer = doubts(MASTS, FIELD)
    lean = math.sin(0.0873) / math.sqrt(2.0)  # in all headings
    assert tractor == pytest.approx(2.5 * lean, rel=0.35)
    assert trailer == pytest.approx(0.8 * tractor)


@pytest.mark.parametrize(
    ("changes", "known"),
    [
        ((), (True, True)),
        ((MASTS, "machine.attitude.tractor.present=true"), (True, True)),
        ((MASTS, "machine.attitude.trailer.present=true"), (False, True)),
    ],
)
def test_without_masts_or_with_a_sensor_there_is_no_doubt(changes: tuple[str, ...], known: tuple[bool, bool]) -> None:
    assert tuple(each == 0.0 for each in doubts(FIELD, *changes)) == known


def test_the_doubt_in_words() -> None:
    assert doubt_text(0.0, math.nan) == ""
    assert doubt_text(0.146, 0.117).endswith("may mislead: tractor 15 cm, trailer 12 cm")
    assert doubt_text(0.146, 0.0).endswith("may mislead: tractor 15 cm")
