"""Command `drawbar tube`: compute, print and draw the tubes of a configuration."""

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.text import Text

from drawbar.config import Configuration
from drawbar.control.settings import ArticulatedControllerSettings, BodyTubeSettings, TricycleControllerSettings
from drawbar.control.tube.bodies import Body
from drawbar.control.tube.kept_rate import with_kept_rates
from drawbar.control.tube.tube import bodies_of, overdrawn_bounds, tube_of
from drawbar.errors import ConfigurationError
from drawbar.recording.log import read_log
from drawbar.report.tube.console import findings_text, proposal, tube_text
from drawbar.report.tube.page import write_page
from drawbar.report.tube.recorded import Recording, findings, recordings
from drawbar.step.build import operating_conditions
from drawbar.vehicle.parameters import BODIES


def show_tubes(console: Console, configuration: Configuration, out: Path, logs: Sequence[Path]) -> bool:
    """Print the tubes of both bodies, draw them into a folder, and hold recorded runs against them.

    Returns:
        Whether something is left of every bound.

    Raises:
        DrawbarError: the configuration has no tube, a log cannot be used, or the folder cannot be written.
    """
    declared, configuration = configuration.tube, _kept(configuration)
    bodies = dict(zip(BODIES, _bodies(configuration), strict=True))
    settings = {name: getattr(configuration.tube, name) for name in BODIES}
    tubes = {name: tube_of(name, body, settings[name], configuration.tube.nominal) for name, body in bodies.items()}
    recorded = _recorded(console, configuration, bodies, logs)
    console.print(Text(f"{configuration.name}, nominal state {configuration.tube.nominal}"))
    advice = {name: overdrawn_bounds(name, body, settings[name], tubes[name]) for name, body in bodies.items()}
    for name, tube in tubes.items():
        console.print(tube_text(name, tube, advice[name], _raised(name, getattr(declared, name), settings[name])))
    if logs:
        _compare(console, configuration, bodies, recorded)
    console.print(f"\n{write_page(out, configuration, tubes, advice, recorded)}", soft_wrap=True)
    return not any(advice.values())


def _recorded(
    console: Console, configuration: Configuration, bodies: dict[str, Body], logs: Sequence[Path]
) -> dict[str, list[Recording]]:
    """Return what logs hold of each body; print what of them is damaged or cut off."""
    recorded: dict[str, list[Recording]] = {name: [] for name in bodies}
    for file in logs:
        log = read_log(file)
        for shortcoming in log.shortcomings:
            console.print(Text(f"{file}: {shortcoming}", "bold yellow"), soft_wrap=True)
        for name, body in bodies.items():
            recorded[name] += recordings(file, log, configuration, name, body.model)
    return recorded


def _kept(configuration: Configuration) -> Configuration:
    """Return the configuration with the declared bounds that its control step is built from."""
    controller, conditions = _controller(configuration), operating_conditions(configuration)
    return configuration.model_copy(update={"tube": with_kept_rates(controller, conditions, configuration.tube)})


def _raised(name: str, declared: BodyTubeSettings, counted: BodyTubeSettings) -> str:
    """Return by how much the steering rate's disturbance counts as more than it is declared, "" where it does not."""
    before, now = (settings.disturbances.get("steering_rate", 0.0) for settings in (declared, counted))
    if now == before:
        return ""
    return (
        f"disturbances.steering_rate counts as {now:.3g} rad/s instead of {before:.3g}: less would not leave plans the "
        f"steering rate that tube.{name}.kept_rate = {declared.kept_rate:g} asks for."
    )


def _bodies(configuration: Configuration) -> tuple[Body, Body]:
    return bodies_of(_controller(configuration), operating_conditions(configuration), configuration.tube)


def _controller(configuration: Configuration) -> ArticulatedControllerSettings | TricycleControllerSettings:
    controller = configuration.controller
    if not isinstance(controller, ArticulatedControllerSettings | TricycleControllerSettings):
        raise ConfigurationError(
            f"{configuration.name}: controller.model = {controller.model!r} follows no nominal state and has no tube; "
            f"'articulated' and 'tricycle' have one"
        )
    return controller


def _compare(
    console: Console, configuration: Configuration, bodies: dict[str, Body], recorded: dict[str, list[Recording]]
) -> None:
    found = {name: findings(recorded[name], body, getattr(configuration.tube, name)) for name, body in bodies.items()}
    for name, of_body in found.items():
        console.print(findings_text(name, of_body))
    console.print("\nFor the configuration:\n", proposal(found), sep="\n")
