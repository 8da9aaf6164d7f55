"""Sensor errors, drawn in blocks of samples."""

import numpy as np
from numpy.typing import NDArray

from drawbar.geometry import Floats
from drawbar.machine.events import COLUMNS, Event, GpsJump, GpsLoss, active
from drawbar.machine.random_processes import OrnsteinUhlenbeck
from drawbar.machine.sensor_settings import SensorSettings


class SensorErrors:
    """The source of the sensors' additive errors and of the moments at which a receiver repeats itself."""

    def __init__(
        self,
        settings: SensorSettings,
        events: tuple[Event, ...],
        sample_time: float,
        rng: np.random.Generator,
    ) -> None:
        position, steering = settings.position, settings.steering
        self._deviations = np.array(
            [position, position, position, position, settings.hitch_angle, settings.speed, steering, steering]
        )
        self._drift = OrnsteinUhlenbeck(
            deviations=np.full(4, settings.position_drift),
            time_constants=np.full(4, settings.drift_time),
            step=sample_time,
            rng=rng,
        )
        self._rng = rng
        self._jumps = [e for e in events if isinstance(e, GpsJump)]
        self._losses = [e for e in events if isinstance(e, GpsLoss)]

    def block(self, times: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """Return the errors (n, 8) and held flags (n, 4) of the next n samples, taken at the times (n,).

        Columns: tractor x, y, trailer x, y (m), beta (rad), wheel speed (m/s), delta_t, delta_i (rad). A
        masked coordinate has the error NaN; a held one is to be repeated.
        """
        errors = self._deviations * self._rng.standard_normal((len(times), 8))
        errors[:, :4] += self._drift.sample(len(times))
        held = np.zeros((len(times), 4), dtype=np.bool_)
        for jump in self._jumps:
            rows, columns = active(times, jump.start, jump.duration), COLUMNS[jump.antenna]
            shift = np.tile((jump.east, jump.north), 2)
            errors[rows, columns] += shift[columns]
        for loss in self._losses:
            rows, columns = active(times, loss.start, loss.duration), COLUMNS[loss.antenna]
            if loss.report == "masked":
                errors[rows, columns] = np.nan
            else:
                held[rows, columns] = True
        return errors, held
