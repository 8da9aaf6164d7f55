"""Caster of the stand-in: the caster of a configuration's corrections, where they are to come from this computer."""

from drawbar.errors import HardwareError
from drawbar.machine.hardware.corrections.credentials import read_login
from drawbar.machine.hardware.corrections.settings import CorrectionsSettings
from drawbar.machine.stand_in.caster import Caster, CasterSettings, Dialect

_INTERVAL = 1.0
"""between two epochs, s of the machine's time"""
_DIALECTS = {1: Dialect.V1, 2: Dialect.V2_CHUNKED}


def stand_in_caster(settings: CorrectionsSettings, pace: int) -> Caster:
    """Return the caster, which listens: it asks for the configured login, and for a position before it sends.

    Raises:
        HardwareError: the port is taken, or a caster with TLS is asked for.
        ConfigurationError: the login is not where the configuration names it.
    """
    if settings.tls:
        raise HardwareError("the stand-in's caster has no certificate; set devices.corrections.tls=false")
    served = CasterSettings(
        interval=_INTERVAL / pace,
        mount=settings.mount,
        login=read_login(settings.credentials).text,
        dialect=_DIALECTS[settings.version],
        needs_position=True,
    )
    caster = Caster(
        served,
        address=("127.0.0.1" if settings.host == "localhost" else settings.host, settings.port),
    )
    try:
        caster.start()
    except OSError as error:
        raise HardwareError(
            f"the stand-in's caster cannot listen at {settings.host}:{settings.port} ({error.strerror}); "
            f"end the program that does"
        ) from None
    return caster
