"""The multibody on its ground: MuJoCo moves it, step by step, under the forces of forces.py."""

import math
from types import ModuleType

import numpy as np

from drawbar.errors import ConfigurationError
from drawbar.extras import install_command
from drawbar.geometry import Floats
from drawbar.machine.physics.forces import Forces
from drawbar.machine.physics.model import JOINTS, WHEELS, mjcf
from drawbar.machine.physics.settings import PhysicsMachineSettings
from drawbar.machine.physics.stance import Stance, stance
from drawbar.machine.physics.statics import static_loads
from drawbar.machine.terrain import Terrain
from drawbar.signals import Pose
from drawbar.vehicle.parameters import BODIES, VehicleParameters

_LET_DOWN, _BRAKED = 1.5, 0.7
"""for how long the machine is let down onto its wheels, s, and what is left of all velocities after each step then"""


def engine() -> ModuleType:
    """Return MuJoCo's package. Raises ConfigurationError, with the command that helps, where it is not installed."""
    try:
        import mujoco
    except ImportError as error:
        raise ConfigurationError(
            f'machine.kind = "physics" needs MuJoCo, which cannot be imported here ({error}); '
            f'install it with: {install_command("physics")}; or use machine.kind = "simulated"'
        ) from error
    mujoco.set_mju_user_warning(_unheard)  # Multibody looks at the counts; by itself MuJoCo would write a file
    return mujoco  # type: ignore[no-any-return]


def _unheard(text: str) -> None:
    """Leave a warning alone."""


class Multibody:
    """Tractor, drawbar and trailer on six tyres."""

    def __init__(
        self, vehicle: VehicleParameters, settings: PhysicsMachineSettings, terrain: Terrain, start: Pose
    ) -> None:
        """Put it on the ground, at rest, the trailer straight behind.

        vehicle is as it truly is. Raises ConfigurationError when the machine cannot stand or is none, or MuJoCo is not
        installed.
        """
        if not min(static_loads(vehicle, settings)) > 0.0:
            raise ConfigurationError(
                "the physics machine would tip over: on level ground an axle carries nothing; change "
                "machine.tractor.ahead, machine.trailer.ahead or their masses"
            )
        self._mujoco, self._settings, self._terrain = engine(), settings, terrain
        try:
            self._model = self._mujoco.MjModel.from_xml_string(mjcf(vehicle, settings))
        except ValueError as error:
            raise ConfigurationError(
                f"MuJoCo makes no machine of machine.tractor and machine.trailer ({str(error).splitlines()[0]}); give "
                f"them lengths and masses that bodies can have"
            ) from error
        self._data = data = self._mujoco.MjData(self._model)
        self._warnings = data.warning.number
        self._forces = Forces(vehicle, settings)
        wheels = [self._model.body(name).id for name in WHEELS]
        self._wheels, self._spins = np.array(wheels), np.array([self._model.joint(name).id for name in WHEELS])
        self._rear = [int(self._model.joint(name).dofadr[0]) for name in WHEELS[:2]]
        self._angles = [int(self._model.joint(name).qposadr[0]) for name in JOINTS]
        self._root = data.subtree_com[self._model.body("tractor").id]
        self._bodies = [self._model.body(name).id for name in BODIES]
        self._feet, self._share = _feet(vehicle, settings), 0.5 * settings.tractor.front_track / vehicle.wheelbase
        self._yaws = [start.yaw, start.yaw]
        self._place(start)

    def advance(self, command: Floats) -> None:
        """Move on by one step under a command (3,): angles of front wheels and joint (rad), wheel speed (m/s).

        Raises ConfigurationError when the physics diverges.
        """
        mujoco, model, data, forces = self._mujoco, self._model, self._data, self._forces
        forces.commands[:] = command
        forces.planes[:] = self._terrain.tangents(*data.xpos[self._wheels, :2].T)
        for _ in range(self._settings.substeps):
            mujoco.mj_step1(model, data)
            forces.root[:] = self._root
            np.take(data.xpos, self._wheels, axis=0, out=forces.centres, mode="clip")
            np.take(data.xaxis, self._spins, axis=0, out=forces.axes, mode="clip")
            np.take(data.cvel, self._wheels, axis=0, out=forces.velocities, mode="clip")
            forces()
            data.ctrl[:] = forces.controls
            data.xfrc_applied[self._wheels] = forces.wrenches
            mujoco.mj_step2(model, data)
        mujoco.mj_kinematics(model, data)
        if self._warnings.any():
            raise ConfigurationError(
                "the physics has diverged: masses, stiffnesses and machine.substeps do not fit each other; raise "
                f"machine.substeps (now {self._settings.substeps}) or come nearer to the defaults"
            )

    def stances(self) -> list[Stance]:
        """Return how tractor and trailer stand."""
        data = self._data
        both = [
            stance(data.xpos[body], data.xmat[body], foot, yaw)
            for body, foot, yaw in zip(self._bodies, self._feet, self._yaws, strict=True)
        ]
        self._yaws = [each.yaw for each in both]
        return both

    def angles(self) -> tuple[float, float, float]:
        """Return beta, phi - psi, and the angle of a front wheel midway between both, rad."""
        hitch, joint, left, right = (float(self._data.qpos[index]) for index in self._angles)
        slopes = [
            math.tan(angle) / (1.0 + side * self._share * math.tan(angle)) for side, angle in ((1, left), (-1, right))
        ]
        return hitch, joint, math.atan(0.5 * sum(slopes))

    @property
    def speed(self) -> float:
        """Speed of the rear wheels' treads, mean of both, m/s."""
        left, right = (float(self._data.qvel[index]) for index in self._rear)
        return 0.5 * self._settings.tractor.radius * (left + right)

    @property
    def loads(self) -> Floats:
        """What the ground carries at each wheel, in the order of WHEELS, (6,) N, upwards."""
        return np.array(self._forces.wrenches[:, 2])

    def _place(self, start: Pose) -> None:
        """Lay the tractor on the slope beneath it, and let all wheels down onto the ground."""
        planes = self._terrain.tangents(np.array([start.x]), np.array([start.y]))
        height, east, north = planes[0].tolist()
        up = np.array([-east, -north, 1.0]) / math.sqrt(1.0 + east**2 + north**2)
        left = np.cross(up, [math.cos(start.yaw), math.sin(start.yaw), 0.0])
        left /= np.linalg.norm(left)
        axes = np.column_stack((np.cross(left, up), left, up))
        place = np.array([start.x, start.y, height + east * start.x + north * start.y])
        self._data.qpos[:3] = place + self._settings.tractor.radius * up
        self._mujoco.mju_mat2Quat(self._data.qpos[3:7], axes.ravel())
        self._mujoco.mj_forward(self._model, self._data)
        for _ in range(round(_LET_DOWN / self._settings.step)):
            self.advance(np.zeros(3))
            self._data.qvel[:] *= _BRAKED


def _feet(vehicle: VehicleParameters, settings: PhysicsMachineSettings) -> tuple[tuple[float, float], ...]:
    """Return where the points on the ground are in the frames of tractor and trailer: forward and up, m."""
    sunk, tractor = settings.tyres.deflection, settings.tractor
    return (
        (0.0, sunk - tractor.radius),
        (vehicle.trailer_antenna - vehicle.trailer_length, sunk - tractor.hitch_height),
    )
