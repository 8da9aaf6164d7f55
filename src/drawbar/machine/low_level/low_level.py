"""The low level in this process: the very C of `drawbar_actuate` (step/public/drawbar_actuate.h)."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import TypeAlias

from drawbar.codegen import build
from drawbar.codegen.library import Workspace
from drawbar.errors import ConfigurationError
from drawbar.machine.low_level.settings import PositionLoopSettings, SpeedLoopSettings
from drawbar.protocols.sensors import InductiveSensor, Potentiometer

FRONT, JOINT, PEDAL = range(3)
"""enum drawbar_actuator"""
LONGEST_PERIOD = 0.1
"""between two calls, s"""
STANDSTILL = 0.2 / 3.6
"""speed below which a vehicle stands, m/s"""
STANDING_TIME = 2.0
"""for how long a standing tyre may be steered, s"""
_UNIT = """\
#include "actuate.h"
#include "fields.h"

struct hosted {
    struct drawbar_actuate_settings settings;
    struct drawbar_actuate_state state;
    struct drawbar_actuate_input input;
    struct drawbar_actuate_output output;
};

int64_t drawbar_size = sizeof(struct hosted);
const struct drawbar_field drawbar_fields[] = {
    @FIELDS@
    END_OF_FIELDS
};

int begin(struct hosted *h)
{
    return drawbar_actuate_init(&h->state, &h->settings);
}

int actuate(struct hosted *h)
{
    return drawbar_actuate(&h->state, &h->input, &h->output);
}
"""
_SENSOR = {"lowest": 1, "highest": 1, "counts": 16, "values": 16, "cubic": 4}
_LOOP = ("proportional", "integral", "integral_limit", "stop_zone", "limit", "compensation", "drive_limit")
_SPEED = (*SpeedLoopSettings.model_fields, "full_speed")


class ActuateStatus(IntEnum):
    """How one actuator fares (enum drawbar_actuate_status)."""

    FINE = 0
    OFF = 1
    STANDING = 2
    TIME = 16
    SET_POINT = 17
    SENSOR = 18
    SPEED = 19
    NO_FEEDBACK = 20
    NULL = 64
    NOT_INITIALISED = 65
    SETTINGS = 66
    UNALIGNED = 67
    ARITHMETIC = 68


@dataclass(frozen=True, slots=True, kw_only=True)
class TableSensor:
    """A sensor's table of 2 to 16 points where nothing stricter is known: a pedal, a simulated sensor."""

    counts: tuple[float, ...]
    """increasing"""
    values: tuple[float, ...]
    """rad or strokes; rising or falling throughout"""
    lowest: float
    """electrical range"""
    highest: float


Sensor: TypeAlias = TableSensor | Potentiometer | InductiveSensor


@dataclass(frozen=True, slots=True, kw_only=True)
class SteeringAxis:
    """One steering actuator: sensor, loop, and the largest set point, rad."""

    sensor: Sensor
    loop: PositionLoopSettings
    limit: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedAxis:
    """The pedal with its sensor and its loop, and the loop around it."""

    sensor: Sensor
    loop: PositionLoopSettings
    speed: SpeedLoopSettings
    full_speed: float
    """at the full pedal, m/s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuateInput:
    """struct drawbar_actuate_input; fields of an absent actuator may stay as they are."""

    time: float
    """s, steady"""
    measured_speed: float
    """m/s"""
    counts: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """of front wheels, joint and pedal"""
    steering: tuple[float, float] = (0.0, 0.0)
    """set points, rad"""
    speed: float = 0.0
    """set point, m/s"""
    steer: tuple[bool, bool] = (False, False)
    drive: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuateOutput:
    """struct drawbar_actuate_output."""

    drives: tuple[float, float, float]
    """-1 to 1, to the left or up positive"""
    positions: tuple[float, float, float]
    """rad and strokes; NaN: fault, or absent"""
    pedal: float
    """set point, strokes"""
    statuses: tuple[ActuateStatus, ActuateStatus, ActuateStatus]


class LowLevel:
    """Front wheels, joint and pedal, each where it is given, under drawbar_actuate."""

    def __init__(
        self,
        *,
        front: SteeringAxis | None = None,
        joint: SteeringAxis | None = None,
        pedal: SpeedAxis | None = None,
        longest_period: float = LONGEST_PERIOD,
        standing_time: float = STANDING_TIME,
    ) -> None:
        """Write the settings; nothing is asked of any actuator yet.

        Raises:
            ConfigurationError: drawbar_actuate_init refuses them.
            CompilerError: no compiler, or it refused the code.
        """
        self._unit = Workspace(build("actuate", _UNIT.replace("@FIELDS@", _fields())))
        self._unit.write(
            {
                "settings.longest_period": longest_period,
                "settings.standstill": STANDSTILL,
                "settings.standing_time": standing_time,
                "settings.present": [front is not None, joint is not None, pedal is not None],
            }
        )
        for i, axis in ((FRONT, front), (JOINT, joint)):
            if axis is not None:
                self._write_axis(i, axis.sensor, axis.loop, axis.limit)
        if pedal is not None:
            self._write_axis(PEDAL, pedal.sensor, pedal.loop, 1.0)
            numbers = {**pedal.speed.model_dump(), "full_speed": pedal.full_speed}
            self._unit.write({f"settings.speed.{name}": value for name, value in numbers.items()})
        if self._unit.function("begin")() != ActuateStatus.FINE:
            raise ConfigurationError(
                "drawbar_actuate refuses a setting: it is not finite, or beyond what drawbar_actuate.h allows; compare "
                f"front = {front}, joint = {joint}, pedal = {pedal}."
            )
        self._actuate = self._unit.function("actuate")
        array = self._unit.array
        self._given = [array(f"input.{name}") for name in ("time", "counts", "steering", "speed", "measured_speed")]
        self._wanted = [array(f"input.{name}") for name in ("steer", "drive")]
        self._made = [array(f"output.{name}") for name in ("drives", "positions", "pedal", "statuses")]

    def _write_axis(self, i: int, sensor: Sensor, loop: PositionLoopSettings, limit: float) -> None:
        numbers = {**loop.model_dump(), "limit": limit}
        place = f"settings.loops[{i}]"
        self._unit.write({f"{place}.{name}": numbers[name] for name in _LOOP})
        for name in ("dead_band", "full_rate"):
            self._unit.write({f"{place}.{name}": [numbers[f"{name}_left"], numbers[f"{name}_right"]]})
        place = f"settings.sensors[{i}]"
        self._unit.write({f"{place}.lowest": sensor.lowest, f"{place}.highest": sensor.highest})
        if isinstance(sensor, InductiveSensor):
            self._unit.write({f"{place}.cubic": sensor.coefficients})
            return
        values = sensor.angles if isinstance(sensor, Potentiometer) else sensor.values
        self._unit.write({f"{place}.points": len(values)})
        self._fill(f"{place}.counts", sensor.counts)
        self._fill(f"{place}.values", values)

    def _fill(self, name: str, values: Sequence[float]) -> None:
        array = self._unit.array(name)
        if len(values) > len(array):
            raise ConfigurationError(f"a sensor's table has {len(values)} points; give {len(array)} at most.")
        array[: len(values)] = values

    def step(self, given: ActuateInput) -> ActuateOutput:
        """Return the drives of this moment; call it 50 to 200 times a second."""
        values = (given.time, given.counts, given.steering, given.speed, given.measured_speed)
        for array, value in zip(self._given, values, strict=True):
            array[:] = value
        self._wanted[0][:], self._wanted[1][:] = given.steer, given.drive
        self._actuate()
        drives, positions, pedal, statuses = (array.tolist() for array in self._made)
        return ActuateOutput(
            drives=tuple(drives),
            positions=tuple(positions),
            pedal=pedal[0],
            statuses=tuple(map(ActuateStatus, statuses)),  # type: ignore[arg-type]
        )


def _fields() -> str:
    """Return the entries of the table of where the numbers lie."""
    lines = []
    for i in range(3):
        lines += [_field(f"settings.sensors[{i}].{name}", length) for name, length in _SENSOR.items()]
        lines.append(_field(f"settings.sensors[{i}].points", 1, integer=True))
        lines += [_field(f"settings.loops[{i}].{name}", 1) for name in _LOOP]
        lines += [_field(f"settings.loops[{i}].{name}", 2) for name in ("dead_band", "full_rate")]
    lines += [_field(f"settings.speed.{name}", 1) for name in _SPEED]
    lines += [_field(f"settings.{name}", 1) for name in ("longest_period", "standstill", "standing_time")]
    lines.append(_field("settings.present", 3, integer=True))
    inputs = {"time": 1, "counts": 3, "steering": 2, "speed": 1, "measured_speed": 1}
    lines += [_field(f"input.{name}", length) for name, length in inputs.items()]
    lines += [_field("input.steer", 2, integer=True), _field("input.drive", 1, integer=True)]
    lines += [_field(f"output.{name}", length) for name, length in {"drives": 3, "positions": 3, "pedal": 1}.items()]
    return " ".join([*lines, _field("output.statuses", 3, integer=True)])


def _field(name: str, length: int, *, integer: bool = False) -> str:
    return f"FIELD(hosted, {name}, {int(integer)}, {length}, 0, 0)"
