"""Deviation of the newest state in a window: the covariance that a moving horizon estimator does not need itself."""

import numpy as np

from drawbar.codegen import Workspace
from drawbar.geometry import Floats


def newest_covariance(estimator: Workspace) -> Floats:
    """Return the covariance (nx + np, nx + np) of states and parameters at the newest stage of an estimator's window.

    The window's Gauss-Newton Hessian is the information of its trajectory, the arrival cost included. Each step takes
    the information on (x_k, u_k) to the covariance of x_{k+1} = A x_k + B u_k, and adds what stage k+1 measured. Bounds
    are not counted. After the feedback phase it holds for the estimate, after the preparation for its prediction.
    """
    A, B, Q, S, R = (estimator.array(f"qp.{name}") for name in "ABQSR")
    moving, states = A.shape[1:]
    S = S if len(S) else np.zeros((*B.shape[::2], states))  # not stored where it is zero
    stays = np.eye(states, states + B.shape[2])[moving:]  # the constant states' rows are not stored
    information = Q[0]
    for k in range(int(estimator.array("window.newest")[0])):
        joint = np.block([[information, S[k].T], [S[k], R[k]]])
        step = np.vstack([np.hstack([A[k], B[k]]), stays])
        information = np.linalg.inv(step @ np.linalg.solve(joint, step.T)) + Q[k + 1]
    covariance: Floats = np.linalg.inv(information)
    return covariance


def newest_deviation(estimator: Workspace) -> Floats:
    """Return standard deviations (nx + np,) of states and parameters; see newest_covariance()."""
    deviation: Floats = np.sqrt(np.diag(newest_covariance(estimator)))
    return deviation
