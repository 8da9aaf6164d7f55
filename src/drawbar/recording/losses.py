"""Losses: which steps of a log are lost where its file is damaged, or by their numbers."""

from drawbar.recording.frames import Damage


class Losses:
    """Collects what was lost, in sentences, while the steps of a log are read in turn."""

    def __init__(self) -> None:
        """Begin before the first step."""
        self.texts: list[str] = []
        self._last, self._open, self._is_over = -1, list[Damage](), False

    def add(self, damage: Damage) -> None:
        """Take in bytes that are damaged; that some are missing is news only where nothing is reported yet."""
        if damage.begin < damage.end or not self.texts:
            self._open.append(damage)

    def see(self, step: int) -> None:
        """Take in that a step was read."""
        first, last = self._last + 1, step - 1
        lost = f"step {first} is lost" if first == last else f"steps {first} to {last} are lost"
        if self._open:
            self._say(lost if first <= last else "no step is lost" if first == step else "steps may be lost")
        elif first <= last:
            self.texts.append(lost)
        self._last = step

    def end(self) -> None:
        """Take in that no step follows: the outcome was read, or the log ends."""
        if self._open:
            self._say(self._behind())
        self._is_over = True

    def _behind(self) -> str:
        """Return what is lost by damage that no step follows."""
        if self._is_over:
            return "no step is lost" if all(damage.begin < damage.end for damage in self._open) else "steps may be lost"
        return f"what came after step {self._last} is lost" if self._last >= 0 else "no step is left"

    def _say(self, lost: str) -> None:
        self.texts.append(f"{'; '.join(map(str, self._open))}: {lost}")
        self._open.clear()
