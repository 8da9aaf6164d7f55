"""Passwords: a file of users that only its owner can read, one line each: name, rank, salt and scrypt hash."""

import hashlib
import hmac
import os
import re
import secrets
import stat
from dataclasses import dataclass
from pathlib import Path

from drawbar.console.visitors import Rank
from drawbar.errors import ConfigurationError

SHORTEST = 10
"""characters of a password"""
LONGEST = 256
"""characters of a name or a password that are looked at"""
_COST, _BLOCK, _PARALLEL = 2**14, 8, 1  # 16 MiB and some 50 ms
_NAME = re.compile(r"[\w.-]{1,40}")


@dataclass(frozen=True, slots=True, kw_only=True)
class User:
    """One line of the file."""

    name: str
    rank: Rank
    salt: bytes
    digest: bytes


def load_users(path: Path) -> dict[str, User]:
    """Return all users of a file.

    Raises:
        ConfigurationError: the file cannot be read, others than its owner may, or a line is none.
    """
    try:
        mode, lines = path.stat().st_mode, path.read_text("utf-8").splitlines()
    except OSError as error:
        raise ConfigurationError(
            f"{path}: cannot be read ({error.strerror}); make it with drawbar console-user"
        ) from None
    except UnicodeDecodeError:
        raise ConfigurationError(f"{path}: is no text and so names no users; give another file") from None
    if stat.S_IMODE(mode) & 0o077:
        raise ConfigurationError(f"{path} has mode {stat.S_IMODE(mode):o}: others may read it; chmod 600 {path}")
    users = [_user(path, number, line) for number, line in enumerate(lines, 1) if line.strip()]
    if not users:
        raise ConfigurationError(f"{path} names no user; add one with drawbar console-user")
    return {user.name: user for user in users}


def _user(path: Path, number: int, line: str) -> User:
    try:
        name, rank, salt, digest = line.split()
        return User(name=name, rank=Rank[rank], salt=bytes.fromhex(salt), digest=bytes.fromhex(digest))
    except (ValueError, KeyError):
        raise ConfigurationError(
            f"{path}, line {number}: is not NAME RANK SALT HASH; remove it and use drawbar console-user"
        ) from None


def demand_name(name: str) -> None:
    """Refuse what cannot be a user's name.

    Raises:
        ConfigurationError: names what is allowed.
    """
    if not _NAME.fullmatch(name):
        raise ConfigurationError(f"user name {name!r}: 1 to 40 letters, digits, '.', '-' or '_' are allowed")


def save_user(path: Path, name: str, rank: Rank, password: str) -> None:
    """Add a user to a file, or replace it; a new file is readable by its owner alone.

    Raises:
        ConfigurationError: name or password is not allowed, or the file cannot be read or written.
    """
    demand_name(name)
    if not SHORTEST <= len(password) <= LONGEST:
        raise ConfigurationError(f"a password has {SHORTEST} to {LONGEST} characters; this one has {len(password)}")
    if any("\ud800" <= letter <= "\udfff" for letter in password):
        raise ConfigurationError("the password holds bytes that are no UTF-8 text; set the terminal to UTF-8")
    users = load_users(path) if path.exists() else {}
    salt = secrets.token_bytes(16)
    users[name] = User(name=name, rank=rank, salt=salt, digest=_digest(password, salt))
    text = "".join(f"{each.name} {each.rank.name} {each.salt.hex()} {each.digest.hex()}\n" for each in users.values())
    new = path.with_name(path.name + ".new")
    try:
        with os.fdopen(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "w", encoding="utf-8") as file:
            file.write(text)
        new.replace(path)
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be written ({error.strerror})") from None


def verify(users: dict[str, User], name: str, password: str) -> User | None:
    """Return the user whose name and password these are; None: nobody's. Takes as long for names that are unknown."""
    user = users.get(name[:LONGEST])
    digest = _digest(password[:LONGEST], user.salt if user is not None else bytes(16))
    return user if user is not None and hmac.compare_digest(digest, user.digest) else None


def _digest(password: str, salt: bytes) -> bytes:
    return hashlib.scrypt(password.encode(), salt=salt, n=_COST, r=_BLOCK, p=_PARALLEL, dklen=32)
