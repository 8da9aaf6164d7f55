"""Every link and every file that the documentation names exists; headings that are linked to exist too."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from drawbar.config import load_configuration

ROOT = Path(__file__).parents[1]
DOCUMENTS = sorted(
    document.relative_to(ROOT).as_posix()
    for pattern in (
        "README.md",
        "CONTRIBUTING.md",
        "docs/*.md",
        "docs/theory/*.md",
        "experiments/README.md",
        "experiments/*/README.md",
    )
    for document in ROOT.glob(pattern)
)
SUFFIXES = "py|h|c|md|toml|html|svg|csv|json|txt"
FOLDERS = ("src", "tests", "docs", "examples", "experiments")
NOT_OURS = {
    *("config.toml", "metrics.json", "report.html", "map.svg", "tube.html", "path.csv", "measurements.csv"),
    *(
        "manifest.json",
        "include/drawbar.h",
        "include/drawbar_actuate.h",
        "include/drawbar_line.h",
        "src/",
        "lib/<target>/",
        "src/<component>.c",
        "example/main.c",
    ),
    *("example/path.csv", "step.c", "line.c", "path.c", "runs/", "library/", ".runs/", "NAME/.runs/", "CMakeLists.txt"),
    "build/reference/index.html",
    *("my.toml", "my.calibrated.toml"),
    *("ABLines.txt", "Boundary.txt", "CurveLines.txt", "FOLDER/config.toml", "zig/"),
}
"""written by a command, or an example of a user's own"""


def text_of(document: str) -> str:
    return (ROOT / document).read_text("utf-8")


def without_code(text: str) -> str:
    """Return the text without its blocks of code, in which brackets are no links."""
    return re.sub(r"```.*?```", "", text, flags=re.DOTALL)


def slug(heading: str) -> str:
    """Return the anchor that GitHub gives a heading."""
    kept = re.sub(r"[^\w\- ]", "", re.sub(r"[`$]|\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower())
    return kept.replace(" ", "-")


def anchors(document: Path) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", without_code(document.read_text("utf-8")), re.MULTILINE)
    return {slug(heading) for heading in headings}


def links(text: str) -> Iterator[str]:
    """Yield the targets of links and pictures that lie in the repository."""
    for target in re.findall(r"\]\(([^)\s]+)\)", without_code(text)):
        if not re.match(r"[a-z]+:", target):
            yield target


def named_files(text: str) -> Iterator[str]:
    """Yield the files and folders that are named as `code`, alone or within a command."""
    for span in re.findall(r"`([^`\n]+)`", without_code(text)):
        for word in span.split():
            if re.fullmatch(rf"[\w./<>-]+(?:\.(?:{SUFFIXES})|/)", word):
                yield word


@pytest.fixture(scope="module")
def present() -> set[str]:
    """Return every path of the repository's files and folders, and all that these may be shortened to."""
    files = [path.relative_to(ROOT) for folder in FOLDERS for path in (ROOT / folder).rglob("*")]
    files += [path.relative_to(ROOT) for path in ROOT.iterdir() if path.is_file()]
    whole = {path.as_posix() + ("/" if (ROOT / path).is_dir() else "") for path in (*files, *map(Path, FOLDERS))}
    return {"/".join(path.split("/")[start:]) for path in whole for start in range(path.count("/") + 1)}


@pytest.mark.parametrize("document", DOCUMENTS)
def test_every_link_leads_somewhere(document: str) -> None:
    for link in links(text_of(document)):
        target, _, anchor = link.partition("#")
        file = (ROOT / document).parent / target if target else ROOT / document
        assert file.exists(), f"{document} links to {link}"
        if anchor:
            assert anchor in anchors(file), f"{document} links to {link}"


@pytest.mark.parametrize("document", DOCUMENTS)
def test_every_file_that_is_named_exists(document: str, present: set[str]) -> None:
    missing = {name for name in named_files(text_of(document)) if name not in NOT_OURS and name not in present}
    assert not missing, f"{document} names {sorted(missing)}"


@pytest.mark.parametrize("document", DOCUMENTS)
def test_every_name_beside_a_source_file_stands_in_it(document: str) -> None:
    beside = re.findall(r"`([\w./]+\.(?:h|py))`\s+\(((?:`\w+`(?:,\s+)?)+)\)", text_of(document))
    sources = {file: [path.read_text("utf-8") for path in ROOT.rglob(f"src/**/{file}")] for file, _ in beside}
    missing = [
        (file, name)
        for file, names in beside
        for name in re.findall(r"\w+", names)
        if not any(re.search(rf"\b{name}\b", source) for source in sources[file])
    ]
    assert not missing, f"{document} names {missing}"


def test_the_index_lists_every_chapter() -> None:
    chapters = {path.name for path in (ROOT / "docs" / "theory").glob("*.md")} - {"README.md"}
    assert set(links(text_of("docs/theory/README.md"))) >= chapters


@pytest.mark.parametrize("document", [name for name in DOCUMENTS if name.startswith("docs/theory/")])
def test_equations_stand_beside_the_files_that_compute_them(document: str) -> None:
    for section in re.split(r"^(?=#)", text_of(document), flags=re.MULTILINE):
        assert "```math" not in section or "*Code:*" in section, f"{document}: {section.splitlines()[0]}"


def test_the_example_of_a_machine_is_a_configuration(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "driving.md").read_text("utf-8").split("```toml\n")[1].split("```")[0]
    (tmp_path / "my.toml").write_text(text, "utf-8")
    configuration = load_configuration(str(tmp_path / "my.toml"))
    assert configuration.devices is not None
    assert configuration.devices.sensors is not None
    assert configuration.devices.corrections is not None


def test_no_merge_has_left_its_marks() -> None:
    tracked = ("README.md", "CHANGELOG.md", "docs/**/*.md", "src/**/*", "tests/**/*", "experiments/**/*")
    files = {
        file
        for pattern in tracked
        for file in ROOT.glob(pattern)
        if file.suffix in {f".{s}" for s in SUFFIXES.split("|")}
    }
    marked = [file for file in files if file.is_file() and re.search(r"^<{7} |^>{7} ", file.read_text("utf-8"), re.M)]
    assert not marked
