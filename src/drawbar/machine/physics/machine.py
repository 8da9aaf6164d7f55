"""The physics machine: a multibody on uneven ground, moved from sample to sample, seen through faulty sensors."""

import math

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.history import BodyMoment, History, Moment
from drawbar.machine.physics.multibody import Multibody
from drawbar.machine.physics.settings import PhysicsMachineSettings
from drawbar.machine.physics.state import ROLLING, Slides, State, slides
from drawbar.machine.sampled import BLOCK, SampledMachine
from drawbar.machine.simulated_sensors import SimulatedSensors
from drawbar.machine.slide import Slide
from drawbar.machine.terrain import Terrain
from drawbar.signals import Pose, Truth
from drawbar.vehicle.parameters import VehicleParameters

_SMOOTHED = 2.0
"""time constant of the slips in the truth, and of what slope and curve do not explain of the side-slips, s: the
controllers' models hold them for constant, while on tyres they follow every motion of the wheels; who believes their
momentary values steers against himself"""


class PhysicsMachine(SampledMachine):
    """A tractor and trailer with masses, tyres and ground. Same settings and seed: the identical run.

    It starts at rest with the trailer straight behind it; its lengths are the vehicle's times `settings.lengths`.
    Raises ConfigurationError when MuJoCo is not installed, the sample time is not a multiple of the step, the start is
    not finite, or no vehicle has such lengths.
    """

    def __init__(
        self,
        *,
        vehicle: VehicleParameters,
        settings: PhysicsMachineSettings,
        sample_time: float,
        start: Pose,
        seed: int,
    ) -> None:
        """Place the machine on its ground.

        Args:
            vehicle: lengths as stated, and limits.
            settings: everything else.
            sample_time: s.
            start: of the tractor.
            seed: of everything random; the same seed is the same ground as the simulated machine's.
        """
        super().__init__(vehicle, settings, sample_time, start)
        self._settings = settings
        rng, history_rng, attitude_rng, floating_rng = _streams(seed)
        self.terrain = Terrain.of_seed(settings.terrain, seed)
        self.multibody = Multibody(self._vehicle, settings, self.terrain, start)
        self._sensors = SimulatedSensors(
            vehicle=self._vehicle,
            settings=settings,
            sample_time=sample_time,
            rng=rng,
            attitude_rng=attitude_rng,
            floating_rng=floating_rng,
        )
        self._now = self._state()
        self._slides = self._unexplained = Slides(
            longitudinal_slip=1.0, steering_offset=0.0, tractor_crab=0.0, trailer_crab=0.0
        )
        self._history = History(settings.step, np.array(self._now), history_rng, _moment)
        self._draw()

    def truth(self) -> Truth:
        """Return the true state. Slips, and side-slips beside the ground's slide, are averages, see _SMOOTHED."""
        state, slid = self._now, self._slides
        return Truth(
            time=self._sample * self._sample_time,
            tractor=Pose(x=state.tractor_x, y=state.tractor_y, yaw=state.tractor_yaw),
            trailer=Pose(x=state.trailer_x, y=state.trailer_y, yaw=state.trailer_yaw),
            speed=state.speed,
            tractor_steering=state.steering,
            trailer_steering=state.joint,
            longitudinal_slip=slid.longitudinal_slip,
            tractor_slip=1.0,
            steering_offset=slid.steering_offset,
            tractor_crab=slid.tractor_crab,
            trailer_crab=slid.trailer_crab,
            tractor_roll=state.tractor_roll,
            tractor_pitch=state.tractor_pitch,
            trailer_roll=state.trailer_roll,
            trailer_pitch=state.trailer_pitch,
            tractor_height=state.tractor_z,
            trailer_height=state.trailer_z,
        )

    def _move(self, commands: Floats) -> None:
        rows: Floats = np.empty((self._steps, len(State._fields)))
        before = self._now
        for step, command in enumerate(commands):
            self.multibody.advance(command)
            self._now = self._state()
            rows[step] = self._now
        self._history.append(rows)
        self._smooth(slides(self._now, before, self._sample_time, self._vehicle), before)

    def slide(self, speed: float) -> Slide:
        """Return how the ground draws every axle at a speed (m/s): by the tyres' law (tyres.py)."""
        tyres, terrain = self._settings.tyres, self._settings.terrain
        share = terrain.creep_speed / max(speed, ROLLING) if terrain.creep_speed else 1.0
        creep = max(share * terrain.creep, 1.0 / tyres.cornering)
        east, north = (creep * fall for fall in self.terrain.falls())
        return Slide(east, north, creep)

    def _smooth(self, slid: Slides, before: State) -> None:
        """Take what the wheels did during a sample into the averages."""
        keep, speed = math.exp(-self._sample_time / _SMOOTHED), self._now.speed
        tractor_turned = self._now.tractor_yaw - before.tractor_yaw
        trailer_turned = self._now.trailer_yaw - before.trailer_yaw
        ground = self.slide(speed)
        tractor = ground.across(self._now.tractor_yaw, speed, tractor_turned / self._sample_time)
        trailer = ground.across(self._now.trailer_yaw, speed, trailer_turned / self._sample_time)
        explained = Slides(0.0, steering_offset=tractor, tractor_crab=tractor, trailer_crab=trailer)
        parts = zip(self._unexplained, slid, explained, strict=True)
        self._unexplained = Slides(*(keep * old + (1.0 - keep) * (new - known) for old, new, known in parts))
        self._slides = Slides(*map(sum, zip(self._unexplained, explained, strict=True)))

    def _state(self) -> State:
        tractor, trailer = self.multibody.stances()
        hitch, joint, steering = self.multibody.angles()
        return State(
            tractor_x=tractor.x,
            tractor_y=tractor.y,
            tractor_yaw=tractor.yaw,
            trailer_yaw=trailer.yaw,
            trailer_x=trailer.x,
            trailer_y=trailer.y,
            tractor_z=tractor.z,
            trailer_z=trailer.z,
            tractor_roll=tractor.roll,
            tractor_pitch=tractor.pitch,
            trailer_roll=trailer.roll,
            trailer_pitch=trailer.pitch,
            hitch_angle=hitch,
            joint=joint,
            steering=steering,
            speed=self.multibody.speed,
        )

    def _draw(self) -> None:
        self._sensors.draw(self._sample + np.arange(BLOCK, dtype=np.float64))


def _moment(age: float, row: list[float], rates: tuple[float, float]) -> Moment:
    """Return what sensors see of a state."""
    state = State(*row)
    return Moment(
        age=age,
        tractor=BodyMoment(
            state.tractor_x, state.tractor_y, state.tractor_yaw, state.tractor_roll, state.tractor_pitch, rates[0]
        ),
        trailer=BodyMoment(
            state.trailer_x, state.trailer_y, state.trailer_yaw, state.trailer_roll, state.trailer_pitch, rates[1]
        ),
        hitch_angle=state.hitch_angle,
        joint=state.joint,
        steering=state.steering,
        speed=state.speed,
    )


def _streams(seed: int) -> list[np.random.Generator]:
    """Return a stream for each kind of randomness: the sensors', then those numbered as the simulated machine does."""
    return [np.random.default_rng(seed), *(np.random.default_rng((seed, stream)) for stream in range(2, 5))]
