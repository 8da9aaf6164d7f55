"""Every branch of supervisor and gate is taken by their tests; run as a program it shows which are not."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
COVERED = (
    *("envelope", "following", "speeds", "machine_gate", "gate_report", "gate_process", "wires", "channels"),
    *("engagement", "conditions", "causes", "operator_requests", "watch", "selftest"),
)
TESTS = (
    *("engagement", "conditions", "envelope", "selftest", "speeds", "following"),
    *("machine_gate", "operator_requests", "gate_channels", "watch", "gate_loop"),
)
ENDINGS = ("what_ends_driving_releases_in_time_and_for_good", "it_recovers_when_the_cause_is_gone")
"""those of test_gate_endings.py that reach something more; all of them take a minute under coverage"""


def test_every_branch_is_taken(tmp_path):
    run = measure(tmp_path)
    assert run.returncode == 0, run.stdout


def measure(folder: Path) -> subprocess.CompletedProcess[str]:
    """Run tests of the gate without real processes, the longest left out, and report what they did not reach."""
    sources = ",".join(f"*/drawbar/safety/{name}.py" for name in COVERED)
    environment = {**os.environ, "COVERAGE_FILE": str(folder / "coverage")}
    tests = [str(ROOT / "tests" / "safety" / f"test_{name}.py") for name in TESTS]
    tests += [str(ROOT / "tests" / "safety" / f"test_gate_endings.py::test_{name}") for name in ENDINGS]
    options = ["-q", "-p", "no:cacheprovider", "-p", "no:xdist", "-k", "not nominal and not whatever"]
    run = [
        sys.executable,
        "-m",
        "coverage",
        "run",
        "--branch",
        f"--include={sources}",
        "-m",
        "pytest",
        *options,
        *tests,
    ]
    ran = subprocess.run(run, cwd=ROOT, env=environment, capture_output=True, text=True)
    if ran.returncode:
        return ran
    report = [sys.executable, "-m", "coverage", "report", "--show-missing", "--fail-under=100"]
    return subprocess.run(report, cwd=ROOT, env=environment, capture_output=True, text=True)


if __name__ == "__main__":
    print(measure(Path(os.environ.get("TMPDIR", "/tmp"))).stdout)
