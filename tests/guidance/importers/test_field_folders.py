"""Field folders as they occur: older files of lines, boundaries, decimal commas, file names in either case."""

import os
from pathlib import Path

import numpy as np
import pytest

from drawbar.errors import PathError
from drawbar.guidance.importers.load import load_line

FIELD = "2020-May-02 08:41:36 PM\n$FieldDir\nHill\n$Offsets\n0,0\nConvergence\n0\nStartFix\n50.8,4.7\n"
GERMAN_FIELD = FIELD.replace("50.8,4.7", "40,71280000,-74,00600000")
STRAIGHTS = "AB 80°,79.95161324,-208.652,90.491\nAB 0°,0,10,20\n"
CURVES = "$CurveLines\nCu 45°\n0.785\n3\n0,0,0.785\n1.5,1.5,0.785\n3,3,0.785\n"
SQUARE = "$Boundary\nFalse\n4\n-100,-50,0\n100,-50,0\n100,150,0\n-100,150,0\n"


def folder(at: Path, **files: str) -> Path:
    (at / "Field.txt").write_text(FIELD, "utf-8")
    for name, text in files.items():
        (at / f"{name}.txt").write_text(text, "utf-8")
    return at


def test_straight_line_without_boundary_goes_on_as_far_as_the_user_says(tmp_path: Path) -> None:
    field = folder(tmp_path, ABLines=STRAIGHTS)
    line = load_line(field, "AB 80°")
    ahead = np.array([np.sin(np.radians(79.95161324)), np.cos(np.radians(79.95161324))])
    np.testing.assert_allclose(
        np.column_stack([line.x, line.y]), [[-208.652, 90.491], [-208.652, 90.491] + 101 * ahead], atol=0.01
    )  # AgOpenGPS's plane is that far off at 200 m
    line = load_line(field, "AB 0°", 30.0)
    np.testing.assert_allclose([line.x, line.y], [[10.0, 10.0], [20.0, 51.0]], atol=0.01)


def test_straight_line_goes_from_boundary_to_boundary(tmp_path: Path) -> None:
    field = folder(tmp_path, ABLines=STRAIGHTS, Boundary=SQUARE)
    line = load_line(field, "AB 0°")
    np.testing.assert_allclose([line.x, line.y], [[10.0, 10.0], [-50.0, 150.0]], atol=0.01)
    assert load_line(field, "AB 0°", 30.0).y[-1] == pytest.approx(51.0, abs=0.01)


def test_boundary_of_several_pieces_gives_the_one_with_the_point(tmp_path: Path) -> None:
    """A field like a U: the line north of it crosses both arms."""
    arms = "$Boundary\nFalse\n8\n" + "".join(
        f"{x},{y},0\n" for x, y in [(0, 0), (90, 0), (90, 50), (60, 50), (60, 10), (30, 10), (30, 50), (0, 50)]
    )
    field = folder(tmp_path, ABLines="west,90,10,30\neast,90,70,30\nbetween,90,50,30\noutside,90,0,99\n", Boundary=arms)
    for name, ends in {"west": [0, 30], "east": [60, 90], "between": [60, 90]}.items():
        np.testing.assert_allclose(load_line(field, name).x, ends, atol=0.01)
    with pytest.raises(PathError, match=r"ABLines\.txt:4: the line does not cross the field .*path\.extension"):
        load_line(field, "outside")


def test_boundary_with_a_point_that_is_none_is_refused(tmp_path: Path) -> None:
    field = folder(tmp_path, ABLines=STRAIGHTS, Boundary=SQUARE.replace("\n100,-50,0", "\n100,nan,0"))
    with pytest.raises(PathError, match=r"Boundary\.txt:5: is '100,nan,0'; finite coordinates"):
        load_line(field, "AB 0°")


@pytest.mark.parametrize("count", ["nan", "inf", "4.5"])
def test_boundary_announces_a_whole_number_of_points(tmp_path: Path, count: str) -> None:
    field = folder(tmp_path, ABLines=STRAIGHTS, Boundary=SQUARE.replace("4\n", f"{count}\n", 1))
    with pytest.raises(PathError, match=rf"Boundary\.txt:3: announces {count} points; a whole number"):
        load_line(field, "AB 0°")


@pytest.mark.skipif(os.name == "nt", reason="POSIX links")
def test_a_link_to_nothing_is_no_file(tmp_path: Path) -> None:
    field = folder(tmp_path, ABLines=STRAIGHTS)
    (field / "CurveLines.txt").symlink_to("nowhere.txt")
    assert load_line(field, "AB 0°").name == "AB 0°"


def test_curves_of_older_versions_are_read(tmp_path: Path) -> None:
    line = load_line(folder(tmp_path, CurveLines=CURVES), None)
    assert line.name == "Cu 45°"
    np.testing.assert_allclose(line.x, [0.0, 1.5, 3.0], atol=1e-4)


def test_all_files_are_read_and_what_an_older_one_repeats_is_one_line(tmp_path: Path) -> None:
    tracks = "$TrackLines\nCu 45°\n0.785\n0,0\n3,3\n0\n4\nTrue\n2\n0,0,0\n9,9,0\n"
    field = folder(tmp_path, TrackLines=tracks, ABLines=STRAIGHTS, CurveLines=CURVES)
    with pytest.raises(PathError, match="'Cu 45°', 'AB 80°', 'AB 0°'; choose one"):
        load_line(field, None)
    assert load_line(field, "Cu 45°").x[-1] == pytest.approx(9.0, abs=1e-4)
    assert load_line(field / "ABLines.txt", "AB 0°").name == "AB 0°"


def test_empty_files_are_no_lines_and_all_is_reported(tmp_path: Path) -> None:
    field = folder(tmp_path, TrackLines="$TrackLines\n", ABLines="")
    reason = "holds no line: TrackLines.txt has none; ABLines.txt has none; CurveLines.txt is not there"
    with pytest.raises(PathError, match=reason):
        load_line(field, None)


def test_decimal_commas_are_read_where_they_leave_no_doubt(tmp_path: Path) -> None:
    curve = "$CurveLines\nCu 45,5°\n0,785\n3\n0,0,0,0,0,785\n1,5,1,5,0,785\n3,0,-3,5,0,785\n"
    field = folder(tmp_path, CurveLines=curve, ABLines="AB 80,5°,79,95161324,-208,652,90,491\n", Boundary="$Boundary\n")
    (field / "Field.txt").write_text(GERMAN_FIELD, "utf-8")
    np.testing.assert_allclose(load_line(field, "Cu 45,5°").y, [0.0, 1.5, -3.5], atol=1e-4)
    line = load_line(field, "AB 80,5°")
    assert (line.x[0], line.y[0]) == pytest.approx((-208.652, 90.491), abs=0.01)


@pytest.mark.parametrize("row", ["AB,80.5,-208.652", "AB 1,80,-208,652,90,491", "AB", "AB,x,1.5,2.5"])
def test_a_straight_line_that_leaves_doubt_is_refused_with_its_row(tmp_path: Path, row: str) -> None:
    with pytest.raises(PathError, match=r"ABLines\.txt:1: "):
        load_line(folder(tmp_path, ABLines=row + "\n"), None)


def test_file_names_in_either_case(tmp_path: Path) -> None:
    field = folder(tmp_path, TRACKLINES="$TrackLines\n", ablines=STRAIGHTS, BOUNDARY=SQUARE)
    (field / "Field.txt").rename(field / "FIELD.TXT")
    (field / "TRACKLINES.txt").rename(field / "TrackLines.TXT")
    np.testing.assert_allclose(load_line(field, "AB 0°").y, [-50.0, 150.0], atol=0.01)
    assert load_line(field / "ablines.txt", "AB 0°").name == "AB 0°"
