"""The gate stays small enough to be read in one sitting, and independent of numpy."""

import ast
import subprocess
import sys
from pathlib import Path

SAFETY = Path(__file__).parents[2] / "src" / "drawbar" / "safety"
GATE = ("envelope", "following", "speeds", "machine_gate", "gate_process", "wires")
"""what stands between a command and the wire; beside it the supervisor, sockets and the record of its state"""


def code_lines(path: Path) -> int:
    """Count the lines with statements: neither docstrings nor comments nor blank ones."""
    tree = ast.parse(path.read_text("utf-8"))
    said: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            said |= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    lines = enumerate(path.read_text("utf-8").splitlines(), 1)
    return sum(bool(line.strip()) and not line.strip().startswith("#") and number not in said for number, line in lines)


def test_the_gate_has_less_than_500_lines_of_code():
    assert sum(code_lines(SAFETY / f"{name}.py") for name in GATE) < 500


def test_the_gates_process_does_without_numpy():
    code = "import sys, drawbar.safety.gate_process\nprint('numpy' in sys.modules, 'casadi' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "False False"
