"""A client of a caster that is closed in the end."""

from collections.abc import Callable, Iterator

import pytest
from caster_bench import Bench


@pytest.fixture
def connect() -> Iterator[Callable[..., Bench]]:
    """Return a function that makes a bench; its client is closed in the end."""
    benches: list[Bench] = []

    def connect(port: int, **settings: object) -> Bench:
        benches.append(Bench(port, **settings))
        return benches[-1]

    yield connect
    for bench in benches:
        bench.client.close()
