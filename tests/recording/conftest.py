import pytest


@pytest.fixture
def every_step_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let steps that come fast wait for nothing before they reach the file."""
    monkeypatch.setattr("drawbar.recording.recorder._HELD_BACK", 0)
