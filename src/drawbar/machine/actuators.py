"""Steering cylinders and hydrostatic drive as differential equations (paper, experimental set-up), and valves."""

import casadi as ca

from drawbar.machine.low_level.settings import ValveSettings
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


def valve_rates(
    settings: ValveSettings, motion: ca.SX, drive: ca.SX, *, full_rate: float | ca.SX, stop: float | ca.SX
) -> ca.SX:
    """Return d/dt of motion (2,) = angle (rad), rate (rad/s) of a cylinder behind a proportional valve.

    The drive, -1 to 1, opens the valve beyond its dead band; the oil follows with a lag. Its two sides may have other
    areas. At the mechanical stop only the way back is open.
    """
    angle, rate = motion[0], motion[1]
    left, right = settings.dead_band_left, settings.dead_band_right
    opening = ca.fmax(drive - left, 0.0) / (1.0 - left) - settings.slope_right * ca.fmax(-drive - right, 0.0) / (
        1.0 - right
    )
    blocked = ca.logic_and(ca.fabs(angle) >= stop, rate * angle > 0.0)
    return ca.vertcat(ca.if_else(blocked, 0.0, rate), (full_rate * opening - rate) / settings.lag)


def pedal_rates(settings: HydrostatSettings, drive: ca.SX, motor: ca.SX, resistance: ca.SX) -> ca.SX:
    """Return d/dt of drive (3,) = wheel speed (m/s), pedal, pedal speed (1/s) under the drive of the pedal's motor.

    Resistance is what a hill takes from the speed, m/s.
    """
    speed, pedal, pedal_speed = ca.vertsplit(drive)
    acceleration = (settings.full_speed * pedal - resistance - speed) / settings.speed_lag
    blocked = ca.logic_or(ca.logic_and(pedal >= 1.0, pedal_speed > 0.0), ca.logic_and(pedal <= 0.0, pedal_speed < 0.0))
    return ca.vertcat(
        acceleration,
        ca.if_else(blocked, 0.0, pedal_speed),
        (settings.pedal_rate * motor - pedal_speed) / settings.pedal_lag,
    )


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
