"""Scene: the run in space. The ground, the tracks of both bodies and antennas, and both bodies at a few moments."""

import math
from dataclasses import fields
from typing import Any

import numpy as np

from drawbar.config import Configuration, recorded_configuration
from drawbar.errors import ConfigurationError
from drawbar.geometry import Floats
from drawbar.machine.physics.settings import PhysicsMachineSettings
from drawbar.machine.terrain import Terrain
from drawbar.recording.log import Columns
from drawbar.report import style
from drawbar.report.decimation import thinned
from drawbar.report.map import outlined_steps, polyline
from drawbar.report.solids import Solid, joined, mast_solid, rotation, tool_solid, tractor_solid, trailer_solid
from drawbar.report.style import Figure
from drawbar.signals import Pose, Truth
from drawbar.vehicle.parameters import VehicleParameters

_MARGIN = 4.0
"""of ground around the tracks, m"""
_CELLS = 90
"""of the ground along its longer side: a page must stay light"""
_LIGHT = {"x": -20000.0, "y": -40000.0, "z": 80000.0}
"""where the light comes from: from behind whoever looks, high up, m"""
_LIFTED = 0.03
"""lines are drawn this far above the ground, m"""


def scene_figure(log: Columns) -> Figure:
    """Draw the scene; it is empty where the ground is not known, as on a real machine, and for a chain on the flat."""
    configuration = _configuration(log) if log.has_truth else None
    if configuration is None or not _has_height(configuration):
        return {"data": [], "layout": {}}
    terrain, vehicle = Terrain.of_seed(configuration.machine.terrain, log.header.seed), configuration.vehicle
    truths, moments = _truths(log, thinned(log.steps).tolist()), _truths(log, outlined_steps(log))
    traces = [_ground(terrain, np.array([(truth.tractor.x, truth.tractor.y) for truth in truths]))]
    path = polyline(log.header.path)
    traces.append(_line(_on(terrain, path), "Path", style.REFERENCE, width=6))
    for body, colour in style.BODY_COLOURS.items():
        feet = np.array([(pose.x, pose.y) for pose in (getattr(truth, body) for truth in truths)])
        traces.append(_line(_on(terrain, feet), body.capitalize(), colour, width=5))
        traces.append(_line(_antennas(terrain, vehicle, truths, body), f"Antenna of the {body}", colour, width=1.5))
        traces.append(_bodies(terrain, vehicle, moments, body, colour))
    return {"data": traces, "layout": _layout()}


def _truths(log: Columns, steps: list[int]) -> list[Truth]:
    """Return the true places of both bodies at some steps; all else is not asked for, and NaN."""
    angles = [f"{body}_{angle}" for body in style.BODY_COLOURS for angle in ("roll", "pitch")]
    poses = {
        body: [log.column(f"truth.{body}.{name}").tolist() for name in ("x", "y", "yaw")] for body in style.BODY_COLOURS
    }
    known = {name: log.column(f"truth.{name}").tolist() for name in (*angles, "tractor_steering", "trailer_steering")}
    values: dict[str, Any] = {field.name: math.nan for field in fields(Truth)}
    return [Truth(**values | _of_step(poses, known, step)) for step in steps]


def _of_step(poses: dict[str, list[list[float]]], known: dict[str, list[float]], step: int) -> dict[str, Any]:
    """Return the poses and the numbers of one step."""
    places = {body: Pose(x=x[step], y=y[step], yaw=yaw[step]) for body, (x, y, yaw) in poses.items()}
    return places | {name: column[step] for name, column in known.items()}


def _configuration(log: Columns) -> Configuration | None:
    """Return the run's configuration; None where this version of drawbar does not read it any more."""
    try:
        return recorded_configuration(log.header.configuration, [], "the log")
    except ConfigurationError:
        return None


def _has_height(configuration: Configuration) -> bool:
    """Return whether the run shows anything in space that the map does not."""
    machine = configuration.machine
    return isinstance(machine, PhysicsMachineSettings) or not machine.terrain.is_flat


def _ground(terrain: Terrain, track: Floats) -> dict[str, Any]:
    """Return the ground around a track (n, 2)."""
    low, high = track.min(axis=0) - _MARGIN, track.max(axis=0) + _MARGIN
    cell = float((high - low).max()) / _CELLS
    x, y = (np.arange(start, end + cell, cell) for start, end in zip(low, high, strict=True))
    east, north = (each.ravel() for each in np.meshgrid(x, y))
    shape = (len(y), len(x))
    bumps = 100.0 * terrain.unevenness(east, north)
    reach = max(float(np.abs(bumps).max()), 1.0)
    return {
        "type": "surface",
        "name": "Ground",
        "x": x.round(2),
        "y": y.round(2),
        "z": terrain.height(east, north).round(3).reshape(shape),
        "surfacecolor": bumps.round(1).reshape(shape),
        "cmin": -reach,
        "cmax": reach,
        "colorscale": [[0.0, "#6F6250"], [0.5, "#B9B08F"], [1.0, "#E4E2C8"]],
        "showscale": bool(bumps.any()),
        "colorbar": {
            "title": {"text": "Ground above the slope, cm", "side": "top", "font": {"size": 12}},
            "orientation": "h",
            "thickness": 10,
            "len": 0.6,
            "y": 0.0,
            "yanchor": "bottom",
        },
        "lighting": {"ambient": 0.75, "diffuse": 0.5, "specular": 0.05, "roughness": 0.9},
        "lightposition": _LIGHT,
        "hovertemplate": "%{x:.1f} m east, %{y:.1f} m north, %{z:.2f} m high<extra></extra>",
    }


def _on(terrain: Terrain, places: Floats) -> Floats:
    """Return places (n, 2) a little above the ground, (n, 3) m."""
    return np.column_stack((places, terrain.height(places[:, 0], places[:, 1]) + _LIFTED))


def _antennas(terrain: Terrain, vehicle: VehicleParameters, truths: list[Truth], body: str) -> Floats:
    arm = np.array(getattr(vehicle.masts, body).arm)
    return np.array([place + axes @ arm for place, axes in (_stance(terrain, truth, body) for truth in truths)])


def _stance(terrain: Terrain, truth: Truth, body: str) -> tuple[Floats, Floats]:
    """Return where a body's point is on the ground, (3,) m, and the body's axes (3, 3)."""
    pose: Pose = getattr(truth, body)
    place = np.array([pose.x, pose.y, terrain.height(np.array([pose.x]), np.array([pose.y]))[0]])
    return place, rotation(pose.yaw, getattr(truth, f"{body}_roll"), getattr(truth, f"{body}_pitch"))


def _bodies(
    terrain: Terrain, vehicle: VehicleParameters, moments: list[Truth], body: str, colour: str
) -> dict[str, Any]:
    """Return a body, with its mast, as it stood at some moments."""
    placed = []
    for truth in moments:
        place, axes = _stance(terrain, truth, body)
        own = tractor_solid(vehicle, truth.tractor_steering) if body == "tractor" else trailer_solid(vehicle)
        tracked = getattr(vehicle.tracked, body).arm
        tool = [tool_solid(tracked)] if any(tracked) else []
        own = joined([own, mast_solid(getattr(vehicle.masts, body).arm), *tool])
        placed.append(Solid(place + own.corners @ axes.T, own.triangles))
    corners, triangles = joined(placed)
    x, y, z = corners.round(3).T
    i, j, k = triangles.T
    light = {"ambient": 0.9, "diffuse": 0.7, "specular": 0.1}
    look = {"type": "mesh3d", "color": colour, "flatshading": True, "lighting": light, "lightposition": _LIGHT}
    look["hoverinfo"] = "skip"
    return look | {"name": body.capitalize(), "x": x, "y": y, "z": z, "i": i, "j": j, "k": k}


def _line(points: Floats, name: str, colour: str, *, width: float) -> dict[str, Any]:
    x, y, z = points.round(3).T
    look = {"type": "scatter3d", "mode": "lines", "line": {"color": colour, "width": width}, "hoverinfo": "skip"}
    return look | {"name": name, "x": x, "y": y, "z": z, "showlegend": True}


def _layout() -> dict[str, Any]:
    sides = {"backgroundcolor": "#FFFFFF", "gridcolor": style.GRID, "showspikes": False}
    return {
        "font": {"family": style.FONT, "size": 13, "color": style.INK},
        "paper_bgcolor": "#FFFFFF",
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0},
        "legend": {"orientation": "h", "x": 0.0, "y": 1.0, "yanchor": "top", "bgcolor": "rgba(255,255,255,0.85)"},
        "scene": {
            "aspectmode": "data",
            "xaxis": sides | {"title": {"text": "East, m"}},
            "yaxis": sides | {"title": {"text": "North, m"}},
            "zaxis": sides | {"title": {"text": "Height, m"}},
            "domain": {"x": [0.0, 1.0], "y": [0.1, 1.0]},
            "camera": {"eye": {"x": 0.8, "y": -1.6, "z": 0.95}, "center": {"x": 0.0, "y": 0.0, "z": -0.15}},
        },
    }
