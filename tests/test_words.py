"""Words: modules and headers begin with the name of what they hold; replaced words are not used."""

import ast
import re
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "drawbar"
MODULES = {path.relative_to(SOURCE).as_posix(): path for path in sorted(SOURCE.rglob("*.py"))}
HEADERS = {path.relative_to(SOURCE).as_posix(): path for path in sorted(SOURCE.rglob("*.h"))}
LONGEST_NAME = 5
"""words before the colon, or from the beginning where no colon ends a name"""
QUESTIONS = {"what", "how", "where", "whether", "which", "when", "why", "who", "whose", "from", "by", "in", "on", "for"}
RETIRED = {"let[-_ ]go|lets[-_ ]go|letting[-_ ]go|lets? (the boards?|the steering|them) go": "release"}
"""what is not written any more, by words of the same meaning (docs/glossary.md)"""
DEFINED = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def words_of(text: str) -> list[str]:
    """Return the words of a text or an identifier, in lower case, articles left out."""
    words = re.findall(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])", text)
    return [word.lower() for word in words if word.lower() not in {"a", "an", "the"}]


def stem(word: str) -> str:
    """Return a word without its plural, at most five letters: `solvers`, `solver` and `solving` are one."""
    return re.sub(r"(?<=[a-z]{3})e?s$", "", word)[:5]


def stems(texts: Iterator[str] | list[str]) -> set[str]:
    return {stem(word) for text in texts for word in words_of(text)}


def name_in(text: str) -> list[str]:
    """Return the words with which a text names its thing: those before the first colon, if it is near."""
    before, colon, _ = text.partition(":")
    words = words_of(before)
    return words if colon and len(words) <= LONGEST_NAME else words[:3]


def flaw(text: str, file: str, defined: list[str], verbs: set[str]) -> str:
    """Return what is wrong with how a text begins that shall name its file or what it defines; or nothing."""
    name, names = name_in(text), stems([file, *defined])
    if not name:
        return "says nothing"
    if name[0] in QUESTIONS:
        return f"begins with the question or preposition {name[0]!r}"
    opening = re.sub(r"^\W*(?:(?:an?|the)\s+)?", "", text.lower()).split()[0]
    if {opening, opening.removesuffix("s")} & verbs and stem(opening) not in stems([file]):
        return f"begins with the verb {opening!r}"
    whole, initials = "".join(name), "".join(word[0] for word in name)
    if names & stems(name) or file.replace("_", "") in whole or file == initials:
        return ""
    return f"begins with {' '.join(name)!r}, which is neither the file's name nor anything that it defines"


def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text("utf-8"))


@pytest.fixture(scope="module")
def verbs() -> set[str]:
    """Return the words with which docstrings of functions begin: imperatives."""
    nodes = chain.from_iterable(ast.walk(parsed(path)) for path in MODULES.values())
    told = (ast.get_docstring(node) for node in nodes if isinstance(node, DEFINED[1:]))
    return {words_of(text)[0] for text in told if text and words_of(text)}


def file_name(path: Path) -> str:
    """Return the name of a module; that of a package or program is its folder's."""
    return path.parent.name if path.stem.startswith("__") else path.stem


@pytest.mark.parametrize("module", MODULES)
def test_module_begins_with_its_name(module: str, verbs: set[str]) -> None:
    tree = parsed(MODULES[module])
    defined = [node.name for node in tree.body if isinstance(node, DEFINED)]
    assert not flaw(ast.get_docstring(tree) or "", file_name(MODULES[module]), defined, verbs)


@pytest.mark.parametrize("header", HEADERS)
def test_header_begins_with_its_name(header: str, verbs: set[str]) -> None:
    text = HEADERS[header].read_text("utf-8")
    comment = re.search(r"/\*(.*?)\*/", text, re.DOTALL)
    defined = re.findall(r"(?:struct|enum|static|inline)\b[^;{=]*?(\w+)\s*[({]", text)
    assert comment
    assert not flaw(comment[1], HEADERS[header].stem, defined, verbs)


@pytest.mark.parametrize("retired", RETIRED)
def test_retired_word_is_not_used(retired: str) -> None:
    word = re.compile(rf"(?<![a-z])(?:{retired})(?![a-z])", re.IGNORECASE)
    places = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for folder in ("docs", "experiments", "src", "tests")
        for path in sorted((ROOT / folder).rglob("*"))
        if path.suffix in {".c", ".csv", ".h", ".md", ".py", ".toml"} and path != Path(__file__)
        for number, line in enumerate(path.read_text("utf-8").splitlines(), 1)
        if word.search(line)
    ]
    assert not places, f"the project's word is {RETIRED[retired]!r}"
