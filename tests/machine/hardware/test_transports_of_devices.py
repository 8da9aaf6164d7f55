"""An address at which nothing can be opened is refused with the configuration, by file and key."""

import pytest

from drawbar.config import load_configuration
from drawbar.driving.stand_in.demonstration import with_stand_ins
from drawbar.errors import ConfigurationError
from drawbar.machine.hardware.devices import DeviceSettings

ISOBUS = """
[devices.isobus]
bus = "can:foo:can0"
name = {identity = 1}
"""


@pytest.fixture(scope="module")
def text():
    """Return a configuration with devices, as TOML."""
    return with_stand_ins(load_configuration("articulated")).to_toml()


@pytest.mark.parametrize("device", ["tractor_receiver", "trailer_receiver", "sensors"])
@pytest.mark.parametrize(
    ("given", "why"),
    [
        ("foo", "'foo' is no kind of transport; give serial:"),
        ("serial:/dev/ttyUSB0", "it needs a device and a baud rate"),
        ("can:foo:can0", "can:foo is no kind of CAN bus"),
    ],
)
def test_a_transport_that_is_none_is_refused(text, tmp_path, device, given, why):
    file = tmp_path / "my.toml"
    before, section, after = text.partition(f"[devices.{device}]\n")
    old = after[: after.index("\n\n")]
    line = next(each for each in old.splitlines() if each.startswith("transport = "))
    file.write_text(before + section + after.replace(line, f'transport = "{given}"', 1), "utf-8")
    with pytest.raises(ConfigurationError) as refused:
        load_configuration(str(file))
    for part in (str(file), f"devices.{device}.transport", why):
        assert part in str(refused.value)


def test_a_trailer_that_nothing_locates_is_refused():
    devices = with_stand_ins(load_configuration("articulated")).devices.model_dump() | {"trailer_receiver": None}
    assert len(DeviceSettings.model_validate(devices).receivers) == 1
    for sensors in (None, devices["sensors"] | {"hitch_counts": (), "hitch_angles": ()}):
        with pytest.raises(ValueError, match="nothing shows where the trailer is"):
            DeviceSettings.model_validate(devices | {"sensors": sensors})


def test_the_only_receiver_on_nmea_2000_says_that_it_has_two_antennas():
    devices = with_stand_ins(load_configuration("articulated")).devices.model_dump() | {"trailer_receiver": None}
    with pytest.raises(ValueError, match=r"tractor_receiver.antennas.baseline, the distance of its two antennas"):
        DeviceSettings.model_validate(devices | {"tractor_receiver": {"transport": "can:socketcan:can1"}})
    alone = {"transport": "can:socketcan:can1", "antennas": {"baseline": 1.2}}
    assert len(DeviceSettings.model_validate(devices | {"tractor_receiver": alone}).receivers) == 1


def test_a_bus_that_is_none_is_refused(text, tmp_path):
    file = tmp_path / "my.toml"
    file.write_text(text + ISOBUS, "utf-8")
    with pytest.raises(ConfigurationError, match=r"devices\.isobus\.bus.*can:foo is no kind of CAN bus"):
        load_configuration(str(file))
