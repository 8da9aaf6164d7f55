"""A controller of the user's own takes part in the whole step."""

import math
import runpy
from pathlib import Path

import numpy as np
import pytest

from drawbar import Controller
from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.signals import Status
from drawbar.simulation import RunAborted, Simulation

EXAMPLES = Path(__file__).parents[2] / "examples"
HEAD = "from drawbar import Controller\nclass Mine(Controller):\n    def command(self, estimate, reference):\n"


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """Return a function that drives a controller whose body is given, and from which folder it comes."""
    monkeypatch.chdir(tmp_path)

    def mine(body, *changes):
        module = f"mine_{abs(hash(body))}"
        (tmp_path / f"{module}.py").write_text(HEAD + f"        {body}\n")
        model = f"controller.model={module}:Mine"
        return Simulation(load_configuration("articulated", [model, "path.radii=[8.0]", *changes]))

    return mine


def test_the_example_keeps_both_bodies_near_the_line(monkeypatch, capsys):
    monkeypatch.chdir(EXAMPLES)
    runpy.run_path(str(EXAMPLES / "pid_controller.py"), run_name="__main__")
    own, product = capsys.readouterr().out.splitlines()
    assert own.startswith("pid_controller:PidController")
    for line, limit in ((own, 5.0), (product, 2.0)):
        assert all(float(word) < limit for word in line.split() if word[0].isdigit())


def test_it_sees_what_the_record_tells_and_its_command_is_given(mine, monkeypatch):
    seen = []
    monkeypatch.setattr("builtins.seen_by_mine", seen, raising=False)
    run = mine("seen_by_mine.append((estimate, reference)); return 0.05, -0.02", "vehicle.joint_sign=-1")
    steps = run.steps()
    records = [next(steps) for _ in range(5)]
    assert len(seen) == 5
    for record, (estimate, reference) in zip(records, seen, strict=True):
        ahead = estimate.tractor  # where the command will act
        assert math.hypot(ahead.x - record.estimate.tractor.x, ahead.y - record.estimate.tractor.y) < 0.3
        assert record.reference.tractor.progress == round(reference.tractor.progress * 2.0**20) / 2.0**20
        assert reference.trailer.samples.shape == (21, 4)
        recorded = np.rint(reference.trailer.closest * 2.0**20) / 2.0**20
        np.testing.assert_array_equal(recorded, record.reference.trailer.closest)
        given = (record.command.tractor_steering, record.command.trailer_steering)
        assert given == pytest.approx((0.05, 0.02), abs=1e-3)  # but for the identified lags of the steerings
        assert record.plan.trailer.steerings == pytest.approx(-0.02, abs=2.0**-11)  # as plans are recorded


def test_an_external_controller_is_given_its_gains(mine):
    run = mine("return self.gains['front'], 0.0", "controller.gains={front=0.03}")
    assert next(run.steps()).command.tractor_steering == 0.03


def test_what_it_raises_comes_out_and_the_machine_is_stopped(mine):
    run = mine("raise ZeroDivisionError('mine')")
    with pytest.raises(ConfigurationError, match="ZeroDivisionError: mine"):
        next(run.steps())
    assert run.machine._newest[2] == 0.0


def test_what_is_not_a_number_is_refused_and_stops_the_vehicle(mine):
    run = mine("return float('nan'), 0.0")
    records = []
    with pytest.raises(
        RunAborted, match=r"^At 0\.8 s the gate had refused every command for as long as one may be repeated \(1 s\)"
    ):
        records.extend(run.steps())
    assert math.isfinite(run.machine.truth().tractor.x)


@pytest.mark.parametrize(
    ("model", "reason"),
    [
        ("nowhere_at_all:Mine", "No module named 'nowhere_at_all'"),
        ("math:Mine", "has no attribute 'Mine'"),
        ("collections:OrderedDict", "OrderedDict is not a subclass of drawbar.Controller"),
        ("not a name:Mine", "  controller: 'model' = 'not a name:Mine' is not one of .*, MODULE:CLASS of your own"),
        (":", "  controller: 'model' = ':' is not one of .*, MODULE:CLASS of your own"),
        ("mine", "'lqr', MODULE:CLASS of your own"),
    ],
)
def test_what_is_no_controller_is_refused(model, reason):
    with pytest.raises(ConfigurationError, match=reason):
        Simulation(load_configuration("articulated", [f"controller.model={model}"]))


def test_a_controller_says_how_it_steers():
    with pytest.raises(TypeError, match="abstract"):
        Controller(None, 0.2, {})


def test_the_status_of_a_refusal_is_in_the_record(mine):
    steps = mine("return float('nan'), 0.0").steps()
    assert next(steps).status in (Status.REFUSED, Status.STOPPED)
