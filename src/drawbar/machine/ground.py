"""Ground under the wheels: wandering slips, slopes and bumps, drawn in blocks of steps."""

import numpy as np

from drawbar.geometry import Floats
from drawbar.machine.events import Bump, Event, SideSlope, SlipStep, active
from drawbar.machine.plant import EFFECTS
from drawbar.machine.random_processes import OrnsteinUhlenbeck
from drawbar.machine.settings import GroundSettings


class Ground:
    """The source of the effects (mu, kappa, b, alpha_r, alpha_i, three kicks) of each integration step."""

    def __init__(
        self, settings: GroundSettings, events: tuple[Event, ...], step: float, rng: np.random.Generator
    ) -> None:
        wandering = (
            settings.longitudinal_slip,
            settings.tractor_slip,
            settings.tractor_crab,
            settings.trailer_crab,
        )
        self._offset = settings.steering_offset
        self._means = np.array([process.mean for process in wandering])
        self._process = OrnsteinUhlenbeck(
            deviations=np.array([process.deviation for process in wandering]),
            time_constants=np.array([process.time_constant for process in wandering]),
            step=step,
            rng=rng,
        )
        # later steps of a slip overrule earlier ones, in whatever order they are listed
        self._slip_steps = sorted((e for e in events if isinstance(e, SlipStep)), key=lambda e: e.start)
        self._slopes = [e for e in events if isinstance(e, SideSlope)]
        self._bumps = [e for e in events if isinstance(e, Bump)]
        self._step = step

    def block(self, times: Floats) -> Floats:
        """Return the effects (n, 8) of the next n integration steps, which begin at the times (n,)."""
        slips, crabs = np.hsplit(self._process.sample(len(times)), 2)
        slope = self._slope(times)
        effects = np.zeros((len(times), EFFECTS))
        effects[:, :2] = reflected(self._slip_means(times) + slips)
        effects[:, 2] = self._offset + slope
        effects[:, 3:5] = self._means[2:] + crabs + slope[:, None]
        for bump in self._bumps:
            struck = active(times, bump.start, self._step)
            effects[struck, 5:] += (bump.lateral, bump.tractor_yaw, bump.trailer_yaw)
        return effects

    def _slip_means(self, times: Floats) -> Floats:
        means = np.tile(self._means[:2], (len(times), 1))
        for event in self._slip_steps:
            column = ("longitudinal_slip", "tractor_slip").index(event.factor)
            means[active(times, event.start), column] = event.value
        return means

    def _slope(self, times: Floats) -> Floats:
        """Crab angle of the slopes at the times; on the front axle it acts like a steering offset."""
        slope = np.zeros_like(times)
        for event in self._slopes:
            slope += np.interp(times, (event.start, event.start + event.ramp), (0.0, event.crab))
        return slope


def reflected(factor: Floats) -> Floats:
    """Return slip factors (...) reflected at 0 and 1 into that range."""
    return np.abs(1.0 - np.abs(1.0 - factor))
