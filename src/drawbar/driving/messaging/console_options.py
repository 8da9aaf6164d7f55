"""Options of the console: what its process is given at its start, as JSON on its standard input."""

import ssl
import stat
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from drawbar.errors import ConfigurationError

LOOPBACK = ("127.0.0.1", "::1", "localhost")


class ConsoleOptions(BaseModel):
    """Where the drive is, and who may look at it from where."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    folder: str
    """of the drive's sockets"""
    configuration: str
    """the complete configuration of the drive, a TOML file"""
    stand_ins: bool = False
    """its devices are stand-ins, and nothing for another drive"""
    runs: str = "runs"
    """folder of earlier runs"""
    fields: str = "fields"
    """folder of the fields that are kept"""
    setup: str = "setup"
    """folder of the versions of the configuration that are saved"""
    host: str = "127.0.0.1"
    """address to listen at"""
    port: Annotated[int, Field(ge=0, le=65535)] = 8080
    """0: a free one"""
    names: tuple[str, ...] = ()
    """host names, besides `host`, under which browsers may ask for the pages"""
    language: Literal["en", "de"] = "en"
    """of a browser that asks for none of both"""
    certificate: str | None = None
    """of TLS, a PEM file"""
    key: str | None = None
    """of the certificate, a PEM file"""
    passwords: str | None = None
    """file of users; None: nobody is asked for a password"""
    audit: str | None = None
    """file to which is added who asked for what; None: none is kept"""

    @property
    def is_local(self) -> bool:
        """Whether only programs of this computer can reach it."""
        return self.host in LOOPBACK

    def check(self) -> None:
        """Raise ConfigurationError where others can reach the console without TLS and a password."""
        missing = [name for name in ("certificate", "key", "passwords") if getattr(self, name) is None]
        if not self.is_local and missing:
            raise ConfigurationError(
                f"the console is to listen at {self.host}, where other computers reach it, but without "
                f"{' and '.join(missing)}; give --certificate, --key and --passwords, or listen at 127.0.0.1"
            )
        if (self.certificate is None) != (self.key is None):
            raise ConfigurationError("TLS needs both --certificate and --key; give both or none")
        for name in ("certificate", "key", "passwords"):
            path = getattr(self, name)
            if path is not None and not Path(path).is_file():
                raise ConfigurationError(f"--{name} {path}: there is no such file")
        self._check_certificate()
        self._check_audit()

    def _check_audit(self) -> None:
        """Raise ConfigurationError where the audit log cannot be written."""
        try:
            if self.audit is not None:
                Path(self.audit).open("a").close()
        except OSError as error:
            raise ConfigurationError(
                f"--audit {self.audit}: cannot be written ({error.strerror}); give a file in a folder that is there"
            ) from error

    def _check_certificate(self) -> None:
        """Raise ConfigurationError where the certificate is none, or the key is not its own or not kept secret."""
        if self.certificate is None or self.key is None:
            return
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        try:
            context.load_cert_chain(self.certificate, self.key, password=lambda: b"")
        except (OSError, ValueError) as error:
            raise ConfigurationError(
                f"--certificate {self.certificate} and --key {self.key} are no certificate and its own key without a "
                f"passphrase, both PEM files ({error}); are they exchanged?"
            ) from error
        if Path(self.key).stat().st_mode & stat.S_IRWXO:
            raise ConfigurationError(f"--key {self.key}: everybody on this computer may read it; chmod 600 {self.key}")
