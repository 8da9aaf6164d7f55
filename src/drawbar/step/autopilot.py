"""One control step, in the order of the block diagram."""

from dataclasses import replace

from drawbar.control.ancillary import AncillaryLaw
from drawbar.control.nominal import NominalController
from drawbar.estimation.dead_time import DeadTimePredictor
from drawbar.estimation.estimator import Estimator
from drawbar.guidance.guidance import Guidance
from drawbar.machine.base import Machine
from drawbar.safety.gate import CommandGate
from drawbar.signals import Command, SolverStatus, StepRecord


class Autopilot:
    """Machine, estimator, dead-time predictor, guidance, controllers, ancillary laws and gate, wired together."""

    def __init__(
        self,
        *,
        machine: Machine,
        estimator: Estimator,
        predictor: DeadTimePredictor,
        guidance: Guidance,
        controller: NominalController,
        tractor_law: AncillaryLaw,
        trailer_law: AncillaryLaw,
        gate: CommandGate,
        speed: float,
        planned_speed: float,
    ) -> None:
        """Take the parts, the set speed and the least that plans reckon with, m/s.

        A plan takes the speed for constant. One that took that of a machine which has just started would be made for
        one that creeps, and steer too much too late.
        """
        self.machine = machine
        self.guidance = guidance
        self.estimator = estimator
        self.controller = controller
        self.predictor = predictor
        self.tractor_law, self.trailer_law = tractor_law, trailer_law
        self.gate = gate
        self.speed, self.planned_speed = speed, planned_speed
        self._step = 0

    def step(self) -> StepRecord:
        """Read, estimate, plan, command; then prepare for the next sample."""
        truth = self.machine.truth()
        measurement = self.machine.read()
        estimate = self.estimator.update(measurement)
        ahead = self.predictor.ahead(estimate)  # where the vehicle is when the next command begins to act
        ahead = replace(ahead, speed=max(ahead.speed, self.planned_speed))  # NaN stays NaN
        reference = self.guidance.reference(ahead)
        plan = self.controller.feedback(ahead, reference)
        tractor = self.tractor_law.apply(plan.tractor)
        trailer = self.trailer_law.apply(plan.trailer)
        wanted = Command(
            time=measurement.time,
            tractor_steering=tractor.command,
            trailer_steering=trailer.command,
            speed=self.speed,
        )
        command, verdict = self.gate.check(wanted)
        self.machine.write(command)
        acting = self.predictor.sent(command)
        self.estimator.prepare(acting)  # after actuation: the preparation phases cost no latency
        self.controller.prepare()
        outcomes = (estimate.status, plan.tractor.status, plan.trailer.status)
        tractor_times, trailer_times = self.controller.times
        self._step += 1
        return StepRecord(
            step=self._step - 1,
            measurement=measurement,
            estimate=estimate,
            reference=reference,
            plan=plan,
            tractor_steering=tractor,
            trailer_steering=trailer,
            command=command,
            truth=truth,
            estimator_times=self.estimator.times,
            tractor_times=tractor_times,
            trailer_times=trailer_times,
            solver_failures=sum(outcome is not SolverStatus.SOLVED for outcome in outcomes),
            gate=verdict,
        )
