"""Orders: what each process of a drive is told at its start, as JSON on its standard input."""

from pathlib import Path

from pydantic import BaseModel, ConfigDict

from drawbar.machine.hardware.isobus import IsobusSettings
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.safety.settings import SafetySettings


class Orders(BaseModel):
    """Where the processes find each other, and what they read."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    folder: str
    """of the sockets; the user's own, gone after the drive"""
    run: str
    """folder of the drive's log"""
    configuration: str
    """the complete configuration, a TOML file"""
    live: int | None = None
    """port of this computer on which the recorder shows what it records; None: it does not"""
    stand_ins: bool = False
    """its devices are stand-ins of this drive, gone after it"""

    def socket(self, name: str) -> str:
        """Return the path of a process's socket."""
        return str(Path(self.folder) / name)


GATE, CONTROLLER, RECORDER, FRONT_END, DRIVER = "gate", "controller", "recorder", "front", "driver"
CONSOLE, GUARD, RECEIVERS = "console", "guard", "receivers"
"""names of the sockets; the driver's is that of a lamp, or a stand-in"""
SOCKETS = (GATE, CONTROLLER, RECORDER, FRONT_END, DRIVER, CONSOLE, GUARD, RECEIVERS)
ORDERS_NAME = "orders.json"
"""in the folder of the sockets: what a console that is started later needs to know"""


class GateOrders(BaseModel):
    """What the gate is told: numbers only, so that it loads neither numpy nor the configuration's other sections."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    folder: str
    safety: SafetySettings
    controller: int
    """descriptor of the gate's end of the pair"""
    wheelbase: float
    """m"""
    tractor_limit: float
    """rad"""
    trailer_limit: float
    """rad"""
    tractor_board: SteerBoardSettings | None
    trailer_board: SteerBoardSettings | None
    isobus: IsobusSettings | None
    drives: bool = False
    """the tractor's speed is commanded over the ISOBUS"""
    shadow: bool = False
    """actuators are only listened to"""
