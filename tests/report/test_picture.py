import re
import xml.etree.ElementTree as ElementTree

import numpy as np

from drawbar.report.path_errors import true_path_errors
from drawbar.report.picture import render_picture


def coordinates(svg):
    root = ElementTree.fromstring(svg)
    drawn = [path.get("d") for path in root.iter("{http://www.w3.org/2000/svg}path")]
    return [np.array(re.findall(r"[ML](\S+?) ([-\d.]+)", d), dtype=float) for d in drawn]


def test_everything_is_inside_the_picture(run):
    for points in coordinates(render_picture(run, true_path_errors(run))):
        assert points.min() >= 0.0
        assert points[:, 0].max() <= 880.0
        assert points[:, 1].max() <= 800.0


def test_the_map_has_equal_scales_and_north_up(run):
    drawn, path = coordinates(render_picture(run, true_path_errors(run)))[0], run.header.path
    scale_x, scale_y = np.ptp(drawn, axis=0) / (np.ptp(path.x), np.ptp(path.y))
    np.testing.assert_allclose(scale_x, scale_y, rtol=1e-3)
    assert drawn[path.y.argmax(), 1] == drawn[:, 1].min()
    assert drawn[path.x.argmax(), 0] == drawn[:, 0].max()


def test_runs_without_truth_or_steps_have_a_picture(make_run):
    for log in (make_run(steps=0), make_run(truth=False, steps=20)):
        assert "nan" not in render_picture(log, true_path_errors(log))


def test_the_map_has_a_bar_of_so_many_metres(run):
    svg = render_picture(run, true_path_errors(run))
    line, path = coordinates(svg)[0], run.header.path
    root = ElementTree.fromstring(svg)
    texts = [each.text for each in root.iter("{http://www.w3.org/2000/svg}text")]
    metres = float(next(text for text in texts if text.endswith(" m") and text != "0 m").removesuffix(" m"))
    lengths = [np.ptp(points[:, 0]) for points in coordinates(svg) if len(points) == 2 and not np.ptp(points[:, 1])]
    np.testing.assert_allclose(lengths[0], metres * np.ptp(line[:, 0]) / np.ptp(path.x), atol=0.2)
