"""Attitude of both bodies: roll and pitch from the ground's heights below their wheels, behind by the suspension."""

import math

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.random_processes import first_order
from drawbar.machine.settings import BodySettings
from drawbar.machine.terrain import Terrain
from drawbar.vehicle.parameters import VehicleParameters

ANGLES = 4
"""roll and pitch of the tractor, roll and pitch of the trailer, rad"""


class Attitude:
    """Roll and pitch of tractor and trailer over time.

    The tractor rolls with the wheels of its rear axle, its front axle swings; it pitches with the heights of both
    axles. The trailer rolls with its own wheels and pitches with the tractor's hitch. Each angle follows the ground
    through a first-order lag.
    """

    def __init__(
        self, vehicle: VehicleParameters, settings: BodySettings, terrain: Terrain, step: float, start: Floats
    ) -> None:
        """Begin as the ground below the first state (11,) has it."""
        self._vehicle, self._settings, self._terrain = vehicle, settings, terrain
        lags = np.repeat((settings.tractor_suspension, settings.trailer_suspension), 2)
        self._decays = np.exp(-step / lags)
        self.angles: Floats = self._on_ground(start[None])[0]
        """(4,) as they are now"""

    def advance(self, states: Floats) -> Floats:
        """Return the angles (n, 4) after each of the states (n, 11) of the next integration steps."""
        ground = self._on_ground(states)
        angles = np.empty_like(ground)
        for column, decay in enumerate(self._decays):
            towards = (1.0 - decay) * ground[:, column]
            angles[:, column] = first_order(towards, decay=decay, last=self.angles[column])
        self.angles = angles[-1].copy()
        return angles

    def _on_ground(self, states: Floats) -> Floats:
        """Return the angles (n, 4) at which stiff bodies would stand."""
        vehicle, settings = self._vehicle, self._settings
        rear, (yaw, trailer_yaw, joint) = states[:, :2], states[:, 2:5].T
        behind = vehicle.free_joint_offset * _along(yaw) + vehicle.drawbar_length * _along(trailer_yaw + joint)
        axle = rear - behind - vehicle.trailer_length * _along(trailer_yaw)
        height = self._height(rear)
        pitch = np.arctan((self._height(rear + vehicle.wheelbase * _along(yaw)) - height) / vehicle.wheelbase)
        hitch = height - vehicle.hitch_length * np.tan(pitch)
        return np.column_stack(
            (
                self._roll(rear, yaw, settings.tractor_track),
                pitch,
                self._roll(axle, trailer_yaw, settings.trailer_track),
                np.arctan((hitch - self._height(axle)) / vehicle.trailer_length),
            )
        )

    def _height(self, places: Floats) -> Floats:
        return self._terrain.height(places[:, 0], places[:, 1])

    def _roll(self, axle: Floats, yaw: Floats, track: float) -> Floats:
        half_track = 0.5 * track * _along(yaw + 0.5 * math.pi)
        rolled: Floats = np.arctan((self._height(axle + half_track) - self._height(axle - half_track)) / track)
        return rolled


def _along(yaw: Floats) -> Floats:
    return np.column_stack((np.cos(yaw), np.sin(yaw)))
