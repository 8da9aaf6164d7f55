"""One long straight in place of the figure-eights: it has no file, since a recorded line has an accuracy."""

import numpy as np

from drawbar.guidance.path import Path
from drawbar.simulation import Simulation

LENGTH, PIECES = 300.0, 1200
"""m"""


def on_a_straight(simulation: Simulation) -> None:
    """Drive to the east from where the figure-eights begin."""
    along, beside = np.linspace(0.0, LENGTH, PIECES + 1), np.zeros(PIECES + 1)
    labels = np.zeros(PIECES, dtype=np.int8)
    path = Path.through(
        arc_length=along, x=along, y=beside, yaw=beside, label_of_piece=labels, label_names=("straight",)
    )
    simulation.path = path
    simulation.autopilot.begin(path)
