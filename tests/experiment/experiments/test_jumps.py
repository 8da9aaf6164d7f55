"""Jumps to eight sides, and the worst of them by size."""

import dataclasses
import math
import tomllib

import numpy as np
import pytest

from drawbar.report.path_errors import Bodies

NAME = "jumps"
SIZES = (0.05, 0.1, 0.12, 0.15, 0.2, 0.25, 0.3, 1.0, 5.0)


def test_every_antenna_jumps_by_every_size_to_eight_sides(experiment) -> None:
    expected = {
        f"articulated: {antenna} {size:g} m, {turn}°": (antenna, size, turn)
        for antenna in ("tractor", "trailer")
        for size in SIZES
        for turn in range(0, 360, 45)
    }
    assert set(experiment.configurations) == {*expected, "articulated: no jump"}
    for case, (antenna, size, turn) in expected.items():
        (event,) = tomllib.loads(experiment.configurations[case])["machine"]["events"]
        assert (event["kind"], event["antenna"], event["start"], event["duration"]) == ("gps_jump", antenna, 25.0, 20.0)
        angle = math.radians(turn)
        jump = size * np.array([math.cos(angle), math.sin(angle)])
        assert (event["east"], event["north"]) == pytest.approx(jump, abs=1e-6)


def test_the_worst_direction_and_seed_counts(experiment, short_result, assemble, write_parts) -> None:
    def result(largest: float):
        errors = short_result.metrics.error_m
        worst = {name: dataclasses.replace(each, max=largest) for name, each in errors.tractor.items()}
        metrics = dataclasses.replace(short_result.metrics, error_m=Bodies(tractor=worst, trailer=worst))
        return dataclasses.replace(short_result, metrics=metrics)

    results = {case: [result(0.06)] * 2 for case in experiment.configurations}
    results["articulated: trailer 0.15 m, 225°"] = [result(0.10), result(0.17)]
    _, tables = write_parts(assemble(results))
    table = tables["jumps"]
    assert list(table.header[1:]) == ["0 m", *(f"{size:g} m" for size in SIZES)]
    assert table.rows[0] == ["tractor's antenna", *["6 / 6"] * 10]
    assert table.rows[1] == ["trailer's antenna", *["6 / 6"] * 4, "17 / 17", *["6 / 6"] * 5]
