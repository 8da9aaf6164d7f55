"""The controllers and the ancillary law, each by itself."""

from collections.abc import Callable
from ctypes import byref, pointer
from functools import cached_property
from typing import Any, ClassVar

from alone import Alone, Solver
from c_signals import CBodyPlan, CBodyReference, CNeighbour, given, room, taken

from drawbar.codegen import Unit
from drawbar.control.ancillary import ancillary_unit
from drawbar.control.articulated import articulated_tractor_unit, articulated_trailer_unit
from drawbar.control.centralised_articulated import centralised_articulated_unit
from drawbar.control.centralised_tricycle import centralised_tricycle_unit
from drawbar.control.lqr import lqr_unit
from drawbar.control.pure_pursuit import pure_pursuit_unit
from drawbar.control.tricycle import tricycle_tractor_unit, tricycle_trailer_unit
from drawbar.control.tube.tube import SubsystemTube
from drawbar.signals import BodyPlan, BodyReference, BodySteering, Estimate, Plan, Reference
from drawbar.vehicle.parameters import VehicleParameters


class Controller(Alone):
    """What all have in common; a subclass names the function that makes its unit."""

    declare: ClassVar[Callable[..., Unit]]

    def __init__(self, vehicle: VehicleParameters, settings: Any, *others: Any) -> None:
        """Compile the controller; the arguments are those of its unit."""
        super().__init__(type(self).declare(vehicle, settings, *others))
        self.stages = settings.horizon

    @cached_property
    def solver(self) -> Solver:
        """Return its solver; those in closed form have none."""
        return Solver(self.live, self.unit.problem)

    def prepare(self) -> int:
        """Do what can be done before the next estimate."""
        return self.call("ready")

    def skip(self, samples: int = 1) -> int:
        """Let samples pass that were left out."""
        return self.call("skip", samples)


class SubsystemController(Controller):
    """The controller of one body."""

    def feedback(
        self, estimate: Estimate, reference: BodyReference, tractor: tuple[BodyReference, BodyPlan] | None = None
    ) -> BodyPlan:
        """Return the plan from the estimate along the reference; the trailer's coupling may need the tractor's own."""
        other = None
        if tractor is not None:
            other = byref(CNeighbour(pointer(CBodyReference.of(tractor[0])), pointer(CBodyPlan.of(tractor[1]))))
        plan = CBodyPlan()
        self.call("feedback", given(estimate), byref(CBodyReference.of(reference)), other, byref(plan), self.resources)
        return plan.read(self.stages)


class ArticulatedTractor(SubsystemController):
    declare = articulated_tractor_unit


class ArticulatedTrailer(SubsystemController):
    declare = articulated_trailer_unit


class TricycleTractor(SubsystemController):
    declare = tricycle_tractor_unit


class TricycleTrailer(SubsystemController):
    declare = tricycle_trailer_unit


class DecentralisedController:
    """Both bodies' controllers, in the order of the control step."""

    def __init__(self, tractor: SubsystemController, trailer: SubsystemController) -> None:
        """Join the controllers of the two bodies."""
        self.tractor, self.trailer = tractor, trailer

    def feedback(self, estimate: Estimate, reference: Reference) -> Plan:
        """Return both bodies' plans."""
        tractor = self.tractor.feedback(estimate, reference.tractor)
        trailer = self.trailer.feedback(estimate, reference.trailer, (reference.tractor, tractor))
        return Plan(time=estimate.time, tractor=tractor, trailer=trailer)

    def prepare(self) -> None:
        """Prepare both for the next sample."""
        self.tractor.prepare()
        self.trailer.prepare()


class VehicleController(Controller):
    """A controller of the whole vehicle."""

    def feedback(self, estimate: Estimate, reference: Reference) -> Plan:
        """Return both bodies' plans."""
        references = [byref(CBodyReference.of(body)) for body in (reference.tractor, reference.trailer)]
        tractor, trailer = CBodyPlan(), CBodyPlan()
        self.call("feedback", given(estimate), *references, byref(tractor), byref(trailer), self.resources)
        return Plan(time=estimate.time, tractor=tractor.read(self.stages), trailer=trailer.read(self.stages))


class CentralisedArticulated(VehicleController):
    declare = centralised_articulated_unit


class CentralisedTricycle(VehicleController):
    declare = centralised_tricycle_unit


class PurePursuit(VehicleController):
    declare = pure_pursuit_unit


class LinearQuadraticRegulator(VehicleController):
    declare = lqr_unit


class AncillaryLaw(Alone):
    """The law that holds one body to its nominal state."""

    def __init__(self, tube: SubsystemTube | None, limit: float) -> None:
        """Take gain and tube (None: no law), and the largest command, rad."""
        super().__init__(ancillary_unit("tractor_law", tube, limit))

    def apply(self, plan: BodyPlan) -> BodySteering:
        """Return the steering to command."""
        steering = room(BodySteering)
        self.call("apply", byref(CBodyPlan.of(plan)), steering)
        return taken(BodySteering, steering)


def settled(controller, situation, steps=30):
    """Return the last of several plans from the same situation: the real-time iteration at its fixed point."""
    for _ in range(steps):
        plan = controller.feedback(situation.estimate, situation.reference)
        controller.prepare()
    return plan


def first(controller, situation):
    return controller.feedback(situation.estimate, situation.reference)
