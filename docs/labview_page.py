"""Write docs/labview.md from the library's public headers: python docs/labview_page.py."""

import re
from importlib import resources
from pathlib import Path

PAGE = Path(__file__).with_name("labview.md")
PUBLIC = resources.files("drawbar.step").joinpath("public")
_NUMBERS = {"double": ("8-byte Double", "DBL"), "int32_t": ("Signed 32-bit Integer", "I32")}
"""C types: what the dialog calls them, and the terminal on the diagram"""
_HEAD = """\
# The library in LabVIEW

Every function of the library is a Call Library Function node on `drawbar.dll` (of
`drawbar export articulated --out library --target windows-x86_64`; 64-bit LabVIEW). This page, made from `drawbar.h` and
`drawbar_signals.h` by `python docs/labview_page.py`, has the parameters of each. On the page *Function* of its dialog: **Thread** "Run in any thread" (one state must not be used by two
calls at once: wire the nodes one after the other), **Calling convention** "C".

On the page *Parameters* the first entry, *return type*, and one entry for each parameter, in this order:

"""
_STATE = """
## The state

One array of DBL per vehicle, made once by *Initialize Array* with `drawbar_state_size() / 8` elements and kept in a
shift register. Each node takes it in and hands it on: wire the array through all nodes, and never branch the wire,
since LabVIEW would then copy it. Its content means nothing to anybody else.

## The path

The library keeps the pointer to the path's table, not a copy, and LabVIEW moves its arrays. So the table needs
memory that stays where it is:

1. Read the table of `drawbar path … --out path.csv` (or have `drawbar_line_path` make it of recorded points) as a
   2-D array of DBL, four columns (arc length, x, y, yaw), and *Reshape Array* to one dimension, row after row.
2. `DSNewPtr` (Call Library Function node on the library name `LabVIEW`, C): return type Numeric, Unsigned
   Pointer-sized Integer; `size`: Numeric, Unsigned Pointer-sized Integer, Value: 8 bytes times the number of
   elements.
3. `MoveBlock` (library `LabVIEW`, C): return type void; `source`: Array, 1 dimension, 8-byte Double, Array Data
   Pointer; `destination`: Numeric, Unsigned Pointer-sized Integer, Value; `size`: as above.
4. `drawbar_set_path` with that pointer and the number of rows. `DSDisposePtr` only after the run's end.

## Clusters

*Adapt to Type*, data format *Handles by Value*: a cluster without arrays and strings goes as a pointer to its
structure. The elements must have this order (*Reorder Controls In Cluster*) and these types. Angles are in rad,
lengths in m, times in s; a missing measurement is NaN. A new cluster is all zeros, and a zero is a measurement (a
deviation of zero: the fix is missing): set the elements of `drawbar_measurement` once to the values of
`DRAWBAR_NOTHING_MEASURED` (`drawbar_signals.h`) and *Make Current Values Default*.
"""
_END = """
## Every sample

`drawbar_feedback` with the measurement, then send the command to the actuators, then `drawbar_prepare`. The
returned I32 is the status: below 64 a new command, from 128 on the run has ended; `drawbar_status_text` has it in
words. The command may be sent whatever the status.

What is tested: that this page has every function and structure of the headers; the library itself on Windows by
`tests/export/emulators` (wine). No test runs LabVIEW.
"""


def page() -> str:
    """Return the page, Markdown."""
    functions = "".join(_function(*found) for found in _functions())
    used = dict.fromkeys(re.findall(r"struct (drawbar_\w+)", PUBLIC.joinpath("drawbar.h").read_text("utf-8")))
    names = [name for name in used if name not in ("drawbar_state", "drawbar_path_node")]
    return _HEAD + functions + _STATE + "".join(_cluster(name) for name in names) + _END


def _functions() -> list[tuple[str, str, str]]:
    """Return (type, name, parameters) of every public function."""
    text = PUBLIC.joinpath("drawbar.h").read_text("utf-8")
    return re.findall(r"^DRAWBAR_API ([^;(]*?)(\w+)\(([^)]*)\);", text, re.MULTILINE)


def _function(kind: str, name: str, parameters: str) -> str:
    returned = {"int": "Numeric, Signed 32-bit Integer", "int32_t": "Numeric, Signed 32-bit Integer"}
    rows = [("return type", returned.get(kind.strip(), "String, C String Pointer"))]
    rows += [_parameter(" ".join(each.split())) for each in parameters.split(",") if each.strip() != "void"]
    table = "".join(f"| {name} | {setting} |\n" for name, setting in rows)
    return f"**{name}**\n\n| parameter | setting |\n|---|---|\n{table}\n"


def _parameter(text: str) -> tuple[str, str]:
    """Return a parameter's name and settings; a KeyError says that LabVIEW has no words for it yet."""
    kind, _, name = text.removeprefix("const ").rpartition(" ")
    if not name.startswith("*"):
        words = _NUMBERS["int32_t" if kind == "int" else kind][0]
        return name, f"Numeric, {words}, pass Value"
    if kind == "struct drawbar_state":
        return name[1:], "Array, 8-byte Double, 1 dimension, Array Data Pointer"
    if kind == "struct drawbar_path_node":
        return name[1:], "Numeric, Unsigned Pointer-sized Integer, pass Value"
    return name[1:], f"Adapt to Type, Handles by Value: cluster `{kind.removeprefix('struct ')}`"


def _cluster(name: str) -> str:
    fields = ", ".join(_fields(name))
    return f"\n**{name}**: {fields}\n"


def _fields(name: str) -> list[str]:
    """Return a structure's elements with their types; inner structures are inner clusters."""
    text = PUBLIC.joinpath("drawbar_signals.h").read_text("utf-8")
    found = re.search(rf"^struct {name} {{\n(.*?)^}};", text, re.MULTILINE | re.DOTALL)
    assert found is not None, name
    members = re.findall(r"^    (struct \w+|\w+) (\w+);", found.group(1), re.MULTILINE)
    return [
        f"{member} (cluster: {', '.join(_fields(kind.removeprefix('struct ')))})"
        if kind.startswith("struct ")
        else f"{member} {_NUMBERS[kind][1]}"
        for kind, member in members
    ]


if __name__ == "__main__":
    PAGE.write_text(page(), "utf-8")
