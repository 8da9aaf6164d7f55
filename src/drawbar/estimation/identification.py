"""Identification: dead times, lags and rates of both steerings from commands and measured angles (lag_bank.h)."""

import ctypes
from collections.abc import Iterable

from drawbar.codegen import Component, build
from drawbar.codegen.library import load
from drawbar.estimation.actuation import actuation_unit
from drawbar.estimation.actuation_settings import ActuationSettings
from drawbar.signals import Actuation, Command, Measurement
from drawbar.signals.layout import Layout
from drawbar.vehicle.parameters import VehicleParameters

_FOREVER = 1e6
"""time in which what was seen is forgotten, s"""


def identify(
    steps: Iterable[tuple[Measurement, Command]],
    vehicle: VehicleParameters,
    settings: ActuationSettings,
    sample_time: float,
) -> Actuation:
    """Return what a whole drive shows of both steerings; where it shows nothing, the guess that `settings` states.

    Args:
        steps: what was measured and then commanded at each sample, without a gap.
        vehicle: stated lag, rates and limits of the actuators.
        settings: of the search.
        sample_time: s.

    Raises:
        CompilerError: the component could not be compiled.
    """
    unit = actuation_unit(vehicle, settings.model_copy(update={"memory": _FOREVER}), sample_time)
    file = build(unit.name, {f"{unit.name}.c": unit.hosted_text()})
    component, library = Component(unit, file), load(file)
    own = ctypes.c_void_p(component.live.memory.ctypes.data)
    measurements, commands, reported = Layout(Measurement), Layout(Command), Layout(Actuation)
    measured, sent, found = measurements.buffer(), commands.buffer(), reported.buffer()
    for measurement, command in steps:
        measurements.pack(measured, measurement)
        library.drawbar_actuation_measured(own, measured)
        commands.pack(sent, command)
        library.drawbar_actuation_sent(own, sent)
    library.drawbar_actuation_report(own, found)
    actuation: Actuation = reported.unpack(found)
    return actuation
