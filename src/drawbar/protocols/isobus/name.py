"""NAME: the 64 bits that identify a device on the bus and arbitrate between two that claim one address."""

from dataclasses import dataclass, fields

from drawbar.errors import ConfigurationError

_BITS = {
    "identity": (0, 21),
    "manufacturer": (21, 11),
    "ecu_instance": (32, 3),
    "function_instance": (35, 5),
    "function": (40, 8),
    "device_class": (49, 7),
    "device_class_instance": (56, 4),
    "industry_group": (60, 3),
    "self_configurable": (63, 1),
}
"""first bit and width of each field (ISO 11783-5, J1939-81)"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Name:
    """The fields of a NAME; the smaller `value` has the right to an address.

    Raises:
        ConfigurationError: a field does not fit its bits

    """

    identity: int
    """serial number, 21 bits"""
    manufacturer: int
    """code assigned by the ISOBUS registry, 11 bits"""
    function: int
    """code assigned by the ISOBUS registry, 8 bits"""
    ecu_instance: int = 0
    function_instance: int = 0
    device_class: int = 0
    device_class_instance: int = 0
    industry_group: int = 2
    """2: agriculture and forestry"""
    self_configurable: bool = True
    """may take another address where its own is taken"""

    def __post_init__(self) -> None:
        for field in fields(self):
            given, (_, width) = int(getattr(self, field.name)), _BITS[field.name]
            if not (0 <= given < 1 << width):
                raise ConfigurationError(f"NAME: {field.name} is {given}, allowed are 0 to {(1 << width) - 1}")

    @property
    def value(self) -> int:
        """The 64 bits as a number."""
        return sum(int(getattr(self, key)) << first for key, (first, _) in _BITS.items())

    @property
    def data(self) -> bytes:
        """The 64 bits as they go over the bus."""
        return self.value.to_bytes(8, "little")
