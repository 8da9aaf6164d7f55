"""The SIMD sine, cosine, tangent and arctangent against the C library's."""

import numpy as np
import pytest

from drawbar.codegen import Workspace, build
from drawbar.geometry import Floats

COUNT = 100_000
UNIT = f"""
#include "lanes.h"
#include "fields.h"
struct batch {{ double x[{COUNT}], y[{COUNT}], sine[{COUNT}], cosine[{COUNT}], tangent[{COUNT}], angle[{COUNT}]; }};
int64_t drawbar_size = sizeof(struct batch);
const struct drawbar_field drawbar_fields[] = {{
    FIELD(batch, x, 0, {COUNT}, 0, 0) FIELD(batch, y, 0, {COUNT}, 0, 0)
    FIELD(batch, angle, 0, {COUNT}, 0, 0) FIELD(batch, sine, 0, {COUNT}, 0, 0)
    FIELD(batch, cosine, 0, {COUNT}, 0, 0) FIELD(batch, tangent, 0, {COUNT}, 0, 0) END_OF_FIELDS
}};
int run(struct batch *b)
{{
    for (int i = 0; i < {COUNT}; ++i) {{
        b->sine[i] = lane_sin(b->x[i]);
        b->cosine[i] = lane_cos(b->x[i]);
        b->tangent[i] = lane_tan(b->x[i]);
        b->angle[i] = lane_atan2(b->y[i], b->x[i]);
    }}
    return 0;
}}
"""


@pytest.fixture(scope="module")
def batch() -> Workspace:
    return Workspace(build("lanes", UNIT))


def filled(batch: Workspace, x: Floats) -> Floats:
    """Evaluate all three at x (padded with zeros) and return x."""
    batch.array("x")[:] = 0.0
    batch.array("x")[: x.size] = x
    batch.function("run")()
    return batch.array("x")


def hard_arguments() -> dict[str, Floats]:
    rng = np.random.default_rng(0)
    quarters = np.arange(-31830, 31831) * (np.pi / 2)
    tiny = 10.0 ** rng.uniform(-300, 0, COUNT)
    return {
        "one turn": rng.uniform(-4, 4, COUNT),
        "whole range": rng.uniform(-1e5, 1e5, COUNT),
        "quarter turns": quarters,
        "beside quarter turns": np.nextafter(quarters, np.inf),
        "eighth turns": quarters + np.pi / 4,
        "tiny": tiny * rng.choice([-1, 1], COUNT),
        "ends": np.array([-1e5, 1e5, 0.0, -0.0]),
    }


@pytest.mark.parametrize("kind", hard_arguments())
def test_absolute_error(kind: str, batch: Workspace) -> None:
    x = filled(batch, hard_arguments()[kind])
    sine, cosine, tangent = np.sin(x), np.cos(x), np.tan(x)
    assert np.abs(batch.array("sine") - sine).max() <= 3e-16
    assert np.abs(batch.array("cosine") - cosine).max() <= 3e-16
    # d tan = (1 + tan²) dx: near its poles the tangent can only be as good as sine and cosine are
    assert (np.abs(batch.array("tangent") - tangent) / (1 + tangent**2)).max() <= 3e-16


def test_relative_error_of_angles(batch: Workspace) -> None:
    rng = np.random.default_rng(2)
    lengths, angles = 10.0 ** rng.uniform(-100, 100, COUNT), rng.uniform(-np.pi, np.pi, COUNT)
    angles[: COUNT // 2] = 10.0 ** rng.uniform(-50, 0, COUNT // 2) * rng.choice([-1, 1], COUNT // 2)
    batch.array("y")[:] = lengths * np.sin(angles)
    x = filled(batch, lengths * np.cos(angles))
    exact = np.arctan2(batch.array("y"), x)
    assert np.abs(batch.array("angle") / exact - 1).max() <= 5e-16


def test_angles_on_the_axes_and_of_what_is_no_number(batch: Workspace) -> None:
    x, y = np.array([1.0, -1.0, 0.0, 0.0, 0.0, -2.0, 1.0]), np.array([0.0, 0.0, 1.0, -1.0, 0.0, -0.0, -0.0])
    batch.array("y")[: y.size] = y
    filled(batch, x)
    found = batch.array("angle")[: y.size]
    np.testing.assert_array_equal(found, np.arctan2(y, x))
    np.testing.assert_array_equal(np.signbit(found), np.signbit(np.arctan2(y, x)))
    batch.array("y")[:3] = [np.nan, 1.0, np.nan]
    filled(batch, np.array([1.0, np.nan, np.nan]))
    assert np.isnan(batch.array("angle")[:3]).all()


def test_symmetry_is_exact(batch: Workspace) -> None:
    x = np.random.default_rng(1).uniform(-20, 20, COUNT)
    names = ("sine", "cosine", "tangent")
    filled(batch, x)
    there = [batch.array(name).copy() for name in names]
    filled(batch, -x)
    for name, sign, values in zip(names, (-1, 1, -1), there, strict=True):
        np.testing.assert_array_equal(batch.array(name), sign * values)


def test_not_a_number_stays_so(batch: Workspace) -> None:
    bad = np.array([np.nan, np.inf, -np.inf])
    filled(batch, bad)
    for name in ("sine", "cosine", "tangent"):
        assert np.isnan(batch.array(name)[: bad.size]).all()
        assert np.isfinite(batch.array(name)[bad.size :]).all()
