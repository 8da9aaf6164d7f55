"""The configurations that come with drawbar: one TOML file each, known by its name. Imports nothing heavy."""

from importlib import resources

CONFIGURATION_NAME = "config.toml"
"""file of a run's folder that holds its configuration"""


def shipped_names() -> list[str]:
    """Return the names of the shipped configurations, sorted."""
    files = (file.name for file in resources.files(__name__).iterdir())
    return sorted(name.removesuffix(".toml") for name in files if name.endswith(".toml"))


def shipped_text(name: str) -> str:
    """Return the TOML text of a shipped configuration."""
    return (resources.files(__name__) / f"{name}.toml").read_text("utf-8")
