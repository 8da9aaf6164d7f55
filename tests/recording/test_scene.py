"""Scene of a drive's log: what is drawn of the vehicle."""

from drawbar.config import load_configuration
from drawbar.recording.scene import Scene
from drawbar.simulation import build_path


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
