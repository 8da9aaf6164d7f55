"""Alteration of a run beyond its configuration: a function of its experiment's own Python, applied before it begins."""

import ast
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drawbar.errors import ConfigurationError
from drawbar.machine.base import MachineWithTruth
from drawbar.signals import Command, Measurement, Truth
from drawbar.simulation import Simulation

if TYPE_CHECKING:
    from drawbar.experiment.trial import Trial

FILE_NAME, FOLDER_NAME = "alterations.py", "alterations"


@dataclass(frozen=True, slots=True, kw_only=True)
class Alteration:
    """A function of a Simulation, or of a Trial, as text: any worker can call it, and a task's key depends on it."""

    name: str
    source: str
    """of the whole file that defines it, Python"""

    def apply(self, run: "Simulation | Trial") -> None:
        """Change a run that has not begun, or, as its fault, a trial at the fault's place."""
        names: dict[str, Any] = {"__name__": "alterations"}
        exec(compile(self.source, FILE_NAME, "exec"), names)
        names[self.name](run)


@cache
def _functions(source: str) -> list[str]:
    return [each.name for each in ast.parse(source).body if isinstance(each, ast.FunctionDef)]


def find_alteration(folder: Path, name: str) -> Alteration:
    """Return a function of the alterations.py in an experiment's folder, or of one of the files of its alterations/.

    Raises:
        ConfigurationError: there is no such file, one is no Python, or none has such a function, or more than one has;
            lists those that there are.
    """
    files = sorted((folder / FOLDER_NAME).glob("*.py")) or [folder / FILE_NAME]
    place = files[0] if len(files) == 1 else folder / FOLDER_NAME
    public: list[str] = []
    sources: list[str] = []
    for file in files:
        try:
            source = file.read_text("utf-8")
            known = _functions(source)
        except (OSError, ValueError, SyntaxError) as error:
            raise ConfigurationError(f"{file}: alteration {name!r} cannot be read ({error}).") from error
        public += [each for each in known if not each.startswith("_")]
        sources += [source] if name in known else []
    if name not in public:
        raise ConfigurationError(f"{place}: has no function {name!r}; it has: {', '.join(public) or 'none'}.")
    if len(sources) > 1:
        raise ConfigurationError(f"{place}: {len(sources)} files have a function {name!r}; rename one.")
    return Alteration(name=name, source=sources[0])


class InterceptedMachine(MachineWithTruth):
    """A machine in a computer whose measurements pass through a function on their way to the autopilot."""

    def __init__(self, machine: MachineWithTruth, change: Callable[[Measurement], Measurement]) -> None:
        """Take a machine over, which is not used by itself again."""
        self._machine, self._change = machine, change

    def read(self) -> Measurement:
        """Return what the function makes of the next measurement."""
        return self._change(self._machine.read())

    def write(self, command: Command) -> None:
        """Pass the command on."""
        self._machine.write(command)

    def stop(self) -> None:
        """Stop the machine."""
        self._machine.stop()

    def close(self) -> None:
        """Close the machine."""
        self._machine.close()

    def truth(self) -> Truth:
        """Return the machine's truth."""
        return self._machine.truth()
