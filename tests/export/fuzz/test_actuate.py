"""The low level under AddressSanitizer and UndefinedBehaviorSanitizer: no promise of drawbar_actuate.h is broken.

With clang libFuzzer looks for inputs; any other compiler with sanitizers gets random ones. DRAWBAR_FUZZ_SECONDS=3600
makes libFuzzer's run a long one.
"""

import os
import random
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

HERE = Path(__file__).parent
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
FLAGS = ("-std=c99", "-O1", "-g1", "-ffp-contract=off", "-fno-math-errno")
SECONDS = os.environ.get("DRAWBAR_FUZZ_SECONDS", "")
REACHED = {0, 1, 2, 16, 17, 18, 19, 20, 65}


def program(library: Path, file: Path, *command: str) -> Path | None:
    """Return the fuzzer's program, or None where this compiler cannot make one."""
    sources = [str(library / "src" / "actuate.c"), str(HERE / "actuate.c")]
    arguments = [*command, *FLAGS, f"-I{library / 'include'}", *sources, "-lm", "-o", str(file)]
    return file if subprocess.run(arguments, capture_output=True, check=False).returncode == 0 else None


def checked(*command: str) -> set[int]:
    """Return the statuses that were reached without a broken promise."""
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    return set(map(int, re.findall(r"^status (\d+):", done.stderr, re.MULTILINE)))


@pytest.mark.parametrize("compiler", ["gcc", "clang-14"])
def test_random_inputs_raise_no_sanitizer_and_reach_every_status(
    exported: Callable[..., Path], compiler: str, tmp_path: Path
) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    built = program(exported("articulated"), tmp_path / "random", compiler, *SANITIZERS, "-DRANDOM")
    if built is None:
        pytest.skip(f"this {compiler} has no sanitizers")
    assert checked(str(built), "3000") == REACHED


def test_inputs_that_libfuzzer_finds(exported: Callable[..., Path], tmp_path: Path) -> None:
    compiler = next(filter(shutil.which, ("clang-14", "clang")), None)
    if compiler is None:
        pytest.skip("clang is not installed")
    built = program(exported("articulated"), tmp_path / "fuzz", compiler, *SANITIZERS, "-fsanitize=fuzzer")
    if built is None:
        pytest.skip("this clang has no libFuzzer")
    source, corpus = random.Random(None if SECONDS else 1), tmp_path / "corpus"
    corpus.mkdir()
    for i in range(64):
        (corpus / str(i)).write_bytes(source.randbytes(4096))
    length = [f"-max_total_time={SECONDS}"] if SECONDS else ["-runs=5000", "-seed=1"]
    options = [*length, "-max_len=4096", "-len_control=0", f"-artifact_prefix={tmp_path}/"]
    assert checked(str(built), *options, str(corpus)) >= {0, 1, 16, 17, 18, 65}
