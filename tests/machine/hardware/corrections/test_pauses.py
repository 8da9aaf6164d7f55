"""Pauses between attempts: as long as promised, and never so short that a caster bans us."""

from random import Random

import pytest

from drawbar.machine.hardware.corrections.pauses import Pauses


@pytest.mark.parametrize("seed", range(50))
def test_pauses_grow_and_never_invite_a_ban(seed: int) -> None:
    pauses = Pauses(Random(seed))
    found = [pauses.after_failure(refused=False) for _ in range(7)]
    for pause, nominal in zip(found, (1.0, 10.0, 20.0, 40.0, 60.0, 60.0, 60.0), strict=True):
        assert 0.8 * nominal <= pause <= 1.2 * nominal
    assert min(found[1:]) >= 10.0
    pauses.settled()
    assert pauses.after_failure(refused=False) <= 1.2
    assert 60.0 <= pauses.after_failure(refused=True) <= 72.0


def test_pauses_differ_between_machines() -> None:
    assert len({Pauses(Random(seed)).after_failure(refused=False) for seed in range(20)}) == 20
