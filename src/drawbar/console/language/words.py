"""Words: the texts of the pages in one language."""

from typing import Literal

from drawbar.console.language.catalogue import TEXTS
from drawbar.console.language.causes_de import CAUSES_DE
from drawbar.console.language.errors_de import ERRORS_DE
from drawbar.console.language.signal_words import signal_words
from drawbar.console.language.statuses_de import STATUSES_DE
from drawbar.console.language.translation import Translation
from drawbar.safety.causes import Cause
from drawbar.statuses import Status

Language = Literal["en", "de"]
_ACTUATORS = ("front_wheels", "joint", "speed_actuator")
"""names of their texts, by their bits in GateState.engaged"""
_ERRORS = Translation(ERRORS_DE)


class Words:
    """The texts in one language."""

    def __init__(self, language: Language) -> None:
        """Choose the language."""
        self.language: Language = language

    def __call__(self, key: str, **values: object) -> str:
        """Return a text with its values in it."""
        return TEXTS[key][self.language == "de"].format(**values)

    def cause(self, cause: Cause) -> tuple[str, str]:
        """Return a cause's text, and what to do about it, as sentences that begin with a capital letter."""
        sentence, advice = CAUSES_DE[cause] if self.language == "de" else (cause.sentence, cause.advice)
        return sentence[:1].upper() + sentence[1:], advice[:1].upper() + advice[1:]

    def led(self, cause: Cause, status: Status | None) -> str:
        """Return a cause's text; of the end of the controller's run why it ended, by its status; None: not known."""
        sentence, _ = self.cause(cause)
        if cause is not Cause.CONTROLLER_STOPS or status is None or not status.has_ended:
            return sentence
        text = STATUSES_DE[status] if self.language == "de" else status.text.removeprefix("stopped: ")
        return text[:1].upper() + text[1:]

    def of_actuators(self, bits: int) -> str:
        """Return which actuators something is of, by bits of GateState.engaged, to be put behind it."""
        names = [self(key) for bit, key in enumerate(_ACTUATORS) if bits >> bit & 1]
        return f": {', '.join(names)}" if names else ""

    def signal(self, name: str) -> str:
        """Return what a signal of a control step is called, with its unit."""
        return signal_words(name, self.language == "de")

    def message(self, text: object) -> str:
        """Return an error, or what was refused, as people read it; one that has no German text stays English."""
        return _ERRORS(str(text)) if self.language == "de" else str(text)

    def number(self, value: float, decimals: int) -> str:
        """Return a number as people write it."""
        return self.decimal(f"{value:z.{decimals}f}")

    def decimal(self, text: str) -> str:
        """Return numbers with the decimal sign of the language."""
        return text.replace(".", ",") if self.language == "de" else text


def language_of(accepted: str, otherwise: Language) -> Language:
    """Return the language that a browser asks for first, of those that there are (header Accept-Language)."""
    for each in accepted.lower().split(","):
        if each.strip()[:2] in ("en", "de"):
            return "de" if each.strip().startswith("de") else "en"
    return otherwise
