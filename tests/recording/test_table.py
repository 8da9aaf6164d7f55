"""A log's numbers as a CSV file."""

import csv
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from drawbar.recording.log import read_log
from drawbar.recording.recorder import Recorder
from drawbar.recording.table import write_csv


@pytest.mark.parametrize("without", [0, 2], ids=["first", "last"])
def test_a_step_without_plans_has_empty_cells_for_their_deviations(tmp_path, build, without):
    simulation = build("articulated")
    records = list(islice(simulation.steps(), 3))
    plan, nothing = records[without].plan, np.zeros(0)
    of_bodies = {body: replace(getattr(plan, body), deviation=nothing) for body in ("tractor", "trailer")}
    records[without] = replace(records[without], plan=replace(plan, **of_bodies))
    with Recorder(tmp_path / "log.mcap", simulation.header()) as recorder:
        for record in records:
            recorder.write(record)
    write_csv(read_log(tmp_path / "log.mcap"), tmp_path / "log.csv")
    with (tmp_path / "log.csv").open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    names = [f"plan.{body}.deviation.{i}" for body in of_bodies for i in range(getattr(plan, body).deviation.size)]
    assert len(names) == 5
    for step, row in enumerate(rows):
        assert {row[name] == "" for name in names} == {step == without}
