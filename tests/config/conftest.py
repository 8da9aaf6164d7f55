"""Configurations written into files."""

from pathlib import Path

import pytest
from configurations import Write


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def write(content: str | bytes) -> str:
        file = tmp_path / "mine.toml"
        file.write_bytes(content.encode() if isinstance(content, str) else content)
        return str(file)

    return write
