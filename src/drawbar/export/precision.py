"""Single precision: an exported library's text with `float` in the place of `double`.

The mathematics stay as they are. What changes besides the type of numbers: the tolerances that rounding sets, sine,
cosine and arctangent (lane_trigonometry_single.h), and which of the C library's functions are called. A time stamp
remains a double, as a float would lose milliseconds of it within hours, and so do the numbers in which a recorded line
is smoothed.
"""

import re
from collections.abc import Mapping, Sequence

from drawbar.codegen import Component, build
from drawbar.codegen.cache import runtime_sources
from drawbar.codegen.library import integer
from drawbar.export.memory import Memory

TOLERANCES = {
    "ACTIVE_ROUNDING": ("1e-10", "1e-5"),
    "CHECK_TOLERANCE": ("1e-8", "1e-3"),
    "DUAL_REGULARISATION": ("1e-12", "1e-6"),
    "FARKAS_EXACT": ("1e-11", "1e-5"),
    "FARKAS_ROUNDING": ("1e-9", "1e-4"),
    "GAP_TOLERANCE": ("1e-7", "1e-2"),
    "IP_TOLERANCE": ("1e-12", "1e-5"),
    "LARGEST_DUAL_REGULARISATION": ("1e-5", "1e-3"),
    "LDL_RAISED": ("1e-8", "1e-4"),
    "LDL_ROUNDING": ("1e-13", "1e-6"),
    "LINE_FARTHEST": ("1e7", "1e4"),
    "LINE_LONGEST": ("2e6", "1e4"),
    "LINE_REACHED": ("1e-13", "1e-5"),
    "LINE_SAME": ("1e-9", "1e-5"),
    "PACK": ("4", "1"),
    "PATH_CONVERGED": ("1e-6", "1e-3"),
    "PATH_FARTHEST": ("1e7", "1e4"),
    "PRIMAL_REGULARISATION": ("1e-8", "1e-4"),
    "QUAD": ("4", "1"),
    "REGULARISED_VIOLATION": ("1e-7", "1e-4"),
    "ROUNDING": ("1e-6", "1e-3"),
    "WHOLE_SAMPLES": ("1e-9", "1e-4"),
}
"""what a header defines, in double and in single precision; PACK and QUAD are how many doubles a register holds"""
LONGEST_WINDOW = 100
"""largest estimator.window in single precision: while a longer one fills, rounding over the stages that are not
measured yet leaves samples without a solution"""
_LARGEST, _SMALLEST = "3e38", "1.2e-38"
"""numbers that a float can still hold"""
_FUNCTIONS = (
    *("acos", "asin", "atan", "atan2", "ceil", "copysign", "cos", "exp", "expm1", "fabs", "floor", "fmax", "fmin"),
    *("fmod", "hypot", "log", "nextafter", "pow", "sin", "sqrt", "tan", "tanh"),
)
_WORDS = re.compile(r'(/\*.*?\*/|"[^"\n]*")', re.DOTALL)
"""comments and strings"""
_DOUBLE = re.compile(
    r"(?<!DRAWBAR_NOTHING_MEASURED \{ \\\n    \()"  # whose first number is the time
    r"\bdouble(?=_values\b|_settings\b|\b)(?! time\b| time_stamp\b| wide\b| memory\[)"
)
_FUNCTION = re.compile(rf"\b({'|'.join(_FUNCTIONS)})(?=\()")
_NUMBER = re.compile(r"(?<![\w.])(\d+\.\d*(?:[eE][-+]?\d+)?|\d+[eE][-+]?\d+)(?![\w.])")
_DEFINED = re.compile(rf"(?<=^#define )({'|'.join(TOLERANCES)}) (\S+)", re.MULTILINE)


def single(texts: Mapping[str, str]) -> dict[str, str]:
    """Return C sources and headers, by file name, in single precision."""
    own = {"lane_trigonometry.h": runtime_sources()["lane_trigonometry_single.h"]}
    return {name: own[name] if name in own else single_text(text) for name, text in texts.items()}


def single_text(text: str) -> str:
    """Return one C text in single precision."""
    pieces = _WORDS.split(_DEFINED.sub(_defined, text))
    pieces[::2] = map(_code, pieces[::2])
    return "".join(pieces)


def _defined(found: re.Match[str]) -> str:
    name, value = found.groups()
    double, instead = TOLERANCES[name]
    if value not in (double, instead):
        raise LookupError(f"{name} is {value}, no longer {double}: what is it in single precision?")
    return f"{name} {instead}"


def _code(text: str) -> str:
    text = _DOUBLE.sub("float", text).replace("DBL_", "FLT_")
    return _NUMBER.sub(_number, _FUNCTION.sub(r"\1f", text))


def _number(found: re.Match[str]) -> str:
    value = float(found[1])
    if value > float(_LARGEST):
        return f"{_LARGEST}f"
    return f"{_SMALLEST if 0.0 < value < float(_SMALLEST) else found[1]}f"


def single_memory(components: Sequence[Component], texts: Mapping[str, str]) -> Memory:
    """Return what components need in single precision, as this machine's compiler finds it.

    Args:
        components: of the control step.
        texts: of the library, in single precision, with headers that leave at least the room that is needed.

    Raises:
        CompilerError: no compiler, or it refused the code.
    """
    files = dict(texts)
    for component in components:
        name = component.name
        work = "sizeof(WORK)" if component.work_size else "0"
        files[f"{name}.c"] = (
            f"{texts[f'{name}.c']}\nint64_t drawbar_{name}_size = sizeof(struct component);\n"
            f"int64_t drawbar_{name}_work_size = {work};\n"
        )
    library = build("sizes", files, ("-std=c99", "-O0", "-fPIC", "-shared"))
    return Memory(
        components={each.name: integer(library, f"drawbar_{each.name}_size") for each in components},
        work=max(8, *(integer(library, f"drawbar_{each.name}_work_size") for each in components)),
    )
