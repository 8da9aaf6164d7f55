"""`drawbar --version`: which drawbar this is, and with --verbose what it runs on."""

from collections.abc import Callable

from drawbar import __version__
from drawbar.errors import DrawbarError


def version_text(*, verbose: bool) -> str:
    """Return the version; if verbose, also Python, platform, C compiler and cache folder, a line each."""
    lines = [f"drawbar {__version__}"]
    if verbose:
        lines += [f"{name:<10}{value}" for name, value in _surroundings().items()]
    return "\n".join(lines)


def _surroundings() -> dict[str, str]:
    import platform
    import sys

    from drawbar.codegen.cache import cache_folder
    from drawbar.codegen.compiler import find_compiler

    return {
        "python": f"{platform.python_version()} ({sys.executable})",
        "platform": platform.platform(),
        "compiler": _answer_or_error(lambda: " ".join(find_compiler())),
        "cache": _answer_or_error(lambda: str(cache_folder())),
    }


def _answer_or_error(ask: Callable[[], str]) -> str:
    """Return an answer, or why there is none: one that is missing must not hide the others."""
    try:
        return ask()
    except DrawbarError as error:
        return str(error)
