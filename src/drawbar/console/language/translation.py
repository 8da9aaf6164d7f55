"""Translation of a text that was written with values in it: found by its words, with the values taken over. Pure."""

import re
from collections.abc import Mapping

_NUMBER = re.compile(r"[-+]?\d+\.\d+")


class Translation:
    """Texts with `{}` for values, and what they are in another language, with `{0}`, `{1}` for these values."""

    def __init__(self, texts: Mapping[str, str]) -> None:
        """Take the texts."""
        keys = sorted(texts, key=lambda key: len(key.replace("{}", "")), reverse=True)  # the most words first
        self._patterns = [(_pattern(key), texts[key]) for key in keys]

    def __call__(self, text: str) -> str:
        """Return a text in the other language, line by line; a line that is not known stays as it is.

        Values are translated, too; numbers get decimal commas.
        """
        return "\n".join(self._line(line) for line in text.split("\n"))

    def _line(self, text: str) -> str:
        if _NUMBER.fullmatch(text):
            return text.replace(".", ",")
        for pattern, translated in self._patterns:
            if found := pattern.fullmatch(text):
                return translated.format(*(self._line(value) for value in found.groups()))
        return text


def _pattern(key: str) -> re.Pattern[str]:
    return re.compile("(.*?)".join(re.escape(part) for part in key.split("{}")))
