"""XML from others: read without entities, which can blow up or fetch files; and written with a declaration."""

import re
from pathlib import Path
from xml.etree import ElementTree

from drawbar.errors import PathError
from drawbar.guidance.importers.text import read_text

Element = ElementTree.Element
_PROLOG = re.compile(r"(?:\s|<\?.*?\?>|<!--.*?-->)*", re.DOTALL)
"""what may stand before a document type, or before the root where there is none"""


def parse(path: Path) -> Element:
    """Return the root of a document, names without their namespace.

    Raises:
        PathError: it cannot be read, is not XML, or declares a document type, by which entities come in.
    """
    text = read_text(path).lstrip()
    if _PROLOG.sub("", text, count=1).startswith("<!"):
        raise PathError(
            f"{path}: declares a document type (DOCTYPE), which no such file needs; export it again without"
        )
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise PathError(f"{path}: is not XML: {error}; export it again") from None
    for each in root.iter():
        each.tag = each.tag.rpartition("}")[2]
    return root


def require_root(root: Element, name: str, path: Path, what: str) -> None:
    """Raise PathError for a document of another kind."""
    if root.tag != name:
        raise PathError(f"{path}: its root is <{root.tag}>; {what} has <{name}>")


def text_of(element: Element, tag: str) -> str:
    """Return the text of the first child of this name, without spaces around it; empty: there is none."""
    return (element.findtext(tag) or "").strip()


def write(root: Element) -> bytes:
    """Return a document."""
    ElementTree.indent(root)
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))


def attribute(element: Element, name: str, place: str) -> float:
    """Return a number; raises PathError with the place where there is none."""
    text = element.get(name, "")
    try:
        return float(text)
    except ValueError:
        raise PathError(f"{place}: {name} of <{element.tag}> is {text!r}; a number in degrees is needed") from None
