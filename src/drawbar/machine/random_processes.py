"""Random processes in exact discrete time: their statistics do not depend on the step."""

import numpy as np

from drawbar.geometry import Floats


def first_order(inputs: Floats, *, decay: float, last: float) -> Floats:
    """Return y (n,) with y_k = decay y_k-1 + inputs_k, where `last` was before the first."""
    decay, last = float(decay), float(last)  # numpy's own scalars are several times slower
    return np.fromiter([last := decay * last + given for given in inputs.tolist()], np.float64, len(inputs))


class OrnsteinUhlenbeck:
    """Independent zero-mean Ornstein-Uhlenbeck (Gauss-Markov) processes, stationary from the start.

    x_k+1 = a x_k + s sqrt(1 - a²) w_k with a = exp(-step / time constant) and w white, of variance one.
    """

    def __init__(self, *, deviations: Floats, time_constants: Floats, step: float, rng: np.random.Generator) -> None:
        self._decays = np.exp(-step / time_constants)
        self._gains = deviations * np.sqrt(-np.expm1(-2.0 * step / time_constants))
        self._rng = rng
        self._last = deviations * rng.standard_normal(len(deviations))

    def sample(self, count: int) -> Floats:
        """Return the next values (count, n) of the n processes."""
        values = self._gains * self._rng.standard_normal((count, len(self._gains)))
        for column, decay in enumerate(self._decays):
            values[:, column] = first_order(values[:, column], decay=decay, last=self._last[column])
        self._last = values[-1].copy()
        return values
