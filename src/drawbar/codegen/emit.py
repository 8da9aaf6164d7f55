"""Emitter of C99: prints a CasADi SX function for several stages at once, one stage per SIMD lane.

The shooting intervals are independent of each other, so the same straight-line arithmetic runs over arrays of
LANES values; the compiler turns each line into one vector instruction. Inputs are gathered from, and results
scattered to, time-major arrays. What depends on constants only is computed before the stages, and entries that do are
not computed but laid down once (emit_constants).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca

from drawbar.errors import ModelError

_BINARY = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*", ca.OP_DIV: "/", ca.OP_LT: "<", ca.OP_LE: "<="}
_TEMPLATES = {
    ca.OP_ASSIGN: "{0}",
    ca.OP_NEG: "-{0}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "2.0 * {0}",
    ca.OP_INV: "1.0 / {0}",
    ca.OP_SIN: "lane_sin({0})",
    ca.OP_COS: "lane_cos({0})",
    ca.OP_TAN: "lane_tan({0})",
    ca.OP_SQRT: "sqrt({0})",
    ca.OP_FABS: "fabs({0})",
    ca.OP_SIGN: "({0} > 0.0) - ({0} < 0.0)",
    ca.OP_EXP: "exp({0})",
    ca.OP_LOG: "log({0})",
    ca.OP_ATAN: "atan({0})",
    ca.OP_ASIN: "asin({0})",
    ca.OP_ACOS: "acos({0})",
    ca.OP_TANH: "tanh({0})",
    ca.OP_NOT: "{0} == 0.0",
    ca.OP_IF_ELSE_ZERO: "{0} != 0.0 ? {1} : 0.0",
}
_CALLS = {
    ca.OP_ATAN2: "atan2",
    ca.OP_POW: "pow",
    ca.OP_CONSTPOW: "pow",
    ca.OP_FMIN: "fmin",
    ca.OP_FMAX: "fmax",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Input:
    """A vector argument, stored row by row, or the same for all stages."""

    place: str
    """C expression of element {i} at stage {k}, e.g. `work->u[{k}][{i}]`"""
    rows: str
    """C expression: how many rows there are; later stages read the last one; empty: the same for all stages"""
    symbol: ca.SX
    """(n, 1) symbols"""


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


@dataclass(slots=True)
class _Program:
    """Expressions as C statements."""

    once: list[str] = field(default_factory=list)
    """what is the same for all stages"""
    lanes: list[str] = field(default_factory=list)
    """the rest, for one stage, which ends in out[result][lane]"""
    gathered: list[tuple[int, int]] = field(default_factory=list)
    """(input, element) that the stage reads as in[index][lane]"""
    results: list[str] = field(default_factory=list)
    """names of the expressions' values"""
    inverses: dict[str, str] = field(default_factory=dict)
    """names of the inverses of divisors"""


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
    program = _program(inputs, same)
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
    program = _program(inputs, varying)
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


def _program(inputs: list[Input], entries: list[_Entry]) -> _Program:
    """Return the entries' values as C statements."""
    function = ca.Function("f", [i.symbol for i in inputs], [ca.vertcat(*(entry.value for entry in entries))])
    program, names, fixed = _Program(), dict[int, str](), set[str]()
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        source, target = function.instruction_input(k), function.instruction_output(k)
        if operation == ca.OP_OUTPUT:
            name = names[source[0]]
            program.lanes.append(f"out[{target[1]}][lane] = {name};")
            program.results.append(name)
            continue
        if operation == ca.OP_CONST:
            name = _literal(function.instruction_constant(k))
            fixed.add(name)
        elif operation == ca.OP_INPUT:
            name = _read(program, inputs, source[0], source[1], f"t{k}", fixed)
        else:
            name = _computed(program, operation, [names[i] for i in source], f"t{k}", fixed)
        names[target[0]] = name
    return program


def _read(program: _Program, inputs: list[Input], argument: int, element: int, name: str, fixed: set[str]) -> str:
    """Let a name be an element of an input, and return it."""
    if inputs[argument].rows:
        program.lanes.append(f"const double {name} = in[{len(program.gathered)}][lane];")
        program.gathered.append((argument, element))
    else:
        program.once.append(f"const double {name} = {inputs[argument].place.format(i=element)};")
        fixed.add(name)
    return name


def _computed(program: _Program, operation: int, arguments: list[str], name: str, fixed: set[str]) -> str:
    """Let a name be the value of an operation, and return it."""
    if all(argument in fixed for argument in arguments):
        program.once.append(f"const double {name} = {_expression(operation, arguments)};")
        fixed.add(name)
        return name
    if operation == ca.OP_DIV:  # a product is several times as fast, and divisors come again
        operation, arguments = ca.OP_MUL, [arguments[0], _inverse(program, arguments[1], fixed)]
    program.lanes.append(f"const double {name} = {_expression(operation, arguments)};")
    return name


def _inverse(program: _Program, value: str, fixed: set[str]) -> str:
    """Return the name of a value's inverse."""
    if value not in program.inverses:
        name = program.inverses[value] = f"inverse{len(program.inverses)}"
        lines = program.once if value in fixed else program.lanes
        lines.append(f"const double {name} = 1.0 / {value};")
    return program.inverses[value]


def _literal(value: float) -> str:
    text = repr(float(value))
    if not math.isfinite(value):
        raise ModelError(
            f"The model or one of its derivatives has the constant {text}; only finite numbers are allowed."
        )
    return f"({text})" if text.startswith("-") else text


def _expression(operation: int, arguments: list[str]) -> str:
    if operation in _BINARY:
        return f"{arguments[0]} {_BINARY[operation]} {arguments[1]}"
    if operation in _TEMPLATES:
        return _TEMPLATES[operation].format(*arguments)
    if operation in _CALLS:
        return f"{_CALLS[operation]}({', '.join(arguments)})"
    raise ModelError(
        f"The model uses CasADi operation {operation}, which the C runtime does not have; allowed are + - * /, powers, "
        "sqrt, fabs, fmin, fmax, if_else with < and <=, exp, log, tanh and the trigonometric functions."
    )
