import numpy as np
import pytest

from drawbar.bounded import BoundedSequence, Draw

BOUNDS = np.array([0.0, 0.1, 2.0])
WORST = np.array([[1.0, -1.0, 1.0], [-1.0, 1.0, 0.0], [1.0, 1.0, -1.0]])


def drawn(draw, seed=0, count=400):
    sequence = BoundedSequence(draw, BOUNDS, seed=seed, worst=WORST)
    return np.array([sequence.draw() for _ in range(count)])


@pytest.mark.parametrize("draw", list(Draw))
def test_no_error_is_beyond_its_bound_and_the_seed_decides(draw):
    errors = drawn(draw)
    assert (np.abs(errors) <= BOUNDS).all()
    np.testing.assert_array_equal(errors, drawn(draw))
    assert any((errors != drawn(draw, seed)).any() for seed in (1, 2, 3))


def test_random_errors_fill_the_box_and_vertices_are_its_corners():
    errors, corners = drawn(Draw.RANDOM)[:, 1:], drawn(Draw.VERTICES)[:, 1:]
    assert np.abs(errors.mean(axis=0) / BOUNDS[1:]).max() < 0.1
    assert (np.abs(errors).max(axis=0) > 0.98 * BOUNDS[1:]).all()
    assert np.abs(np.quantile(errors[:, 1], [0.25, 0.75])) == pytest.approx([1.0, 1.0], abs=0.2)
    np.testing.assert_array_equal(np.abs(corners), np.tile(BOUNDS[1:], (400, 1)))
    assert len({tuple(corner) for corner in corners.tolist()}) == 4


def test_the_adversary_goes_through_its_plan_over_and_over_from_where_the_seed_says():
    starts = set()
    for seed in range(12):
        errors = drawn(Draw.ADVERSARIAL, seed, 9)
        start = next(i for i in range(3) if (errors[0] == BOUNDS * WORST[i]).all())
        starts.add(start)
        np.testing.assert_array_equal(errors, BOUNDS * np.tile(np.roll(WORST, -start, axis=0), (3, 1)))
        one = BoundedSequence(Draw.ADVERSARIAL, np.ones(1), seed=seed, worst=np.arange(3.0)[:, None])
        assert one.draw() == start  # all sequences of a seed begin at the same place of the plan
    assert starts == {0, 1, 2}
