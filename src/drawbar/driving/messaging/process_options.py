"""Options of the processes of a drive: what each is given at its start, as JSON on its standard input."""

from pathlib import Path
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from drawbar.machine.hardware.isobus import IsobusSettings
from drawbar.machine.hardware.steer_board import SteerBoardSettings
from drawbar.safety.settings import SafetySettings
from drawbar.transports.address import stays_here
from drawbar.transports.clock import FASTEST, MachineClock


class PacedOptions(BaseModel):
    """What every process of a drive is given."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    pace: Annotated[int, Field(ge=1, le=FASTEST)] = 1
    """of a stand-in on this computer; a machine's is 1"""

    @property
    def clock(self) -> MachineClock:
        """The clock of the drive."""
        return MachineClock(self.pace)


class ProcessOptions(PacedOptions):
    """Where the processes find each other, and what they read."""

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
    shadow: bool = False
    """drawbar only looks on"""

    def socket(self, name: str) -> str:
        """Return the path of a process's socket."""
        return str(Path(self.folder) / name)


GATE, CONTROLLER, RECORDER, FRONT_END, DRIVER = "gate", "controller", "recorder", "front", "driver"
CONSOLE, GUARD, RECEIVERS, SENTENCES, BOARDS = "console", "guard", "receivers", "sentences", "boards"
"""names of the sockets; DRIVER: of this drive's own stand-in; SENTENCES: of receivers on boards; BOARDS: at which the
guard receives the boards' sockets from the gate"""
SOCKETS = (GATE, CONTROLLER, RECORDER, FRONT_END, DRIVER, CONSOLE, GUARD, RECEIVERS, SENTENCES, BOARDS)
OPTIONS_NAME = "options.json"
"""in the folder of the sockets: what a console that is started later needs"""


class GateOptions(PacedOptions):
    """What the gate is given: numbers only, so that it loads neither numpy nor the configuration's other sections."""

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
    sentences: str = ""
    """path to hand sentences to that come to the boards' port; empty: no receiver is on a board"""
    driver: str = ""
    """address of the driver of a stand-in that is a program of its own; empty: of this drive's own stand-in"""
    shadow: bool = False
    """actuators are only listened to"""

    @property
    def boards(self) -> dict[str, SteerBoardSettings]:
        """The boards that set points are sent to, by the bodies that they steer; none by a shadow."""
        given = {"tractor": self.tractor_board, "trailer": self.trailer_board}
        return {body: board for body, board in given.items() if board is not None and not self.shadow}

    @model_validator(mode="after")
    def _paces_stand_ins_only(self) -> Self:
        """Refuse to be faster than a machine that actuators outside of this computer may be part of."""
        lines = [board.transport for board in (self.tractor_board, self.trailer_board) if board is not None]
        lines += [self.isobus.bus] if self.isobus is not None else []
        if self.pace != 1 and not all(map(stays_here, lines)):
            raise ValueError(f"actuators that may be real ones are driven at pace 1, not {self.pace}")
        return self
