"""A controller of one's own: PID on both lateral errors, in the place of the product's.

drawbar run --set controller.model=pid_controller:PidController     (in this folder)
python pid_controller.py                                            drives it beside the product, and compares
"""

import math

from drawbar import Controller, load_configuration, simulate
from drawbar.report.metrics import compute_metrics
from drawbar.report.path_errors import true_path_errors


class PidController(Controller):
    """Tractor: curvature's steering, and PD on lateral and heading error. Trailer: PI on its lateral error."""

    integral = 0.0

    def command(self, estimate, reference):
        """Return both steering angles, rad."""
        tractor, trailer = reference.tractor, reference.trailer
        heading = math.remainder(estimate.tractor.yaw - tractor.closest[2], math.tau)
        feed_forward = math.atan(self.vehicle.wheelbase * tractor.samples[3, 3])  # the curvature 0.6 s ahead
        front = feed_forward - 0.9 * tractor.lateral_error - 1.2 * heading
        self.integral += 0.1 * trailer.lateral_error * self.sample_time
        return front, 0.8 * trailer.lateral_error + self.integral


if __name__ == "__main__":
    for model in ("pid_controller:PidController", "articulated"):
        log = simulate(load_configuration("articulated", [f"controller.model={model}", "path.radii=[10.0]"]))
        errors = compute_metrics(log, true_path_errors(log)).error_m
        means = {body: 100.0 * getattr(errors, body)["all"].mean for body in ("tractor", "trailer")}
        print(f"{model:32s}", *(f"{body} {mean:.1f} cm" for body, mean in means.items()))
