"""Next drive: its fields and configuration, as they are changed at the console."""

from collections.abc import Callable, Sequence
from pathlib import Path

from drawbar.config import Configuration, recorded_configuration
from drawbar.console.versions import Versions
from drawbar.errors import ConfigurationError
from drawbar.fields.store import FieldStore
from drawbar.geometry import LocalFrame


class NextDrive:
    """What is changed builds on the configuration of this drive, and then on what was saved last."""

    def __init__(
        self, configuration: Configuration, driven: Configuration, frame: LocalFrame, *, fields: Path, setup: Path
    ) -> None:
        """Take what is kept of the drive's configuration, all of it, its frame, and the folders."""
        self.configuration, self.driven, self.frame = configuration, driven, frame
        self.fields, self.versions = FieldStore(fields), Versions(setup)

    def changed(self, changes: Sequence[str]) -> Configuration:
        """Return the configuration with changes KEY=VALUE, checked; raises ConfigurationError with all flaws."""
        return recorded_configuration(self.configuration.to_toml(), changes, self.configuration.name)

    def save(self, configuration: Configuration, *, engaged: Callable[[], bool]) -> Path:
        """Keep a configuration as a new version; return its file.

        Raises:
            ConfigurationError: the vehicle is steered now.
            StorageError: it cannot be written.
        """
        if engaged():
            raise ConfigurationError("the vehicle is steered now; stop first, then save")
        file = self.versions.save(configuration)
        self.configuration = configuration
        return file
