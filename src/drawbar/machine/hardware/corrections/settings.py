"""Settings of the corrections: which caster, how to log in, and where its bytes go."""

import re
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, field_validator, model_validator

from drawbar.errors import ConfigurationError
from drawbar.settings import Settings
from drawbar.transports.address import FileAddress, UdpAddress, parse_transport

_CREDENTIALS = r"(environment:[A-Za-z_][A-Za-z0-9_]*|file:.+)?"


class CorrectionsSettings(Settings):
    """Section `corrections`: an NTRIP caster. Credentials never stand here, only where they are."""

    model_config = ConfigDict(hide_input_in_errors=True)

    host: str
    """name or address of the caster"""
    port: Annotated[int, Field(ge=1, le=65535)] = 2101
    """of the caster; 2101 is usual, 443 with TLS"""
    mount: Annotated[str, Field(pattern=r"^[!-.0-~]+$")]
    """mount point, without slash"""
    version: Literal[1, 2] = 2
    """of NTRIP; 1 for casters that support no other"""
    tls: bool = False
    """encrypted; casters offer it on a port of its own, often 443 or 2102"""
    certificate: str = ""
    """PEM file that the caster's certificate is checked with; empty: the authorities that this computer trusts"""
    credentials: str = ""
    """`environment:NAME` or `file:PATH`, which hold user:password; empty: the caster asks for none"""
    upload: Annotated[float, Field(ge=10.0, le=60.0)] = 10.0
    """between uploads of the receiver's own position, s"""
    silence: Annotated[float, Field(ge=2.0, le=60.0)] = 10.0
    """without a byte, or without an intact frame, for so long: connect again, s"""
    forward: Annotated[tuple[str, ...], Field(strict=False)] = ()
    """transports that get the corrections, besides the receivers: boards by `udp://0.0.0.0:0?peer=ADDRESS:2233`"""

    @model_validator(mode="before")
    @classmethod
    def _no_credentials_here(cls, data: Any) -> Any:
        """Refuse before any other check would print what was given: it may be a password."""
        given = data if isinstance(data, dict) else {}
        host, credentials = given.get("host", ""), given.get("credentials", "")
        if not isinstance(host, str) or re.search(r"[@/\s]", host):
            raise ValueError(
                'has a host that is not a bare name or address; give host = "rtk.example.org", and port, mount and '
                "credentials by their own keys"
            )
        if not isinstance(credentials, str) or not re.fullmatch(_CREDENTIALS, credentials):
            raise ValueError(
                'has credentials that do not say where they are; give credentials = "environment:NAME" or "file:PATH", '
                "and write user:password there"
            )
        return data

    @field_validator("forward")
    @classmethod
    def _forward_to_transports(cls, forward: tuple[str, ...]) -> tuple[str, ...]:
        for text in forward:
            try:
                address = parse_transport(text)
            except ConfigurationError as refusal:
                raise ValueError(str(refusal)) from None
            if isinstance(address, FileAddress) or (isinstance(address, UdpAddress) and address.peer is None):
                raise ValueError(
                    f"{text} takes no bytes; give a serial line, a TCP server, or a UDP address with a peer"
                )
        return forward
