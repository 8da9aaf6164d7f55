"""drawbar: an autopilot that keeps a tractor and its trailer on the line.

What a program of one's own needs is offered here by name:

- `load_configuration`, `simulate`, `Simulation`, `Recorder`, `read_log`, `write_report`, `replay`: from a
  configuration to a run, its log and its report
- `Model`, `variables`, `ControlProblem`, `EstimationProblem`, `Bound`, `ControlSolver`, `EstimationSolver`: a system of
  one's own, estimated and controlled by the same compiled solvers
- `Machine`, `Autopilot`, `build_autopilot`, `drive`: the control step on a machine of one's own
- `Controller`: a controller of one's own in the place of the product's
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    __version__: str
    from drawbar.config import Configuration, load_configuration
    from drawbar.control.external import Controller
    from drawbar.machine.base import Machine
    from drawbar.optimal import Bound, ControlProblem, ControlSolver, EstimationProblem, EstimationSolver
    from drawbar.recompute import replay
    from drawbar.recording.log import RunLog, read_log
    from drawbar.recording.recorder import Recorder
    from drawbar.report.folder import write_report
    from drawbar.simulation import RunAborted, Simulation, drive, simulate
    from drawbar.step.autopilot import Autopilot
    from drawbar.step.build import build_autopilot
    from drawbar.vehicle.model import Model, variables

_PLACES = {
    "Autopilot": "step.autopilot",
    "Bound": "optimal",
    "Configuration": "config",
    "ControlProblem": "optimal",
    "ControlSolver": "optimal",
    "Controller": "control.external",
    "EstimationProblem": "optimal",
    "EstimationSolver": "optimal",
    "Machine": "machine.base",
    "Model": "vehicle.model",
    "Recorder": "recording.recorder",
    "RunAborted": "simulation",
    "RunLog": "recording.log",
    "Simulation": "simulation",
    "build_autopilot": "step.build",
    "drive": "simulation",
    "load_configuration": "config",
    "read_log": "recording.log",
    "replay": "recompute",
    "simulate": "simulation",
    "variables": "vehicle.model",
    "write_report": "report.folder",
}
"""where each name lives; its module is imported when it is asked for, since some take a second to load"""

__all__ = [
    "Autopilot",
    "Bound",
    "Configuration",
    "ControlProblem",
    "ControlSolver",
    "Controller",
    "EstimationProblem",
    "EstimationSolver",
    "Machine",
    "Model",
    "Recorder",
    "RunAborted",
    "RunLog",
    "Simulation",
    "build_autopilot",
    "drive",
    "load_configuration",
    "read_log",
    "replay",
    "simulate",
    "variables",
    "write_report",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version  # takes longer than all of this module

        value: Any = version("drawbar")
    elif name in _PLACES:
        value = getattr(import_module(f"drawbar.{_PLACES[name]}"), name)
    else:
        raise AttributeError(f"module 'drawbar' has no attribute {name!r}; it offers {', '.join(__all__)}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
