"""Scene of a drive's log: what is drawn of the vehicle."""

import math
import re

import numpy as np

from drawbar.config import load_configuration
from drawbar.recording.scene import Scene, tube_reach
from drawbar.simulation import build_path, simulate
from drawbar.step.build import build_tubes


def bodies(*changes: str) -> str:
    """Return what the scene's message says of the bodies."""
    configuration = load_configuration("articulated", list(changes))
    scene = Scene(path=build_path(configuration)[0], vehicle=configuration.vehicle)
    return str(dict(scene.standing(0))["/bodies"])


def test_a_tracked_point_is_drawn_where_it_is_on_its_body() -> None:
    assert "LinePrimitive" not in bodies()
    drawn = bodies("vehicle.tracked.trailer={ forward = -0.625, left = 0.0625 }")
    tractor, trailer = drawn.split(', id: "trailer"')
    assert "LinePrimitive" not in tractor
    assert "points: [Point3 { x: 0.0, y: 0.0, z: 0.05 }, Point3 { x: -0.625, y: 0.0625, z: 0.05 }]" in trailer


def test_a_plan_is_drawn_in_the_middle_of_its_tube() -> None:
    configuration = load_configuration("articulated")
    tubes = build_tubes(configuration)
    assert tubes is not None
    reach = tube_reach(tubes, configuration.vehicle)
    assert reach["tractor"] == tubes.tractor.support(np.eye(3))[0]
    assert reach["trailer"] == math.sin(tubes.trailer.support(np.eye(2))[0]) * configuration.vehicle.trailer_length
    record = simulate(configuration).records[10]
    scene = Scene(path=build_path(configuration)[0], vehicle=configuration.vehicle, reach=reach)
    tractor, trailer = str(dict(scene.moving(0, record))["/plan"]).split(', id: "trailer"')
    for body, drawn in (("tractor", tractor), ("trailer", trailer)):
        assert [float(each) for each in re.findall(r"thickness: ([\d.]+)", drawn)] == [0.06, 2.0 * reach[body]]


def test_a_body_without_a_set_has_no_tube() -> None:
    configuration = load_configuration("paper")
    assert tube_reach(build_tubes(configuration), configuration.vehicle) == {}
    assert tube_reach(None, configuration.vehicle) == {}
