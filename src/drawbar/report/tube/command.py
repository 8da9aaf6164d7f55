"""Command `drawbar tube`: compute, print and draw the tubes of a configuration."""

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.text import Text

from drawbar.config import Configuration
from drawbar.control.settings import ArticulatedControllerSettings, TricycleControllerSettings
from drawbar.control.tube.bodies import Body, Work
from drawbar.control.tube.tube import bodies_of, overdrawn_bounds, tube_of
from drawbar.errors import ConfigurationError
from drawbar.report.tube.console import findings_text, proposal, tube_text
from drawbar.report.tube.page import write_page
from drawbar.report.tube.recorded import Recording, findings, recordings

BODIES = ("tractor", "trailer")


def show_tubes(console: Console, configuration: Configuration, out: Path, logs: Sequence[Path]) -> bool:
    """Print the tubes of both bodies, draw them into a folder, and hold recorded runs against them.

    Returns:
        Whether something is left of every bound.

    Raises:
        DrawbarError: the configuration has no tube, a log cannot be used, or the folder cannot be written.
    """
    bodies = dict(zip(BODIES, _bodies(configuration), strict=True))
    settings = {name: getattr(configuration.tube, name) for name in BODIES}
    tubes = {name: tube_of(name, body, settings[name], configuration.tube.nominal) for name, body in bodies.items()}
    console.print(Text(f"{configuration.name}, nominal state {configuration.tube.nominal}"))
    advice = {name: overdrawn_bounds(name, body, settings[name], tubes[name]) for name, body in bodies.items()}
    for name, tube in tubes.items():
        console.print(tube_text(name, tube, advice[name]))
    recorded = {name: recordings(logs, configuration, name, body) for name, body in bodies.items()}
    if logs:
        _compare(console, configuration, bodies, recorded)
    console.print(f"\n{write_page(out, configuration, tubes, advice, recorded)}", soft_wrap=True)
    return not any(advice.values())


def _bodies(configuration: Configuration) -> tuple[Body, Body]:
    controller = configuration.controller
    if not isinstance(controller, ArticulatedControllerSettings | TricycleControllerSettings):
        raise ConfigurationError(
            f"{configuration.name}: controller.model = {controller.model!r} follows no nominal state and has no tube; "
            f"'articulated' and 'tricycle' have one"
        )
    work = Work(
        vehicle=configuration.vehicle,
        ranges=configuration.tube.work,
        speed=configuration.speed,
        sample_time=configuration.sample_time,
    )
    return bodies_of(controller, work, configuration.tube)


def _compare(
    console: Console, configuration: Configuration, bodies: dict[str, Body], recorded: dict[str, list[Recording]]
) -> None:
    found = {name: findings(recorded[name], body, getattr(configuration.tube, name)) for name, body in bodies.items()}
    for name, of_body in found.items():
        console.print(findings_text(name, of_body))
    console.print("\nFor the configuration:\n", proposal(found), sep="\n")
