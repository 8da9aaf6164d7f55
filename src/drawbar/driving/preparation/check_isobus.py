"""Check of what is on an ISOBUS: its valves and its tractor, which are asked for nothing."""

import math
from collections.abc import Iterator

from drawbar.driving.devices.actuators import isobus_wire
from drawbar.driving.preparation.finding import MOST_SWINGS, OFF, STOP, Finding, poll_times
from drawbar.machine.hardware.isobus import IsobusSettings
from drawbar.protocols.actuator import Readiness
from drawbar.protocols.isobus.guidance import GuidanceValve
from drawbar.safety.wires import Wires

_SLOW = 1.0
"""limit of the speed, of which none is asked for, m/s"""
_TICK = 0.05
"""between two words to the bus, s"""


def check_isobus(settings: IsobusSettings, seconds: float, *, drives: bool) -> Iterator[Finding]:
    """Claim an address, send "not intended", and listen to the valves and to the tractor."""
    wire, now, tick = isobus_wire(settings, _SLOW if drives else None), 0.0, 0.0
    wires = Wires([wire])
    for now in poll_times(seconds):
        wires.receive()
        if now >= tick:
            tick = now + _TICK
            wires.send(now, (OFF, OFF), STOP)
    if wire.transport.trouble:
        problem = f"{wire.transport.trouble}: check the adapter, its bit rate and that its interface is up"
        yield Finding(device="ISOBUS", problems=[problem])
    if not wire.transport.connected:  # its devices cannot be distinguished
        wires.close()
        return
    valves = {"tractor valve": wire.tractor, "trailer valve": wire.trailer}
    for (name, valve), report in zip(valves.items(), wires.steering(now), strict=True):
        if report is not None:
            assert isinstance(valve, GuidanceValve)
            angle = [f"angle {math.degrees(report.angle):.1f}°"] if math.isfinite(report.angle) else []
            yield _on_the_bus(name, report.readiness, angle, list(_others(valve)))
    speed = wires.speed(now)
    if speed is not None:
        yield _on_the_bus("tractor's speed", speed.readiness, [], [])
    wires.close()


def _on_the_bus(name: str, readiness: Readiness, facts: list[str], others: list[str]) -> Finding:
    """Return what a device reports; others: what shows that there is another, which is not the device's own fault."""
    told = readiness is Readiness.READY or (bool(others) and readiness is Readiness.FAULT)
    received = readiness not in (Readiness.SILENT, Readiness.ADDRESS_LOST)
    return Finding(
        device=name,
        received=received,
        facts=[*facts, readiness.name.lower()] if received else [],
        problems=others if told else [readiness.value, *others],
    )


def _others(valve: GuidanceValve) -> Iterator[str]:
    """Yield what shows that another device is taken for the valve, or may be."""
    if valve.contested:
        yield "two devices claim its address, of which one must leave it: give each its own, or leave one off"
    if valve.swings.count > MOST_SWINGS:
        yield (
            f"its angle jumped away and back {valve.swings.count} times: two valves report from its address (leave one "
            "off and check again), or its sensor has a loose contact"
        )
    if valve.dropped.get("second valve"):
        yield "a second valve reports on this bus: write the address of the one that is meant"
