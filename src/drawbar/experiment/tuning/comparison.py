"""Comparison of a search's result with the configuration's own values, on seeds that the search has not seen."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from drawbar.experiment.statistics import Statistic
from drawbar.experiment.tuning.study import Trial
from drawbar.experiment.tuning.trials import Objectives


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A trial with what it came to on the fresh seeds."""

    trial: Trial
    fresh: Objectives

    @property
    def error(self) -> Statistic:
        """In m."""
        return Statistic.of(list(self.fresh.error))

    @property
    def effort(self) -> Statistic:
        """In rad/s."""
        return Statistic.of(list(self.fresh.effort))


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """The front of a search and the configuration's own values."""

    own: Candidate
    front: Sequence[Candidate]
    """the least error first, by the search's seeds; own among them if no trial beats it"""

    def gain(self, candidate: Candidate) -> tuple[Statistic, Statistic]:
        """Return error (m) and effort (rad/s) of a candidate less own's, seed by seed: negative is better."""
        return (
            Statistic.of(list(candidate.fresh.error - self.own.fresh.error)),
            Statistic.of(list(candidate.fresh.effort - self.own.fresh.effort)),
        )

    def better(self) -> list[Candidate]:
        """Return those that beat own's values: no worse in either mean, better in one beyond its 95 % interval."""
        return [candidate for candidate in self._driven() if _beats(*self.gain(candidate))]

    def picks(self) -> dict[str, Candidate]:
        """Return, by what each is the best in, those that one would choose."""
        own = self.own
        found: dict[str, Callable[[Candidate], bool]] = {
            "least error": lambda _: True,
            "least error with no more steering": lambda one: one.effort.mean <= own.effort.mean,
        }
        picks = {
            title: min(filter(allowed, self._driven()), key=lambda one: one.error.mean)
            for title, allowed in found.items()
        }
        no_worse = (one for one in self._driven() if one.error.mean <= own.error.mean)
        return picks | {"least steering with no more error": min(no_worse, key=lambda one: one.effort.mean)}

    def _driven(self) -> list[Candidate]:
        """Return all that came to the end of the path with every seed, and own in any case."""
        others = [one for one in self.front if one.trial.number and not one.fresh.given_up]
        return [self.own, *others]


def _beats(error: Statistic, effort: Statistic) -> bool:
    no_worse = error.mean <= 0.0 and effort.mean <= 0.0
    return no_worse and (error.mean + error.half_width < 0.0 or effort.mean + effort.half_width < 0.0)
