"""Every configuration is either understood completely or refused in one readable message."""

import pytest
from configurations import SMALLEST, Write, refusal
from hypothesis import given, settings
from hypothesis import strategies as st

from drawbar.config import load_configuration
from drawbar.configurations import shipped_names


@pytest.mark.parametrize("name", shipped_names())
def test_shipped_configurations_survive_being_written_and_read(name: str, write: Write) -> None:
    configuration = load_configuration(name)
    assert configuration.name == name
    assert load_configuration(write(configuration.to_toml())) == configuration


def test_a_changed_configuration_survives_being_written_and_read(write: Write) -> None:
    changes = (
        'machine.events=[{kind="gps_loss", start=3.0, duration=2.0}, {kind="bump", start=9.0, lateral=0.05}]',
        "path.radii=[7.0]",
        'name="quote \\" and ü"',
        "speed=1",
    )
    configuration = load_configuration("paper", changes)
    assert [event.kind for event in configuration.machine.events] == ["gps_loss", "bump"]
    assert configuration.path.radii == (7.0,)
    assert load_configuration(write(configuration.to_toml())) == configuration


WRONG_VALUES = {
    "vehicle.wheelbase=nan": ("vehicle.wheelbase = nan", "finite"),
    "vehicle.wheelbase=-inf": ("vehicle.wheelbase = -inf", "finite"),
    "vehicle.wheelbase=-1.4": ("vehicle.wheelbase = -1.4", "greater than 0"),
    "vehicle.wheelbase=0": ("vehicle.wheelbase = 0", "greater than 0"),
    'vehicle.wheelbase="1.4"': ("vehicle.wheelbase = '1.4'", "number"),
    "vehicle.wheelbase=long": ("vehicle.wheelbase = 'long'", "number"),
    "vehicle.wheelbase=": ("vehicle.wheelbase = ''", "number"),
    "vehicle.wheelbase=[1.4]": ("vehicle.wheelbase = [1.4]", "number"),
    "vehicle.wheelbase=true": ("vehicle.wheelbase = True", "number"),
    "vehicle.wheelbase={m=1.4}": ("vehicle.wheelbase = {'m': 1.4}", "number"),
    "vehicle.wheelbase=1.4\nspeed=2.0": ("vehicle.wheelbase", "number"),
    "vehicle.joint_sign=0": ("vehicle.joint_sign = 0", "-1 or 1"),
    "vehicle=3": ("vehicle = 3", "section with keys"),
    "name=3": ("name = 3", "string"),
    "name=": ("name = ''", "without slashes"),
    'name="../evil"': ("name = '../evil'", "without slashes"),
    'name="a\\u0000b"': ("name = ", "control character"),
    "sample_time=2.0": ("sample_time = 2.0", "less than or equal to 1"),
    "speed=1e-6": ("speed = 1e-06", "greater than or equal to 0.05"),
    "machine.step=1e-9": ("machine.step = 1e-09", "greater than or equal to 0.0001"),
    "path.straight_length=1e6": ("path.straight_length", "less than or equal to 1000"),
    "vehicle.trailer_antenna=20.0": ("vehicle: trailer_antenna = 20.0 m", "trailer_length = 1.3 m"),
    "vehicle.drawbar_length=5.0": ("vehicle: drawbar_length = 5.0 m", "below hitch_length + wheelbase = 2.5 m"),
    "vehicle.trailer_steering_limit=1.0": ("trailer_steering_limit = 1.0 rad", "trailer_stop = 0.55"),
    "vehicle.tractor_steering_limit=1.5": ("vehicle.tractor_steering_limit = 1.5", "less than 1.39"),
    "vehicle.tractor_steering_limit=30": ("vehicle.tractor_steering_limit = 30", "radians", "0.5236 rad"),
    "estimator.prior.yaw=20.0": ("estimator.prior.yaw = 20.0", "radians", "0.3491 rad"),
    "start.ahead=1e300": ("start.ahead = 1e+300", "less than or equal to 1000"),
    "start.left=-1001.0": ("start.left = -1001.0", "greater than or equal to -1000"),
    "sample_time=0.001": ("controller.tractor.steering_rate = 1 ", "sample_time = 0.001 s"),
    "sample_time=0.04": ("a correction would take 0.434 s", "raise horizon (to 22) or sample_time"),
    "vehicle.wheelbase=0.01": ("too far for vehicle.wheelbase = 0.01 m", "at most 0.0075 m"),
    "start.yaw=-90": ("start.yaw = -90", "radians", "-1.5708 rad"),
    "estimator.window=0": ("estimator.window = 0", "greater than or equal to 2"),
    "estimator.window=1": ("estimator.window = 1", "greater than or equal to 2"),
    "controller.horizon=1": ("controller.horizon = 1", "greater than or equal to 2"),
    "controller.horizon=1000000": ("controller.horizon = 1000000", "less than or equal to 200"),
    "controller.horizon=2.5": ("controller.horizon = 2.5", "integer"),
    "estimator.tractor_slip_bounds={lower=1.0, upper=0.5}": ("estimator.tractor_slip_bounds", "lower = 1.0", "0.5"),
    "estimator.longitudinal_slip_bounds.upper=0.1": ("estimator.longitudinal_slip_bounds", "0.25", "0.1"),
    "estimator.first_slip=7.0": ("estimator: first_slip = 7.0", "0.25 .. 1.0"),
    "controller.coupling=loose": ("controller.coupling = 'loose'", "'neglected', 'measured', 'following' or 'planned'"),
    "guidance.mode=back": ("guidance.mode = 'back'", "'preview' or 'look_ahead'"),
    "estimator.model=kalman": ("estimator: 'model' = 'kalman'", "'articulated', 'tricycle'"),
    "controller={}": ("controller: 'model' is missing",),
    "estimator=3": ("estimator = 3", "section with keys"),
    "path.radii=[]": ("path.radii = []", "1 or more values"),
    "path.radii=[8.0, -2.0]": ("path.radii.1 = -2.0", "greater than 0"),
    "path.radii=[0.0]": ("path.radii.0 = 0.0", "greater than 0"),
    "path.radii=3": ("path.radii = 3", "list"),
    'path.track="Cu 275.4°"': ("path: track = 'Cu 275.4°'", "path.file"),
    "machine.events=[{}]": ("machine.events.0: 'kind' is missing",),
    'machine.events=[{kind="meteor"}]': ("machine.events.0: 'kind' = 'meteor'", "'bump'"),
    'machine.events=[{kind="bump", start=-1.0}]': ("machine.events.0.start = -1.0", "greater than or equal to 0"),
    "speed=10.0": ("speed = 10.0 m/s", "machine.hydrostat.full_speed = 3.0 m/s"),
    "sensors.position=0.0": ("sensors.position = 0.0", "greater than or equal to 0.001"),
    "sensors.position=1e-9": ("sensors.position = 1e-09", "greater than or equal to 0.001"),
    "sensors.hitch_angle=1e-9": ("sensors.hitch_angle = 1e-09", "greater than or equal to 0.00001"),
    "vehicle.wheelbase=1400": ("vehicle.wheelbase = 1400", "1400 mm = 1.4 m"),
    "vehicle.masts.trailer.up=8.2": ("vehicle.masts.trailer.up = 8.2", "feet? 8.2 ft = 2.50 m"),
    "vehicle.masts.tractor.up=250": ("vehicle.masts.tractor.up = 250", "250 cm = 2.5 m, 250 mm = 0.25 m"),
    "vehicle.masts.trailer.left=-300.0": ("vehicle.masts.trailer.left = -300", "-300 mm = -0.3 m"),
    "machine.kind=phisics": ("machine: 'kind' = 'phisics'", "'simulated', 'physics'"),
    "vehicle.trailer_antenna=250.0": ("vehicle.trailer_antenna = 250", "250 mm = 0.25 m"),
    "guidance.path_tolerance=500.0": ("guidance.path_tolerance = 500", "500 mm = 0.5 m"),
    "machine.hydrostat.full_speed=25.0": ("machine.hydrostat.full_speed = 25", "km/h? 25 km/h = 6.94 m/s"),
    "controller.tractor.steering_rate=1e9": ("controller.tractor.steering_rate = 1e+09", "at most 2 s"),
    "controller.tractor.steering_rate=1e300": (
        "controller.tractor.steering_rate = 1e+300",
        "0, or from 1e-12 to 1e+09",
    ),
    "vehicle.steering_lag=5e-324": ("vehicle.steering_lag = 5e-324", "0, or from 1e-12 to 1e+09"),
    "estimator.screening.memory=1000000000000": ("estimator.screening.memory", "0, or from 1e-12 to 1e+09"),
    "tube.trailer.disturbances.tractor_yaw_rate=1e300": ("tractor_yaw_rate = 1e+300", "0, or from 1e-12"),
    "vehicle.dead_time=200": ("vehicle.dead_time = 200", "a delay in seconds up to 1 s", "200 ms = 0.2 s"),
    "vehicle.dead_time=-0.1": ("vehicle.dead_time = -0.1", "greater than or equal to 0"),
    "machine.actuators.dead_time=1e6": ("machine.actuators.dead_time = 1000000", "less than or equal to 5"),
    "machine.low_level.dead_time=5.01": ("machine.low_level.dead_time = 5.01", "less than or equal to 5"),
    "tuning.seeds=1001": ("tuning.seeds = 1001", "less than or equal to 1000"),
    "controller.tractor.steering_rate=1e4": ("controller.tractor.steering_rate = 10000", "lower the weight"),
    "machine.events=gps_loss": ("machine.events = 'gps_loss': must be a list.",),
    "machine.events=[{kind=gps_loss, start=25.0}]": ("must be a list, and this is none in TOML", "texts in quotes"),
    "vehicle.masts={tractor={up=2,5}}": ("must be a section with keys, and this is none in TOML", "decimal points"),
}


@pytest.mark.parametrize("change", WRONG_VALUES)
def test_a_wrong_value_is_refused_by_key_value_and_what_is_allowed(change: str) -> None:
    message = refusal("articulated", change)
    assert "articulated" in message
    assert ": 1 wrong value.\n" in message
    for part in WRONG_VALUES[change]:
        assert part in message


@pytest.mark.parametrize(
    ("change", "section", "key", "known"),
    [
        ("wheelbase=1.4", "configuration", "wheelbase", "sample_time, speed, acceleration"),
        ("vehicle.wheelbse=1.4", "vehicle", "wheelbse", "wheelbase, hitch_length"),
        ("machine.ground.tractor_crab.average=0.0", "machine.ground.tractor_crab", "average", "mean, deviation"),
        ("estimator.prior.joint=0.1", "estimator.prior", "joint", "position, yaw"),
        ("tyres.pressure=1.6", "configuration", "tyres", "vehicle"),
    ],
)
def test_an_unknown_key_is_refused_beside_the_known_ones(change: str, section: str, key: str, known: str) -> None:
    message = refusal("articulated", change)
    meant = " (did you mean wheelbase?)" if key == "wheelbse" else ""
    assert f"{section}: has no key {key}{meant}; its keys are: " in message
    assert known in message


@pytest.mark.parametrize("change", ["speed", "=1.0", " =1.0", ""])
def test_a_change_needs_key_and_value(change: str) -> None:
    assert "KEY=VALUE" in refusal("articulated", change)


@pytest.mark.parametrize("change", ["speed.limit=1.0", "vehicle.wheelbase.front.left=1.0"])
def test_a_value_has_no_keys(change: str) -> None:
    assert "is a value, not a section" in refusal("articulated", change)


def test_a_change_may_begin_a_section_that_is_left_out() -> None:
    message = refusal("articulated", "devices.tractor_board.max_angle=30")
    assert "devices.tractor_board.max_angle = 30: 30.0 is not an angle in radians" in message
    assert "devices.tractor_receiver: is missing" in message


@pytest.mark.parametrize("key", ["roll_offset", "pitch_offset"])
def test_an_attitude_sensor_is_not_mounted_on_its_side(key: str) -> None:
    assert f"vehicle.masts.trailer.{key} = -1.5" in refusal("articulated", f"vehicle.masts.trailer.{key}=-1.5")


def test_all_wrong_values_are_reported_at_once() -> None:
    message = refusal("articulated", "vehicle.wheelbase=-1", "speed=fast", "sensors.speed=nan")
    assert ": 3 wrong values.\n" in message
    for key in ("vehicle.wheelbase", "speed", "sensors.speed"):
        assert f"  {key} = " in message


def test_a_reason_ends_with_one_full_stop() -> None:
    sensors = '{transport="file:memory",hitch_counts=[0,1],hitch_angles=[0.0],pulses_per_metre=100.0}'
    receiver = '{transport="file:memory"}'
    table = f"devices={{tractor_receiver={receiver},sensors={sensors}}}"
    (line,) = [line for line in refusal("articulated", table).splitlines() if "potentiometer" in line]
    assert line.endswith("from lock to lock.")
    assert not line.endswith("..")


def test_missing_keys_are_named(write: Write) -> None:
    message = refusal(write(""))
    for key in ("name", "estimator", "controller"):
        assert f"  {key}: is missing" in message
    assert 'Begin the file with extends = "articulated"' in message
    assert "extends" not in refusal("articulated", "controller={}")
    assert "  machine.ground.longitudinal_slip.mean: is missing" in refusal(
        write(SMALLEST + "[machine.ground]\nlongitudinal_slip = {}")
    )


def test_a_missing_entry_of_a_list_is_named(write: Write) -> None:
    valve = "[devices.isobus.trailer_valve]\ncurvature = [[0.0, 0.0], [0.3]]\n"
    assert "  devices.isobus.trailer_valve.curvature.1.1 = [0.3]: is missing" in refusal(write(SMALLEST + valve))


@pytest.mark.parametrize("first", [0, 1])
def test_a_change_of_a_kind_takes_back_no_other_change(first: int) -> None:
    changes = ["machine.kind=physics", "machine.attitude.tractor.present=true"]
    machine = load_configuration("articulated", [changes[first], changes[1 - first]]).machine
    assert (machine.kind, machine.attitude.tractor.present) == ("physics", True)


def test_changes_are_applied_in_order_over_everything_else() -> None:
    configuration = load_configuration(
        "articulated", ["speed=1.5", "machine.ground.tractor_slip.mean=0.7", "speed=0.5"]
    )
    assert configuration.speed == 0.5
    assert configuration.machine.ground.tractor_slip.mean == 0.7
    assert configuration.machine.ground.tractor_slip.deviation == 0.03


def test_another_model_brings_its_own_defaults() -> None:
    changed = load_configuration("articulated", ["estimator.model=tricycle", "estimator.window=7"])
    assert changed.estimator.model == "tricycle"
    assert changed.estimator.window == 7
    kept = load_configuration("articulated", ["estimator.window=7", "estimator.model=articulated"])
    assert kept.estimator.window == 7


@settings(deadline=None)  # a busy machine is no reason to fail
@given(st.floats(allow_nan=True, allow_infinity=True, width=32), st.sampled_from(["wheelbase", "steering_lag"]))
def test_no_number_passes_but_positive_sane_ones(value: float, key: str) -> None:
    changes = [f"vehicle.{key}={value!r}"]
    least, most = {"wheelbase": (0.2 / 0.75, 30.0), "steering_lag": (1e-12, 1e9)}[key]
    if least <= value <= most:
        assert getattr(load_configuration("articulated", changes).vehicle, key) == value
    else:
        assert f"vehicle.{key}" in refusal("articulated", *changes)


@pytest.mark.parametrize("name", ["articulated", "paper"])
def test_a_vehicle_that_drives_its_wheelbase_between_two_samples_is_refused(name: str) -> None:
    fast = ("machine.hydrostat.full_speed=6.0", "sample_time=0.5")
    load_configuration(name, [*fast, "speed=2.0"])
    assert "drives the vehicle 1.1 m in each sample_time = 0.5 s" in refusal(name, *fast, "speed=2.2")


def test_steering_that_weighs_too_much_against_the_papers_position_is_refused() -> None:
    assert "controller.steering_weight = 100000 is too large" in refusal("paper", "controller.steering_weight=1e5")


def test_a_zero_character_in_the_name_of_a_line_is_refused() -> None:
    assert "path.file" in refusal("articulated", 'path.file="a\\u0000.csv"')


def test_errors_of_an_estimate_that_is_not_ideal_are_refused() -> None:
    errors = "bounded_errors.estimate.tractor_yaw=0.01"
    assert 'set it to "ideal", or leave these bounds zero' in refusal("articulated", errors)
    assert load_configuration("articulated-ideal", [errors]).bounded_errors.estimate.tractor_yaw == 0.01
