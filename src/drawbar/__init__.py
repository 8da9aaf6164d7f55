"""drawbar: an autopilot that keeps a tractor and its trailer on the line.

What a program of one's own needs is offered here by name:

- `load_configuration`, `simulate`, `Simulation`, `Recorder`, `read_log`, `write_report`, `replay`: from a
  configuration to a run, its log and its report
- `Model`, `variables`, `ControlProblem`, `EstimationProblem`, `Bound`, `ControlSolver`, `EstimationSolver`: a system of
  one's own, estimated and controlled by the same compiled solvers
- `Machine`, `Measurement`, `FixQuality`, `Command`, `EndOfMeasurements`; for one in a computer `MachineWithTruth`,
  `Truth`, `Pose`: a machine of one's own
- `build_path`, `Path`, `build_autopilot`, `Autopilot`, `Status`, `drive`, `StepRecord`, `run_header`: the control step
  on it
- `Controller`: a controller of one's own in the place of the product's
- `DrawbarError`: what all of these raise for a user to read; `RunAborted`, `HardwareError`: of a machine and its run
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    __version__: str
    from drawbar.config import Configuration, load_configuration
    from drawbar.control.external import Controller
    from drawbar.errors import DrawbarError, HardwareError
    from drawbar.guidance.path import Path
    from drawbar.machine.base import EndOfMeasurements, Machine, MachineWithTruth
    from drawbar.optimal import Bound, ControlProblem, ControlSolver, EstimationProblem, EstimationSolver
    from drawbar.recompute import replay
    from drawbar.recording.header import run_header
    from drawbar.recording.log import RunLog, read_log
    from drawbar.recording.recorder import Recorder
    from drawbar.report.folder import write_report
    from drawbar.signals import Command, FixQuality, Measurement, Pose, Status, StepRecord, Truth
    from drawbar.simulation import RunAborted, Simulation, build_path, drive, simulate
    from drawbar.step.autopilot import Autopilot
    from drawbar.step.build import build_autopilot
    from drawbar.vehicle.model import Model, variables

_PLACES = {
    "Autopilot": "step.autopilot",
    "Bound": "optimal",
    "Command": "signals",
    "Configuration": "config",
    "ControlProblem": "optimal",
    "ControlSolver": "optimal",
    "Controller": "control.external",
    "DrawbarError": "errors",
    "EndOfMeasurements": "machine.base",
    "EstimationProblem": "optimal",
    "EstimationSolver": "optimal",
    "FixQuality": "signals",
    "HardwareError": "errors",
    "Machine": "machine.base",
    "MachineWithTruth": "machine.base",
    "Measurement": "signals",
    "Model": "vehicle.model",
    "Path": "guidance.path",
    "Pose": "signals",
    "Recorder": "recording.recorder",
    "RunAborted": "simulation",
    "RunLog": "recording.log",
    "Simulation": "simulation",
    "Status": "signals",
    "StepRecord": "signals",
    "Truth": "signals",
    "build_autopilot": "step.build",
    "build_path": "simulation",
    "drive": "simulation",
    "load_configuration": "config",
    "read_log": "recording.log",
    "replay": "recompute",
    "run_header": "recording.header",
    "simulate": "simulation",
    "variables": "vehicle.model",
    "write_report": "report.folder",
}
"""where each name lives; its module is imported when it is asked for, since some take a second to load"""

__all__ = [
    "Autopilot",
    "Bound",
    "Command",
    "Configuration",
    "ControlProblem",
    "ControlSolver",
    "Controller",
    "DrawbarError",
    "EndOfMeasurements",
    "EstimationProblem",
    "EstimationSolver",
    "FixQuality",
    "HardwareError",
    "Machine",
    "MachineWithTruth",
    "Measurement",
    "Model",
    "Path",
    "Pose",
    "Recorder",
    "RunAborted",
    "RunLog",
    "Simulation",
    "Status",
    "StepRecord",
    "Truth",
    "build_autopilot",
    "build_path",
    "drive",
    "load_configuration",
    "read_log",
    "replay",
    "run_header",
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
