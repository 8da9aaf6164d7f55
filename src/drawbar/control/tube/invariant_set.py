"""Robust positively invariant sets: an outer approximation of the smallest one, known by its support function.

The smallest set that e+ = A e + w, w in W, never leaves is the sum of W, A W, A² W, ... (Kolmanovsky and Gilbert 1998).
Raković, Kerrigan, Kouramas and Mayne (2005) cut the sum after s terms and scale it up until it is invariant again, for
which W must have an interior. A sum of segments has none in general, so here the rest of the sum is enclosed instead:
in a norm in which A contracts by r < 1, and with |A^s w| <= q for all w in W, the ball T of radius q / (1 - r) holds
A T + A^s W. Hence W + A W + ... + A^(s-1) W + T is invariant, and larger than the smallest set by no more than T.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from drawbar.control.matrix_equations import solve_lyapunov, spectral_radius
from drawbar.control.tube.error_model import Source
from drawbar.geometry import Floats

Indices = NDArray[np.intp]

SLOWEST = 0.9995
"""Spectral radius from which on an error is taken not to decay: half of it is left after 1400 samples."""
_EXCESS = 1e-9
"""Size of the ball T beside the whole, along each coordinate."""
_BLOCK = 32
"""Terms of the sum between two looks at T."""
_NOTHING = 1e-30
"""Size of T along a coordinate that nothing disturbs, in its unit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InvariantSet:
    """A sum of sets, one for each source of disturbance; along some coordinates it may be unbounded."""

    sources: tuple[Source, ...]
    """j sources; their generators have b coordinates"""
    bounded: Indices
    """(b,): the coordinates, of n, along which the set is bounded"""
    powers: Floats
    """(s, b, b): A^0 .. A^(s-1) among the bounded coordinates"""
    ball: Floats
    """(b, b): M, where T is the unit ball times M times its radius"""
    radii: Floats
    """(j,): the part of each source in the radius of T"""

    @classmethod
    def of(cls, A: Floats, sources: Sequence[Source], bounded: Indices) -> Self:
        """Return the set that e+ = A e + w never leaves, for w in the sum of the sources.

        Args:
            A: (b, b), with a spectral radius below SLOWEST.
            sources: with generators of b coordinates.
            bounded: (b,) which coordinates of the whole error these are.
        """
        ball, contraction = _contracting_norm(A)
        inverse, lengths = np.linalg.inv(ball), np.linalg.norm(ball, axis=1)
        block = np.stack([np.linalg.matrix_power(A, k) for k in range(_BLOCK)])
        powers, extent, power = list[Floats](), np.zeros(len(A)), np.eye(len(A))
        while True:
            powers.append(block @ power)
            extent += sum(source.support(powers[-1]).sum(axis=0) for source in sources)
            power = block[-1] @ A @ power
            radii = np.array([_reach(source, inverse @ power) for source in sources]) / (1.0 - contraction)
            if np.all(radii.sum() * lengths <= _EXCESS * extent + _NOTHING):
                return cls(
                    sources=tuple(sources), bounded=bounded, powers=np.concatenate(powers), ball=ball, radii=radii
                )

    def contributions(self, directions: Floats) -> Floats:
        """Return what each source adds to the support in directions a (m, n): (m, j), infinite where unbounded."""
        inner = directions[:, self.bounded]
        images = np.einsum("mi,kij->mkj", inner, self.powers)
        sums = np.stack([source.support(images).sum(axis=1) for source in self.sources], axis=1)
        sums += np.linalg.norm(inner @ self.ball, axis=1)[:, None] * self.radii
        leaves = np.any(np.delete(directions, self.bounded, axis=1), axis=1, keepdims=True)
        return np.where(leaves, np.inf, sums)

    def support(self, directions: Floats) -> Floats:
        """Return max a·e over the set in directions a (m, n): (m,), infinite where the set is unbounded."""
        return np.asarray(self.contributions(directions).sum(axis=1))

    @property
    def excess(self) -> Floats:
        """By how much the set can be larger than the smallest one along each bounded coordinate: (b,)."""
        return np.asarray(self.radii.sum() * np.linalg.norm(self.ball, axis=1))


def _contracting_norm(A: Floats) -> tuple[Floats, float]:
    """Return M and r < 1 with |M^-1 A x| <= r |M^-1 x|: P = (M M^T)^-1 solves Lyapunov's equation for A / r."""
    factor = 0.5 * (1.0 + spectral_radius(A))
    P = solve_lyapunov(A.T / factor, np.eye(len(A)))
    return np.linalg.inv(np.linalg.cholesky(P)).T, factor


def _reach(source: Source, image: Floats) -> float:
    """Return a bound of |M^-1 A^s w| over the source's set, for the image M^-1 A^s."""
    segments = source.generators @ image.T
    return source.bound * float(np.linalg.norm(segments, axis=-1).sum(axis=-1).max())
