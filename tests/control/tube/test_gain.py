import numpy as np
import pytest

from drawbar.control.settings import BodyTubeSettings
from drawbar.control.tube.gain import gain_of
from drawbar.errors import ConfigurationError, TubeError


def test_a_given_gain_is_taken_as_it_is(body):
    given = BodyTubeSettings(lateral=-0.4, yaw=-1.2)
    assert gain_of("tractor", body("articulated", "tractor").model, given).tolist() == [-0.4, -1.2, 0.0]


@pytest.mark.parametrize(("model", "name"), [("articulated", "tractor"), ("articulated", "trailer")])
def test_the_regulator_is_where_dynamic_programming_ends(model, name, body):
    errors = body(model, name).model
    weights = dict(zip(errors.states, (2.0, 1.0, 0.1), strict=False)) | {"command": 4.0}
    A, B = errors.A[0], errors.B[0]
    Q = np.diag([weights[state] for state in errors.states])
    P = Q
    for _ in range(3000):
        gain = -(B @ P @ A) / (4.0 + B @ P @ B)
        closed = A + np.outer(B, gain)
        P = Q + 4.0 * np.outer(gain, gain) + closed.T @ P @ closed
    assert gain_of(name, errors, BodyTubeSettings(lqr=weights)) == pytest.approx(gain, rel=1e-9)


def test_weights_without_a_regulator_are_refused(body):
    with pytest.raises(TubeError, match="has no regulator"):
        gain_of("tractor", body("articulated", "tractor").model, BodyTubeSettings(lqr={"yaw": 1.0, "command": 1.0}))
    with pytest.raises(ConfigurationError, match="no weight of the command"):
        gain_of("tractor", body("articulated", "tractor").model, BodyTubeSettings(lqr={"lateral": 1.0}))
