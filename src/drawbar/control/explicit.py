"""Controllers in closed form, to compare with: a steering law for the tractor, a PI controller for the trailer."""

from collections.abc import Mapping

from numpy.typing import ArrayLike

from drawbar.codegen.component import Component
from drawbar.control.both_bodies import BothBodies
from drawbar.control.chain import chain_settings
from drawbar.control.nominal import NO_SOLVER, NominalController
from drawbar.control.settings import LqrSettings, PurePursuitSettings
from drawbar.signals import Estimate, Plan, Reference, SolveTimes
from drawbar.vehicle.parameters import VehicleParameters


class ExplicitController(NominalController):
    """Steers both bodies without a prediction; the plan says what would follow if the command were held.

    The predicted tractor rolls on at constant speed and curvature, the bicycle's; the predicted trailer is on its
    reference. The arithmetic is C, explicit.h, with the tractor's law in a header of its own.
    """

    def __init__(
        self,
        law: str,
        constants: Mapping[str, ArrayLike],
        vehicle: VehicleParameters,
        settings: PurePursuitSettings | LqrSettings,
        sample_time: float,
    ) -> None:
        """Compile the controller.

        Args:
            law: name of the header with the tractor's law.
            constants: what that law knows, by field.
            vehicle: lengths and limits.
            settings: horizon and the trailer's gains.
            sample_time: s.

        Raises:
            CompilerError: no compiler, or it refused the code.
        """
        self.component = Component(law, f'#define N {settings.horizon}\n#include "{law}.h"\n')
        self.component.write(constants)
        self.component.write(chain_settings(vehicle))
        self.component.write(
            {
                "trailer.proportional": settings.trailer.proportional,
                "trailer.integral": settings.trailer.integral,
                "trailer.interval": sample_time,
                "trailer.limit": vehicle.trailer_steering_limit,
                "interval": sample_time,
                "limit": vehicle.tractor_steering_limit,
                "joint_sign": vehicle.joint_sign,
            }
        )
        self._bodies = BothBodies(settings.horizon)
        self._feedback = self.component.function("feedback", pointers=6)

    def feedback(self, estimate: Estimate, reference: Reference) -> Plan:
        """Return both bodies' commands and what would follow from them."""
        self._bodies.write(estimate, reference)
        self._feedback(*self._bodies.given, *self._bodies.plans, self.component.work)
        return self._bodies.plan(estimate.time)

    def prepare(self) -> None:
        """Do nothing: the laws need no preparation."""

    @property
    def times(self) -> tuple[SolveTimes, SolveTimes]:
        """NaN: nothing is solved."""
        return NO_SOLVER, NO_SOLVER
