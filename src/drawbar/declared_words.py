"""Declared words: the text below each field of a class in its source, read when asked for, which costs no start."""

import ast
import inspect
import sys
from functools import cache
from itertools import pairwise


@cache
def _classes(module: str) -> dict[str, ast.ClassDef]:
    parsed = ast.parse(inspect.getsource(sys.modules[module]))
    return {node.name: node for node in parsed.body if isinstance(node, ast.ClassDef)}


def declared_words(kind: type) -> dict[str, str]:
    """Return what stands below each field or member of a class and of the classes that it inherits from.

    Args:
        kind: declared at the top of its module.
    """
    words: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        if base.__module__.startswith("drawbar"):
            words |= _below(_classes(base.__module__)[base.__name__])
    return words


def _below(declaration: ast.ClassDef) -> dict[str, str]:
    words = {}
    for node, below in pairwise(declaration.body):
        if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant):
            target = node.target if isinstance(node, ast.AnnAssign) else getattr(node, "targets", [None])[0]
            if isinstance(target, ast.Name):
                words[target.id] = " ".join(str(below.value.value).split())
    return words
