"""The parts of an autopilot as units of a library."""

from drawbar.codegen.component import Component
from drawbar.control.decentralised import DecentralisedController
from drawbar.control.nominal import NominalController
from drawbar.errors import ConfigurationError
from drawbar.export.unit import Unit
from drawbar.optimal import ControlSolver, EstimationSolver
from drawbar.safety.supervisor import Supervisor
from drawbar.step.autopilot import Autopilot


def units_of(autopilot: Autopilot) -> list[Unit]:
    """Return the autopilot's parts, and the supervisor that watches a run of it.

    Raises:
        ConfigurationError: a component exists in simulation only.
    """
    parts: dict[str, object] = {
        "estimator": autopilot.estimator,
        "guidance": autopilot.guidance,
        **_controllers(autopilot.controller),
        "tractor_law": autopilot.tractor_law,
        "trailer_law": autopilot.trailer_law,
        "gate": autopilot.gate,
        "supervisor": Supervisor(),
    }
    if autopilot.predictor.component is not None:
        parts["predictor"] = autopilot.predictor
    return [_unit(name, component) for name, component in parts.items()]


def _controllers(controller: NominalController) -> dict[str, object]:
    if isinstance(controller, DecentralisedController):
        return {"tractor": controller.tractor, "trailer": controller.trailer}
    return {"controller": controller}


def _unit(name: str, owner: object) -> Unit:
    solver = getattr(owner, "solver", None)
    if isinstance(solver, ControlSolver | EstimationSolver):
        return Unit(name=name, source=solver.source, workspace=solver.workspace, has_solver=True)
    component = getattr(owner, "component", None)
    if isinstance(component, Component):
        return Unit(name=name, source=component.source, workspace=component, has_solver=False)
    raise ConfigurationError(
        f"The {name} of this configuration, {type(owner).__name__}, exists in simulation only and cannot be exported; "
        f'set {name}.model to another, for example "articulated".'
    )
