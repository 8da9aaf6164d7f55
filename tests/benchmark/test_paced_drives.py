"""Drives in processes, faster than real time, keep to the line as the same drive in one process does."""

import sys
from pathlib import Path

import pytest
from patience import PATIENT

from drawbar.benchmark.paced_drives import EXACT, differences, drive, rehearse
from drawbar.config import load_configuration
from drawbar.driving.stand_in.demonstration import with_isobus, with_one_receiver, with_stand_ins

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="real machines are driven by Linux only")
FIELD = Path(__file__).parents[2] / "examples" / "field"
RECORDED = [f"path.file={FIELD}", "path.track=Cu 14.1°"]
DRIVES = {
    "figure-eight, boards": (["path.radii=[8.0]"], with_stand_ins),
    "recorded line, boards": (RECORDED, with_stand_ins),
    "figure-eight, ISOBUS": (["path.radii=[8.0]"], with_isobus),
    "figure-eight, one receiver": (["path.radii=[8.0]"], lambda plain: with_one_receiver(with_stand_ins(plain))),
    "recorded line, ISOBUS, one receiver": (RECORDED, lambda plain: with_one_receiver(with_isobus(plain))),
}
PACES = (10, 5, 3, 2, 1)
"""tried one after the other, until this computer, which has other tests to run, is fast enough: processes that it lets
wait anywhere else than between an epoch and its command only move the drives apart"""
SECONDS = 75.0
"""of the drive, which is engaged after 35"""


@pytest.mark.parametrize("name", DRIVES)
def test_errors_are_those_of_one_process(name, tmp_path):
    line, with_devices = DRIVES[name]
    configuration = with_devices(load_configuration("articulated", [*line, *EXACT, *PATIENT]))
    within = False
    for pace in PACES:
        (tmp_path / str(pace)).mkdir()
        driven = drive(configuration, tmp_path / str(pace), pace, SECONDS)
        print(f"pace {pace}: {driven.delay:.3f} s, {driven.late} late, {[each.name for each in driven.states]}")
        if not driven.held:
            continue
        alone = rehearse(configuration, SECONDS, driven.delays)
        assert min(len(driven.errors), len(alone.errors)) > 50
        mean, largest, _ = differences(driven, alone)
        print(f"differs by {mean} m, {largest} m")
        if within := mean < 0.001 and largest < 0.003:
            break
    assert within, "not even in real time"
