"""The simulated machine: moves the true world from sample to sample, reports it through faulty sensors."""

import math
from collections.abc import Callable

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.attitude import ANGLES, Attitude
from drawbar.machine.ground import Ground
from drawbar.machine.history import BodyMoment, History, Moment
from drawbar.machine.motion import LagMotion, Motion, ValveMotion
from drawbar.machine.plant import EFFECTS
from drawbar.machine.sampled import BLOCK, SampledMachine
from drawbar.machine.settings import SimulatedMachineSettings
from drawbar.machine.simulated_sensors import SimulatedSensors
from drawbar.machine.slide import Slide
from drawbar.machine.terrain import Terrain
from drawbar.signals import Pose, Truth
from drawbar.vehicle.parameters import VehicleParameters


class SimulatedMachine(SampledMachine):
    """A tractor and trailer in a computer. Same settings and seed: the identical run.

    It starts at rest with the trailer straight behind it; its lengths are the vehicle's times `settings.lengths`.
    Raises ConfigurationError when the sample time is not a multiple of the integration step, the start is not finite,
    or no vehicle has such lengths.
    """

    def __init__(
        self,
        *,
        vehicle: VehicleParameters,
        settings: SimulatedMachineSettings,
        sample_time: float,
        start: Pose,
        seed: int,
        unknown: Callable[[], Floats] | None = None,
    ) -> None:
        """Place the machine.

        Args:
            vehicle: lengths as stated, and limits.
            settings: everything else.
            sample_time: s.
            start: of the tractor.
            seed: of everything random.
            unknown: gives what is added to mu, kappa, b, alpha_r, alpha_i during a sample, and that not even the truth
                contains.
        """
        super().__init__(vehicle, settings, sample_time, start)
        self._settings, self._flat = settings, settings.terrain.is_flat
        rng = np.random.default_rng(seed)
        self._ground = Ground(settings.ground, settings.events, settings.step, rng)
        history_rng, attitude_rng, floating_rng = (np.random.default_rng((seed, stream)) for stream in range(2, 5))
        self._sensors = SimulatedSensors(
            vehicle=self._vehicle,
            settings=settings,
            sample_time=sample_time,
            rng=rng,
            attitude_rng=attitude_rng,
            floating_rng=floating_rng,
        )
        self._motion: Motion = (
            LagMotion(self._vehicle, settings, self._steps)
            if settings.low_level.kind == "lag"
            else ValveMotion(self._vehicle, settings)
        )
        self._state = self._motion.state
        self._state[:4] = start.x, start.y, start.yaw, start.yaw
        self._unknown = unknown
        truly = self._vehicle
        behind = truly.trailer_length - truly.trailer_antenna
        self._lengths = truly.free_joint_offset, truly.drawbar_length, behind
        self._terrain = Terrain.of_seed(settings.terrain, seed)
        self._settle(history_rng)
        self._draw()

    def _settle(self, history_rng: np.random.Generator) -> None:
        """Let the machine stand on its ground. The randomness of all this is apart from what was there before it."""
        settings, first = self._settings, np.array(self._state)
        self._attitude = Attitude(self._vehicle, settings.bodies, self._terrain, settings.step, first)
        initial = np.concatenate((first, self._attitude.angles))
        self._history = History(settings.step, initial, history_rng, self._moment)

    def _move(self, commands: Floats) -> None:
        effects = self._effects[self._sample % BLOCK]
        if not self._flat:
            effects = effects.copy()
            effects[:, 2:5] += self._creep()
        if self._unknown is not None:
            effects = effects.copy()
            effects[:, :5] += self._unknown()
        self._remember(self._motion.advance(commands, effects))

    def _creep(self) -> tuple[float, float, float]:
        """Return what the slope adds to b, alpha_r and alpha_i now, rad."""
        creep, across = self._settings.terrain.creep, self._terrain.across
        tractor, trailer = creep * across(self._state[2]), creep * across(self._state[3])
        return tractor, tractor, trailer

    def _remember(self, states: Floats) -> None:
        """Let the bodies settle on the ground, and keep all that sensors may report late; states: of the plant."""
        rows = np.zeros((len(states), states.shape[1] + ANGLES))
        rows[:, :-ANGLES] = states
        if not self._flat:
            rows[:, -ANGLES:] = self._attitude.advance(states)
        self._history.append(rows)

    def slide(self, speed: float) -> Slide:
        """Return how the ground draws every axle, at any speed: curves do not."""
        east, north = (self._settings.terrain.creep * fall for fall in self._terrain.falls())
        return Slide(east, north, creep=0.0)

    def truth(self) -> Truth:
        """Return the true state, and the slips that begin to act now; b includes the push of a side slope."""
        x, y, yaw, trailer_yaw, joint, steering, speed, *_ = self._state.tolist()
        mu, kappa, offset, tractor_crab, trailer_crab = self._effects[self._sample % BLOCK, 0, :5].tolist()
        if not self._flat:
            creep = self._creep()
            offset, tractor_crab, trailer_crab = offset + creep[0], tractor_crab + creep[1], trailer_crab + creep[2]
        tractor_roll, tractor_pitch, trailer_roll, trailer_pitch = self._attitude.angles.tolist()
        trailer_x, trailer_y = _trailer_point(self._lengths, x, y, yaw, trailer_yaw, joint)
        return Truth(
            time=self._sample * self._sample_time,
            tractor=Pose(x=x, y=y, yaw=yaw),
            trailer=Pose(x=trailer_x, y=trailer_y, yaw=trailer_yaw),
            speed=speed,
            tractor_steering=steering,
            trailer_steering=joint,
            longitudinal_slip=mu,
            tractor_slip=kappa,
            steering_offset=offset,
            tractor_crab=tractor_crab,
            trailer_crab=trailer_crab,
            tractor_roll=tractor_roll,
            tractor_pitch=tractor_pitch,
            trailer_roll=trailer_roll,
            trailer_pitch=trailer_pitch,
        )

    def _moment(self, age: float, row: list[float], rates: tuple[float, float]) -> Moment:
        """Return what sensors see of a state with its attitudes, 15 numbers."""
        x, y, yaw, trailer_yaw, joint, steering, speed = row[:7]
        tractor_roll, tractor_pitch, trailer_roll, trailer_pitch = row[-ANGLES:]
        trailer = _trailer_point(self._lengths, x, y, yaw, trailer_yaw, joint)
        return Moment(
            age=age,
            tractor=BodyMoment(x, y, yaw, tractor_roll, tractor_pitch, rates[0]),
            trailer=BodyMoment(*trailer, trailer_yaw, trailer_roll, trailer_pitch, rates[1]),
            hitch_angle=yaw - trailer_yaw - joint,
            joint=joint,
            steering=steering,
            speed=speed,
        )

    def _draw(self) -> None:
        samples = self._sample + np.arange(BLOCK, dtype=np.float64)
        steps = self._sample * self._steps + np.arange(BLOCK * self._steps, dtype=np.float64)
        effects = self._ground.block(self._settings.step * steps)
        self._effects = effects.reshape(BLOCK, self._steps, EFFECTS)
        self._sensors.draw(samples)


def _trailer_point(
    lengths: tuple[float, float, float], x: float, y: float, theta: float, psi: float, joint: float
) -> tuple[float, float]:
    """Return the position of the trailer's tracked point, m; joint = phi - psi."""
    (a, d, length), phi = lengths, psi + joint
    return (
        x - a * math.cos(theta) - d * math.cos(phi) - length * math.cos(psi),
        y - a * math.sin(theta) - d * math.sin(phi) - length * math.sin(psi),
    )
