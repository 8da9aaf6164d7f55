"""What `drawbar bench` writes is known to be writable before it measures."""

import pytest
from rich.console import Console

from drawbar.benchmark import bench
from drawbar.errors import DrawbarError


def test_a_file_that_cannot_be_written_is_refused_before_anything_is_measured(tmp_path, monkeypatch):
    class Measured(Exception):  # noqa: N818
        pass

    def measure(*_, **__):
        raise Measured

    monkeypatch.setattr(bench, "measure", measure)
    monkeypatch.setattr(bench, "one_core", lambda: None)
    for wrong in (tmp_path / "none" / "x.json", tmp_path):
        with pytest.raises(DrawbarError, match=r"cannot be written .*choose another --json file"):
            bench.run_benchmark(Console(), wrong)
    kept = tmp_path / "kept.json"
    kept.write_text("before")
    for file in (kept, tmp_path / "new.json"):
        with pytest.raises(Measured):
            bench.run_benchmark(Console(), file)
    assert [(each.name, each.read_text()) for each in tmp_path.iterdir()] == [("kept.json", "before")]
