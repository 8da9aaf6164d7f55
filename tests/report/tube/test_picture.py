"""The picture shows the sets it was given."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from drawbar.config import load_configuration
from drawbar.control.tube.tube import SubsystemTube, Tubes, tubes_of
from drawbar.report.tube.picture import outline, render_tube

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def tubes() -> Tubes:
    config = load_configuration("articulated")
    return tubes_of(config.vehicle, config.controller, config.tube, speed=config.speed, sample_time=config.sample_time)


@pytest.fixture(scope="module")
def tube(tubes: Tubes) -> SubsystemTube:
    return tubes.tractor


def test_an_outline_has_the_sets_support_in_every_direction(tube):
    corners = outline(tube.support, np.array([1.0, 0.0, 0.0]), np.array([0.0, 2.0, 0.0]))
    for angle in np.linspace(0.0, 2.0 * np.pi, 37):
        across, up = np.cos(angle), np.sin(angle)
        exact = tube.support(np.array([[across, 2.0 * up, 0.0]]))[0]
        assert exact <= (corners @ (across, up)).max() <= 1.001 * exact + 1e-9


def test_the_picture_holds_a_panel_for_each_pair_and_a_bar_for_each_bound(tube):
    picture = ElementTree.fromstring(render_tube(tube, np.zeros((0, 3))))
    assert len(picture.findall(f"{SVG}polygon")) == 2 * 3
    words = " ".join(text.text for text in picture.iter(f"{SVG}text"))
    for name in (*tube.bounds, *tube.model.states):
        assert name.replace("_", " ") in words
    for source in tube.invariant_set.sources:
        assert source.name.replace("_", " ") in words


def key_of(picture: str) -> dict[str, str]:
    """Return the colour of every entry below the bars, by its name."""
    pairs = re.findall(r'width="10" height="10" fill="(#\w+)"/>\n<text[^>]*>([^<]*)</text>', picture)
    return {name: colour for colour, name in pairs}


def test_a_source_has_one_colour_in_both_bodies_and_no_other_has_it(tubes):
    tractor, trailer = (
        key_of(render_tube(tube, np.zeros((0, n)))) for tube, n in ((tubes.tractor, 3), (tubes.trailer, 2))
    )
    shared = tractor.keys() & trailer.keys()
    assert {"steering rate", "estimate of steering", "operating point", "estimate now"} <= shared
    assert {name: tractor[name] for name in shared} == {name: trailer[name] for name in shared}
    for key in (tractor, trailer):
        assert len(set(key.values())) == len(key)


def test_recorded_deviations_lie_where_the_axes_say(tube):
    # one on the centre lies in the middle, one with the half-widths of the larger set in its corner
    widths = tube.support(np.eye(3))
    picture = render_tube(tube, np.array([np.zeros(3), widths]))
    dots = [tuple(map(float, pair)) for pair in re.findall(r'circle cx="([\d.]+)" cy="([\d.]+)"', picture)]
    assert len(dots) == 2 * 3
    for (x0, y0), (x1, y1) in zip(dots[::2], dots[1::2], strict=True):
        assert x1 - x0 == pytest.approx(y0 - y1)
        assert x1 - x0 > 0.0
