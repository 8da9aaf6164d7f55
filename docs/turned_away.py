"""Print for how many poses that face away from the path there is no way onto it: python docs/turned_away.py.

The poses are random (seed 1): up to 3 m beside the paper's figure-eights, turned by 60 to 180 degrees, joints straight.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drawbar.config import Configuration, load_configuration
from drawbar.errors import PathError
from drawbar.guidance.path import Path
from drawbar.guidance.preview import Preview
from drawbar.signals import Estimate, Pose, SolverStatus
from drawbar.step.build import build_path

POSES, SEED = 2000, 1
CLASSES = {"straight": ("straight",), "curve": ("0.1", "0.125", "0.15")}
"""of the path, beside which a vehicle faces away"""


def row(kind: str, classes: Sequence[str]) -> str:
    """Return the row of one part of the paper's eights: of how many random poses that face away there is no way."""
    configuration = load_configuration("articulated", ())
    path, _ = build_path(configuration)
    rng, lost = np.random.default_rng(SEED), 0
    begins = [k for k, label in enumerate(path.labels(path.nodes[:-1, 0])) if label in classes]
    for k in rng.choice(begins, POSES):
        rest = path.nodes[k:] - [path.nodes[k, 0], 0.0, 0.0, 0.0]
        ahead = replace(path, nodes=np.ascontiguousarray(rest), label_of_piece=path.label_of_piece[k:])
        pose = (rng.uniform(-3.0, 3.0), rng.choice((-1.0, 1.0)) * rng.uniform(np.pi / 3, np.pi))
        lost += not _finds_a_way(configuration, ahead, *pose)
    return f"| {kind} | {100.0 * lost / POSES:.1f} |"


def _finds_a_way(configuration: Configuration, path: Path, left: float, turned: float) -> bool:
    """Tell whether a tractor so far left of the path's start (m), and so turned from it (rad), is led onto it."""
    _, x, y, along = path.nodes[0]
    yaw = along + turned
    tractor = (x - left * np.sin(along), y + left * np.cos(along))
    vehicle = configuration.vehicle
    behind = vehicle.free_joint_offset + vehicle.drawbar_length + vehicle.trailer_length - vehicle.trailer_antenna
    trailer = (tractor[0] - behind * np.cos(yaw), tractor[1] - behind * np.sin(yaw))
    start = Estimate(
        time=0.0,
        tractor=Pose(x=tractor[0], y=tractor[1], yaw=yaw),
        trailer=Pose(x=trailer[0], y=trailer[1], yaw=yaw),
        hitch_angle=0.0,
        speed=configuration.speed,
        tractor_steering=0.0,
        trailer_steering=0.0,
        longitudinal_slip=1.0,
        tractor_slip=1.0,
        trailer_slip=1.0,
        steering_offset=0.0,
        tractor_crab=0.0,
        trailer_crab=0.0,
        status=SolverStatus.SOLVED,
    )
    guidance = Preview(
        path,
        configuration.guidance,
        vehicle=vehicle,
        stages=configuration.controller.horizon,
        interval=configuration.sample_time,
        tractor=tractor,
        trailer=trailer,
    )
    try:
        guidance.reference(start)
    except PathError:
        return False
    return True


if __name__ == "__main__":
    print("| random poses turned away beside a | without a way, % |\n|---|---|")
    for name, labels in CLASSES.items():
        print(row(name, labels), flush=True)
