"""`drawbar --version`: which drawbar this is, and with --verbose what it runs on."""

from drawbar import __version__


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

    return {
        "python": f"{platform.python_version()} ({sys.executable})",
        "platform": platform.platform(),
        "compiler": _compiler(),
        "cache": str(cache_folder()),
    }


def _compiler() -> str:
    from drawbar.codegen.compiler import find_compiler
    from drawbar.errors import CompilerError

    try:
        return " ".join(find_compiler())
    except CompilerError as error:
        return str(error)
