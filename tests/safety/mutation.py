"""Mutation testing of supervisor and gate: python tests/safety/mutation.py [MODULE ...] [--share 0.2].

Each mutant is one small change of one module's syntax tree: a comparison, an operator, a number, a boolean, a condition
or a statement left out. Types and options of dataclasses, which mypy checks, stay, and zip's check of lengths. A mutant
is loaded in a forked process in place of its module, and tests of tests/safety are run until the first fails. Prints
the mutants that no test sees, and the share of those that are seen. Fails below 95 %.
"""

import argparse
import ast
import copy
import importlib.util
import os
import random
import signal
import sys
import time
from pathlib import Path

import hypothesis.stateful  # noqa: F401  loaded once here, and not in each process
import pytest

import drawbar.simulation  # noqa: F401

ROOT = Path(__file__).parents[2]
TESTS = {
    "engagement": (
        "test_engagement.py",
        "test_engagement_sequences.py",
        "test_machine_gate.py",
        "test_gate_endings.py",
    ),
    "conditions": ("test_conditions.py", "test_engagement.py", "test_machine_gate.py"),
    "envelope": ("test_envelope.py", "test_selftest.py", "test_machine_gate.py", "test_gate_endings.py"),
    "following": ("test_following.py", "test_following_edges.py", "test_machine_gate.py", "test_gate_endings.py"),
    "speeds": ("test_speeds.py", "test_machine_gate.py", "test_gate_endings.py"),
    "operator_requests": ("test_operator_requests.py", "test_machine_gate.py", "test_gate_endings.py"),
    "machine_gate": (
        "test_operator_requests.py",
        "test_gate_speed.py",
        "test_gate_edges.py",
        "test_machine_gate.py",
        "test_gate_endings.py",
        "test_safety_settings.py",
    ),
    "watch": ("test_watch.py", "test_conditions.py", "test_machine_gate.py", "test_gate_endings.py"),
    "channels": ("test_gate_channels.py",),
    "selftest": ("test_selftest.py", "test_machine_gate.py"),
    "wires": ("test_gate_channels.py", "test_gate_loop.py"),
    "gate_report": ("test_gate_report.py", "test_machine_gate.py", "test_gate_endings.py"),
    "gate_process": ("test_gate_loop.py",),
}
"""the tests that are tried on each module's mutants, those that take least time first"""
LOADED = "ignore::pytest.PytestAssertRewriteWarning"
"""of what is loaded here already, which tests do not look at"""
LIMIT = 300.0
"""time that the tests may take, s"""
PATIENCE = 10.0
"""so many times as long a mutant may take, and SHORTEST at least; one that hangs is seen"""
SHORTEST = 30.0
"""s"""
COMPARISONS = {
    ast.Lt: (ast.LtE, ast.Gt), ast.LtE: (ast.Lt, ast.Gt), ast.Gt: (ast.GtE, ast.Lt), ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,), ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}  # fmt: skip
OPERATORS = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.BitOr: ast.BitAnd,
    ast.BitAnd: ast.BitOr, ast.Mod: ast.Mult, ast.FloorDiv: ast.Mult,
}  # fmt: skip
BLOCKS = ("body", "orelse", "finalbody")
"""of statements"""


def changes(node):
    """Yield (what, function that changes a copy of the node in place) for each mutation of a node."""
    if isinstance(node, ast.Compare):
        for index, operator in enumerate(node.ops):
            for other in COMPARISONS[type(operator)]:
                yield f"{type(operator).__name__} -> {other.__name__}", _setter("ops", index, other())
    elif isinstance(node, ast.BinOp | ast.AugAssign) and type(node.op) in OPERATORS:
        other = OPERATORS[type(node.op)]
        yield f"{type(node.op).__name__} -> {other.__name__}", lambda each: setattr(each, "op", other())
    elif isinstance(node, ast.BoolOp):
        other = ast.Or if isinstance(node.op, ast.And) else ast.And
        yield f"{type(node.op).__name__} -> {other.__name__}", lambda each: setattr(each, "op", other())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
        plain = ast.UAdd if isinstance(node.op, ast.USub) else None
        yield "negation left out", (lambda each: setattr(each, "op", plain())) if plain else _without_not
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield "boolean turned", lambda each: setattr(each, "value", not each.value)
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        yield "number + 1", lambda each: setattr(each, "value", each.value + 1)
    elif isinstance(node, ast.If | ast.IfExp):
        yield "condition turned", lambda each: setattr(each, "test", ast.UnaryOp(ast.Not(), each.test))
    elif isinstance(node, ast.Return) and not isinstance(node.value, ast.Constant | None):
        yield "nothing returned", lambda each: setattr(each, "value", ast.Constant(None))


def _setter(field, index, value):
    return lambda each: getattr(each, field).__setitem__(index, value)


def _without_not(each):
    each.op, each.operand = ast.Not(), ast.UnaryOp(ast.Not(), each.operand)


def left_out(node):
    """Yield (block, index) of each statement that may be left out: calls, what changes or deletes something, raises."""
    for block in BLOCKS:
        statements = getattr(node, block, None)
        for index, statement in enumerate(statements if isinstance(statements, list) else ()):
            call = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call)
            # without what __init__ assigns nothing would run
            assigns = _assigns(statement) and getattr(node, "name", "") != "__init__"
            if call or assigns or isinstance(statement, ast.AugAssign | ast.Delete | ast.Raise):
                yield block, index


def _assigns(statement):
    """Return whether a statement assigns what outlives its function: an attribute or an element."""
    targets = statement.targets if isinstance(statement, ast.Assign) else ()
    parts = [part for each in targets for part in (each.elts if isinstance(each, ast.Tuple) else (each,))]
    return any(isinstance(each, ast.Attribute | ast.Subscript) for each in parts)


def left_alone(tree):
    """Return the nodes of annotations, of the decorators of classes, and of zip's check of lengths."""
    roots = []
    for node in ast.walk(tree):
        roots += [getattr(node, "annotation", None), getattr(node, "returns", None)]
        roots += node.decorator_list if isinstance(node, ast.ClassDef) else []
        roots += [node] if isinstance(node, ast.keyword) and node.arg == "strict" else []
    return {each for root in roots if root is not None for each in ast.walk(root)}


def mutants(source):
    """Yield (line, what, tree) for each mutant of a module."""
    tree = ast.parse(source)
    nodes, left = list(ast.walk(tree)), left_alone(tree)
    for position, node in enumerate(nodes):
        if node in left:
            continue
        for number, (what, _) in enumerate(changes(node)):
            mutant = copy.deepcopy(tree)
            target = list(ast.walk(mutant))[position]
            list(changes(target))[number][1](target)
            yield node.lineno, what, mutant
        for block, index in left_out(node):
            mutant = copy.deepcopy(tree)
            body = getattr(list(ast.walk(mutant))[position], block)
            line, body[index] = body[index].lineno, ast.copy_location(ast.Pass(), body[index])
            yield line, "statement left out", mutant


def survives(name, tree, tests, limit=LIMIT):
    """Return whether all tests pass within a time (s) with a mutant in the place of its module."""
    child = os.fork()
    if child == 0:
        os.setpgrp()
        signal.setitimer(signal.ITIMER_REAL, limit)
        silence = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silence, 1)
        os.dup2(silence, 2)
        os._exit(_run(name, tree, tests))
    _, status = os.waitpid(child, 0)
    return os.WIFEXITED(status) and os.WEXITSTATUS(status) == 0


def _run(name, tree, tests):
    full = f"drawbar.safety.{name}"
    specification = importlib.util.find_spec(full)
    module = importlib.util.module_from_spec(specification)
    sys.modules[full] = module
    try:
        exec(compile(ast.fix_missing_locations(tree), specification.origin, "exec"), module.__dict__)
    except Exception:
        return 1
    quick = ["-x", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "-k", "not nominal", "-W", LOADED]
    return int(pytest.main([*quick, *(str(ROOT / "tests" / "safety" / test) for test in tests)]))


def main():
    """Try the mutants of the modules named, or of all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("modules", nargs="*", default=list(TESTS))
    parser.add_argument("--share", type=float, default=1.0, help="of the mutants, drawn at random with seed 0")
    given = parser.parse_args()
    os.chdir(ROOT)
    chance, seen, all_of_them = random.Random(0), 0, 0
    for name in given.modules:
        tests = [test for test in TESTS[name] if (ROOT / "tests" / "safety" / test).exists()]
        if f"drawbar.safety.{name}" in sys.modules:
            sys.exit(f"{name}: loaded before its mutants, which others would then not use")
        source = (ROOT / "src" / "drawbar" / "safety" / f"{name}.py").read_text()
        begin = time.monotonic()
        if not survives(name, ast.parse(source), tests):
            sys.exit(f"{name}: without a change its tests fail, or last {LIMIT} s: every mutant would count as seen")
        limit = min(max(PATIENCE * (time.monotonic() - begin), SHORTEST), LIMIT)
        chosen = [mutant for mutant in mutants(source) if chance.random() < given.share]
        survivors = [(line, what) for line, what, tree in chosen if survives(name, tree, tests, limit)]
        seen, all_of_them = seen + len(chosen) - len(survivors), all_of_them + len(chosen)
        took = time.monotonic() - begin
        print(f"{name}: {len(chosen) - len(survivors)} of {len(chosen)} seen, {took:.0f} s", flush=True)
        for line, what in sorted(survivors):
            print(f"    {name}.py:{line}: {what}: {source.splitlines()[line - 1].strip()}", flush=True)
    print(f"{seen} of {all_of_them} seen, {100.0 * seen / max(all_of_them, 1):.1f} %")
    return 0 if seen >= 0.95 * all_of_them else 1


if __name__ == "__main__":
    sys.exit(main())
