import numpy as np
import pytest
from alone import Alone

from drawbar.codegen import Unit

UNIT = """
#include "noise_level.h"
struct component { struct noise_level noise; double disagreement[2], limit, deviation; int32_t memory; };
#define COMPONENT_FIELDS FIELD(component, disagreement, 0, 2, 0, 0) FIELD(component, limit, 0, 1, 0, 0) \\
    FIELD(component, deviation, 0, 1, 0, 0) FIELD(component, memory, 1, 1, 0, 0)
int UNIT(update)(struct component *component)
{
    noise_update(&component->noise, component->disagreement, component->limit, component->memory);
    component->deviation = noise_deviation(&component->noise);
    return 0;
}
int UNIT(interrupt)(struct component *component) { noise_interrupt(&component->noise); return 0; }
"""


class NoiseLevel(Alone):
    def __init__(self, memory):
        super().__init__(
            Unit(name="noise", source=UNIT, configure=lambda workspace: workspace.write({"memory": memory}))
        )

    def update(self, disagreement, limit):
        self.live.write({"disagreement": disagreement, "limit": limit})
        self.call("update")

    def interrupt(self):
        self.call("interrupt")

    @property
    def deviation(self):
        return float(self.live.array("deviation")[0])


def level(series, limit=10.0):
    noise = NoiseLevel(memory=10_000)
    for disagreement in series:
        noise.update(disagreement, limit)
    return noise.deviation


def test_the_deviation_is_that_of_one_coordinate_of_one_antenna():
    tractor, trailer = np.random.default_rng(1).normal(scale=0.03, size=(2, 10_000, 2))
    assert level(tractor - trailer) == pytest.approx(0.03, rel=0.03)


def test_it_does_not_see_what_lasts_or_grows_slowly():
    tractor, trailer = np.random.default_rng(2).normal(scale=0.03, size=(2, 10_000, 2))
    honest = level(tractor - trailer)
    drifting = tractor - trailer + np.linspace(0.0, 50.0, 10_000)[:, None]
    drifting[5000:] += 3.0
    assert level(drifting, limit=0.3) == pytest.approx(honest, rel=0.03)


def test_nothing_is_known_at_first_and_across_an_interruption():
    noise = NoiseLevel(memory=10)
    noise.update((1.0, 0.0), 10.0)
    noise.interrupt()
    noise.update((5.0, 0.0), 10.0)
    assert noise.deviation == 0.0
