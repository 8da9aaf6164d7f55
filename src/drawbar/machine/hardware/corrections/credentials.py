"""The login of a caster: from an environment variable or a file that only its owner reads, and nowhere else."""

import os
import stat
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from drawbar.errors import ConfigurationError

LONGEST = 1024
"""of a file of credentials, bytes"""


@dataclass(frozen=True, slots=True)
class Login:
    """A user name and a password that show nowhere."""

    text: str = field(default="", repr=False)
    """`user:password`; empty: none"""


def read_login(source: str, environment: Mapping[str, str] = os.environ) -> Login:
    """Return the login from the place that `devices.corrections.credentials` names.

    Args:
        source: `environment:NAME`, `file:PATH`, or empty for a caster that asks for none.
        environment: variables.

    Raises:
        ConfigurationError: it is not there, or others may read it; names what to do, never what is in it.
    """
    kind, _, place = source.partition(":")
    if not source:
        return Login()
    if kind == "environment":
        return _checked(_from_environment(place, environment), f"the environment variable {place}")
    return _checked(_from_file(Path(place)), f"the file {place}")


def _from_environment(name: str, environment: Mapping[str, str]) -> str:
    if name not in environment:
        raise ConfigurationError(
            f"devices.corrections.credentials: the environment variable {name} is not set; set it to user:password"
        )
    return environment[name]


def _from_file(path: Path) -> str:
    """Return a file's text, after looking at the rights of the very file that is open."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    except OSError as error:
        raise ConfigurationError(
            f"devices.corrections.credentials: {path} cannot be read ({error.strerror}); write user:password into it"
        ) from None
    try:
        about = os.fstat(descriptor)
        if not stat.S_ISREG(about.st_mode):
            raise ConfigurationError(
                f"devices.corrections.credentials: {path} is no file; give one that holds user:password"
            )
        if about.st_mode & 0o077 or about.st_uid not in (os.geteuid(), 0):
            raise ConfigurationError(
                f"devices.corrections.credentials: {path} has the mode {stat.S_IMODE(about.st_mode):04o}, so that "
                f"others may read it, or belongs to somebody else; make it yours alone: chmod 600 {path}"
            )
        return os.read(descriptor, LONGEST + 1).decode("utf-8", "replace")
    finally:
        os.close(descriptor)


def _checked(text: str, where: str) -> Login:
    login = text.strip("\r\n")
    user, colon, _ = login.partition(":")
    if not (user and colon and len(login) <= LONGEST and login.isprintable() and "\ufffd" not in login):
        raise ConfigurationError(
            f"devices.corrections.credentials: {where} must hold one line, user:password, in UTF-8"
        )
    return Login(login)
