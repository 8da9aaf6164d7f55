"""Steering cylinders and hydrostatic drive as differential equations (paper, experimental set-up)."""

import casadi as ca

from drawbar.machine.settings import HydrostatSettings, PidGains


def steering_rate(angle: ca.SX, target: ca.SX, *, lag: float, rate: float, stop: float) -> ca.SX:
    """Return delta' of a PI-controlled steering, rad/s.

    A PI loop around a cylinder, with the set-point weight that cancels its zero and an integrator that
    rests while the valve is fully open, is a first-order lag up to the rate limit; that closed loop is what
    is simulated. At the mechanical stop only the way back is open.
    """
    wanted = _clip((target - angle) / lag, rate)
    blocked = ca.logic_and(ca.fabs(angle) >= stop, wanted * angle > 0.0)
    return ca.if_else(blocked, 0.0, wanted)


def hydrostat_rates(settings: HydrostatSettings, drive: ca.SX, target: ca.SX) -> ca.SX:
    """Return d/dt of drive (5,) = wheel speed (m/s), pedal, pedal speed (1/s), outer and inner integral."""
    speed, pedal, pedal_speed, speed_integral, pedal_integral = ca.vertsplit(drive)
    acceleration = (settings.full_speed * pedal - speed) / settings.speed_lag
    pedal_target, speed_error = _pid(settings.speed_loop, target - speed, acceleration, speed_integral, limit=1.0)
    motor, pedal_error = _pid(
        settings.pedal_loop, pedal_target - pedal, pedal_speed, pedal_integral, limit=settings.pedal_rate
    )
    return ca.vertcat(acceleration, pedal_speed, (motor - pedal_speed) / settings.pedal_lag, speed_error, pedal_error)


def _pid(gains: PidGains, error: ca.SX, rate: ca.SX, integral: ca.SX, *, limit: float) -> tuple[ca.SX, ca.SX]:
    """Return a PID's bounded output and the rate of its integral.

    What the bound cuts off is taken back from the integral, within the loop's own integral time, so that it
    does not wind up; unlike a switched-off integral this keeps the right-hand side continuous.
    """
    wanted = gains.proportional * error + gains.integral * integral - gains.derivative * rate
    output = _clip(wanted, limit)
    return output, error - (wanted - output) / gains.proportional


def _clip(value: ca.SX, limit: float) -> ca.SX:
    return ca.fmin(ca.fmax(value, -limit), limit)
