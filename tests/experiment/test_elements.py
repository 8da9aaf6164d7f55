"""Tables and pictures as files: the same bytes for the same content."""

import csv
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from drawbar.experiment.elements import Picture, Table, Text


def draw(figure: Figure) -> None:
    axes = figure.subplots()
    axes.plot(np.sin(np.arange(50.0)), label="sine")
    axes.set(xlabel="time, s", title="A title")
    axes.axvspan(3.0, 5.0)
    axes.legend()


def test_a_picture_is_the_same_file_again(tmp_path: Path) -> None:
    for name in ("a", "b"):
        Picture(name=name, caption="A picture.", draw=draw).write(tmp_path)
    first, second = ((tmp_path / f"{name}.svg").read_bytes() for name in ("a", "b"))
    assert first == second
    assert b"time, s</text>" in first
    assert b"<dc:date>" not in first


def test_a_table_is_markdown_and_csv(tmp_path: Path) -> None:
    table = Table(name="t", caption="Two rows.", header=["case", "cm"], rows=[["a|b", "1.0"], ['"c", d', "–"]])
    table.write(tmp_path)
    with (tmp_path / "t.csv").open(encoding="utf-8", newline="") as stream:
        assert list(csv.reader(stream)) == [["case", "cm"], ["a|b", "1.0"], ['"c", d', "–"]]
    text = table.markdown()
    assert text.startswith("Two rows. ([CSV](t.csv))\n\n| case | cm |\n| --- | --- |\n")
    assert "| a\\|b | 1.0 |" in text


def test_links_lead_to_the_folder_of_the_experiment(tmp_path: Path) -> None:
    assert Picture(name="p", caption="C.", draw=draw).markdown() == "![C.](p.svg)\n\n*C.*"
    Text(text="plain").write(tmp_path)
    assert Text(text="plain").markdown() == "plain"
    assert list(tmp_path.iterdir()) == []
