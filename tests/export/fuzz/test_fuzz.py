"""The exported library under libFuzzer with AddressSanitizer and UndefinedBehaviorSanitizer.

Whatever sensors, solvers, paths, clocks and callers do, no promise of drawbar.h is broken.

The test is a short run from fixed seeds, with doubles. DRAWBAR_FUZZ_SECONDS=3600 makes it a long one, from seeds of its
own, and one with floats; what it finds is kept in the current folder. The fuzzer's own sources become floats as the
library's do.
"""

import os
import random
import re
import shutil
import subprocess
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from drawbar.config import load_configuration
from drawbar.export.precision import single, single_text
from drawbar.export.targets import Precision
from drawbar.signals import Flag, Status

HERE = Path(__file__).parent
SANITIZERS = (
    "-fsanitize=fuzzer,address,undefined",
    "-fno-sanitize=null,alignment,object-size,pointer-overflow",  # ten times slower, and mostly what address sees
    "-fno-sanitize-recover=all",
)
FLAGS = ("-std=c99", "-O1", "-g1", "-march=native", "-ffp-contract=off", "-fno-math-errno", "-Wno-psabi")
REPLACED = ("estimator_update", "tractor_feedback", "trailer_feedback")
"""functions of the library that solvers.h stands in for"""
MASTS = "vehicle.masts={tractor={up=2.5},trailer={up=2.0}}"
"""of vehicle.h"""
VEHICLES = {
    "product": (),
    "garden tractor": (
        *("vehicle.wheelbase=1.2", "vehicle.hitch_length=0.5", "vehicle.drawbar_length=0.1"),
        *("vehicle.trailer_length=0.6", "vehicle.trailer_antenna=0.1", "speed=0.3"),
    ),
    "fast, and its free joint ahead of the rear axle": (
        *("vehicle.drawbar_length=2.4", "vehicle.curvature_limit=0.2", "vehicle.steering_lag=0.1"),
        *("speed=4.0", "machine.hydrostat.full_speed=5.0"),
    ),
}
"""changes of the configuration"""
COMPILERS = ("clang-14", "clang")
SECONDS = os.environ.get("DRAWBAR_FUZZ_SECONDS", "")


LEEWAY = {Precision.DOUBLE: 1e-9, Precision.SINGLE: 1e-6}
"""of the promises, for rounding"""
PRECISIONS = [Precision.DOUBLE, *([Precision.SINGLE] if SECONDS else [])]


def limits(changes: tuple[str, ...], precision: Precision) -> list[str]:
    """Return the configuration's limits as the promises know them, and its vehicle as vehicle.h does."""
    configuration = load_configuration("articulated", changes)
    vehicle = configuration.vehicle
    reach = 2.0 * vehicle.steering_lag + configuration.sample_time
    numbers = {
        "LEEWAY": LEEWAY[precision],
        "TRACTOR_LIMIT": vehicle.tractor_steering_limit,
        "TRAILER_LIMIT": vehicle.trailer_steering_limit,
        "SPEED_LIMIT": configuration.speed,
        "SANITY_SHARE": max(configuration.sanity.coarse_share, configuration.sanity.swing_share),
        "ACCELERATION": configuration.acceleration,
        "TRACTOR_CHANGE": reach * vehicle.tractor_steering_rate,
        "TRAILER_CHANGE": reach * vehicle.trailer_steering_rate,
        "WHEELBASE": vehicle.wheelbase,
        "FREE_JOINT_BEHIND": round(vehicle.free_joint_offset, 3),
        "DRAWBAR_LENGTH": vehicle.drawbar_length,
        "TRAILER_LENGTH": vehicle.trailer_length,
        "POINT_BEHIND": round(vehicle.trailer_length - vehicle.trailer_antenna, 3),
        "LAG": vehicle.steering_lag,
        "TRACTOR_RATE": round(vehicle.tractor_steering_rate, 2),
        "TRAILER_RATE": round(vehicle.trailer_steering_rate, 2),
    }
    written = single_text if precision is Precision.SINGLE else str
    return [f"-D{name}={written(repr(value))}" for name, value in numbers.items()]


@pytest.fixture(scope="module")
def fuzzer(exported: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Return a function that makes a program of a vehicle's library and the fuzzer's target."""
    return lambda vehicle, precision: built(VEHICLES[vehicle], precision, exported, tmp_path_factory.mktemp("fuzz"))


def built(changes: tuple[str, ...], precision: Precision, exported: Callable[..., Path], folder: Path) -> Path:
    """Return the program, made in an empty folder."""
    compiler = next(filter(shutil.which, COMPILERS), None)
    if compiler is None:
        pytest.skip("clang is not installed")
    library = exported("articulated", MASTS, *changes, precision=precision)
    own = {file.name: file.read_text("utf-8") for file in HERE.glob("*.[ch]")}
    for name, text in (single(own) if precision is Precision.SINGLE else own).items():
        (folder / name).write_text(text, "utf-8")
    headers = [f"-I{library / 'include'}", f"-I{library / 'src'}"]

    def compile_unit(source: Path) -> Path:
        built = folder / f"{source.stem}.o"
        command = [
            compiler,
            *FLAGS,
            *SANITIZERS,
            *headers,
            *limits(changes, precision),
            "-c",
            str(source),
            "-o",
            str(built),
        ]
        subprocess.run(command, check=True)
        return built

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        objects = list(pool.map(compile_unit, [*(library / "src").glob("*.c"), folder / "fuzz.c"]))
    program = folder / "fuzz"
    linking = [*(f"-Wl,--wrap=drawbar_{name}" for name in REPLACED), *map(str, objects), "-lm", "-o", str(program)]
    linked = subprocess.run([compiler, *SANITIZERS, *linking], capture_output=True)
    if linked.returncode != 0:
        pytest.skip("this clang has no libFuzzer")
    return program


def seeds(folder: Path, count: int, seed: int | None) -> Path:
    """Write random inputs to begin with."""
    source = random.Random(seed)
    folder.mkdir()
    for i in range(count):
        (folder / str(i)).write_bytes(source.randbytes(256))
    return folder


def counted(said: str, what: str) -> int:
    """Return a number that the fuzzer prints at its end."""
    return int(re.findall(rf"^{what} (\d+)", said, re.MULTILINE)[0])


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("vehicle", VEHICLES)
def test_no_promise_is_broken(vehicle: str, precision: Precision, fuzzer: Callable[..., Path], tmp_path: Path) -> None:
    """The product reaches every flag, all that repeats a command, all that ends a run, and other paths within one."""
    short = ["-runs=200", "-seed=1", f"-artifact_prefix={tmp_path}/"]
    length = [f"-max_total_time={SECONDS}"] if SECONDS else short
    corpus = seeds(tmp_path / "corpus", 64, None if SECONDS else 1)
    done = subprocess.run(
        [
            str(fuzzer(vehicle, precision)),
            *length,
            "-max_len=512",
            "-len_control=0",
            "-report_slow_units=600",
            str(corpus),
        ],
        capture_output=True,
        text=True,
        errors="replace",
    )
    assert done.returncode == 0, re.sub(
        r".*?(?=broken promise|runtime error|ERROR)", "", done.stderr, count=1, flags=re.DOTALL
    )
    print(done.stderr[done.stderr.index("\nsteps ") :])
    assert counted(done.stderr, "steps") > 20_000
    assert counted(done.stderr, "changes") > 20
    if vehicle != "product":
        return
    statuses = set(map(int, re.findall(r"^status (\d+):", done.stderr, re.MULTILINE)))
    assert {flag for flag in Flag for status in statuses if status < Status.REFUSED and status & flag} == set(Flag)
    assert statuses >= {status for status in Status if status < Status.NULL}
