"""Moving horizon estimation: one Gauss-Newton iteration per sample over a sliding window (equation mhe)."""

from drawbar.codegen import Unit
from drawbar.estimation.description import EstimationModel
from drawbar.optimal import solver_unit


def moving_horizon_unit(model: EstimationModel) -> Unit:
    """Return the estimator on a model (moving_horizon.h).

    The window fills from the first measurement on; once full, its oldest stage moves into the arrival cost.
    """
    return solver_unit("estimator", model.problem, f"{model.name}_moving_horizon.h", model.configure)
