"""Emitter of C99: prints a CasADi SX function for several stages at once, one stage per SIMD lane.

The shooting intervals are independent of each other, so the same straight-line arithmetic runs over arrays of
LANES values; the compiler turns each line into one vector instruction. Inputs are gathered from, and results
scattered to, time-major arrays. What depends on constants only is computed before the stages, and entries that do are
not computed but laid down once (emit_constants).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from drawbar.codegen.statements import Input, statements


@dataclass(frozen=True, slots=True, kw_only=True)
class Output:
    """A matrix result, stored row-major for each stage."""

    place: str
    """C expression of stage k's first element, e.g. `work->qp.A[k][0]`"""
    rows: str
    """C expression: stages that have this result"""
    value: ca.SX
    """(rows, columns) expressions"""
    stride: str = ""
    """C expression: numbers from one row to the next, where rows are padded with zeros to whole packs; empty: the
    number of columns"""

    def entries(self) -> list["_Entry"]:
        """Return every structural nonzero."""
        rows, columns = self.value.sparsity().get_triplet()
        return [_Entry(owner=self, row=i, column=j, value=self.value[i, j]) for i, j in zip(rows, columns, strict=True)]

    def at(self, row: int, column: int) -> str:
        """Return an entry's place as a C expression."""
        return f"({self.place})[{row} * {self.stride or self.value.shape[1]} + {column}]"

    def four(self, row: int, column: int) -> tuple[tuple[int, int], ...]:
        """Return the four entries of the pack that has this one; none where the pack reaches behind the matrix."""
        rows, columns = self.value.shape
        if self.stride:
            first = column - column % 4
            return tuple((row, first + i) for i in range(4))
        first = (row * columns + column) // 4 * 4
        return tuple(divmod(first + i, columns) for i in range(4)) if first + 4 <= rows * columns else ()


@dataclass(frozen=True, slots=True, kw_only=True)
class _Entry:
    owner: Output
    row: int
    column: int
    value: ca.SX
    """scalar"""

    @property
    def place(self) -> str:
        """Where it is stored, as a C expression."""
        return self.owner.at(self.row, self.column)


def emit_indices(names: Mapping[str, Sequence[str]]) -> str:
    """Return C enumerations of indices: what the elements of vectors are called, by the prefix of each vector."""
    listed = (", ".join(index_name(prefix, name) for name in elements) for prefix, elements in names.items())
    return "".join(f"enum {{ {each} }};\n" for each in listed if each)


def index_name(prefix: str, name: str) -> str:
    """Return what C calls the index of an element: X_SPEED, for one."""
    return f"{prefix}_{name.upper()}"


def emit_constants(name: str, inputs: list[Input], outputs: list[Output], arguments: str) -> str:
    """Return a C function that lays down, in every stage, the entries that are the same for all of them.

    Raises:
        ModelError: an entry is infinite or NaN.
    """
    same = _entries(inputs, outputs, varying=False)
    program = statements(inputs, [entry.value for entry in same])
    loops = []
    for output in outputs:
        lines = [
            f"{entry.place} = {result};"
            for entry, result in zip(same, program.results, strict=True)
            if entry.owner is output
        ]
        if lines:
            loops.append(f"    for (int k = 0; k < {output.rows}; ++k) {{\n        {_join(lines, 8)}\n    }}\n")
    return f"""static void {name}({arguments})
{{
    (void)work;
    {_join(program.once, 4)}
{"".join(loops)}}}
"""


def emit(name: str, inputs: list[Input], outputs: list[Output], arguments: str) -> str:
    """Return a C function `name(arguments, first, count)` that evaluates stages first .. count-1.

    What is the same for all stages is computed once, before them, and what is the same for all results is not among
    them: see emit_constants.

    Raises:
        ModelError: the expressions use an operation that the runtime does not have, or a constant that is not
            finite.
    """
    varying = _entries(inputs, outputs, varying=True)
    program = statements(inputs, [entry.value for entry in varying])
    return f"""
static void {name}({arguments}, int first, int count)
{{
    {_join(program.once, 4)}
    for (int base = first; base < count; base += LANES) {{
        double in[{max(len(program.gathered), 1)}][LANES], out[{max(len(varying), 1)}][LANES];
        const int lanes = count - base < LANES ? count - base : LANES;
        EACH_LANE (int lane = 0; lane < LANES; ++lane) {{
            const int k = base + (lane < lanes ? lane : lanes - 1);
            {_join(_gather(inputs, program.gathered), 12)}
        }}
        for (int lane = 0; lane < LANES; ++lane) {{
            {_join(program.lanes, 12)}
        }}
        for (int lane = 0; lane < lanes; ++lane) {{
            const int k = base + lane;
            {_join(_scatter(outputs, varying, _entries(inputs, outputs, varying=False)), 12)}
        }}
    }}
}}
"""


def _gather(inputs: list[Input], gathered: list[tuple[int, int]]) -> list[str]:
    """Return the lines that fetch one lane's numbers; beyond an input's last row that row is read again."""
    lines = []
    for index, (argument, element) in enumerate(gathered):
        source = inputs[argument]
        value = source.place.format(k=f"(k < {source.rows} ? k : {source.rows} - 1)", i=element)
        lines.append(f"in[{index}][lane] = {value};")
    return lines


def _scatter(outputs: list[Output], varying: list[_Entry], same: list[_Entry]) -> list[str]:
    """Return the lines that store one lane's results, in the rows that each output has."""
    blocks = []
    for output in outputs:
        results = {(each.row, each.column): f"out[{i}][lane]" for i, each in enumerate(varying) if each.owner is output}
        if results:
            lines = _stores(output, results, {(each.row, each.column) for each in same if each.owner is output})
            blocks.append(f"if (k < {output.rows}) {{\n                {_join(lines, 16)}\n            }}")
    return blocks


def _stores(output: Output, results: dict[tuple[int, int], str], same: set[tuple[int, int]]) -> list[str]:
    """Return the lines that store an output's results: a whole pack at once where it has no entry that is the same."""
    lines = []
    for four in dict.fromkeys(output.four(*place) for place in results):
        found = [place for place in four if place in results]
        if len(found) > 1 and same.isdisjoint(four):
            which = sum(1 << i for i, place in enumerate(four) if place in results)
            values = ", ".join(results.get(place, "0.0") for place in four)
            lines.append(f"write_four(&{output.at(*four[0])}, {which}, {values});")
            results = {place: result for place, result in results.items() if place not in found}
    return lines + [f"{output.at(*place)} = {result};" for place, result in results.items()]


def _join(lines: list[str], indent: int) -> str:
    return ("\n" + " " * indent).join(lines)


def _entries(inputs: list[Input], outputs: list[Output], *, varying: bool) -> list[_Entry]:
    """Return the outputs' entries that vary from stage to stage, or those that do not."""
    every = [entry for output in outputs for entry in output.entries()]
    staged = ca.vertcat(*(each.symbol for each in inputs if each.rows))
    depends = ca.which_depends(ca.vertcat(*(entry.value for entry in every)), staged, 1, True)
    return [entry for entry, varies in zip(every, depends, strict=True) if varies is varying]
