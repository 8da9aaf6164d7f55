"""What is written: C99 without a warning, nothing that is not needed, and the same again the next time."""

import csv
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from drawbar.codegen.compiler import find_compiler
from drawbar.config import load_configuration
from drawbar.errors import ConfigurationError
from drawbar.export.export import export_library
from drawbar.export.sources import PUBLIC
from drawbar.export.targets import Precision
from drawbar.signals import Flag, Status

WARNINGS = (
    *("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"),
    *("-Wmissing-prototypes", "-Wdouble-promotion"),
)
ZIG = (sys.executable, "-m", "ziglang", "cc")
DEAD_TIME = "vehicle.dead_time=0.3"
OTHERS = {
    "filter": ("articulated-ekf",),
    "whole vehicle": ("articulated-centralised",),
    "tricycle": ("paper", DEAD_TIME),
    "whole tricycle": ("paper-centralised",),
    "closed form": ("lqr-pi",),
    "pure pursuit": ("pure-pursuit-pi",),
    "dead time": ("articulated", DEAD_TIME),
}


FRAGMENTS = {
    *("bounds_work.h", "packs.h", "householder.h", "first_guess.h", "moving_horizon.h", "extended_kalman.h"),
    *("subsystem_phases.h", "tricycle_phases.h", "plan_phases.h", "actuated_command.h"),
    *("centralised.h", "centralised_phases.h", "explicit.h"),
}
"""headers that want more of the one that includes them than the numbers with which a component begins"""
INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)


def said(command: tuple[str, ...], folder: Path, *names: str, warnings: tuple[str, ...] = WARNINGS) -> str:
    """Return what a compiler says of the sources."""
    sources = [str(file) for name in names for file in sorted(folder.glob(name))]
    assert sources

    def compile_one(source: str) -> str:
        built = f"{scratch}/{Path(source).stem}.o"  # zig takes /dev/null for the working directory
        arguments = [*command, *warnings, f"-I{folder / 'include'}", "-c", source, "-o", built]
        return subprocess.run(arguments, capture_output=True, text=True, check=False).stderr

    with TemporaryDirectory() as scratch, ThreadPoolExecutor(2) as pool:
        return "".join(pool.map(compile_one, sources))


def said_of(text: str, file: Path, *arguments: str) -> str:
    """Return what this machine's own compiler says of a text, in a file that is written anew."""
    file.write_text(text, "utf-8")
    command = [*find_compiler(), *arguments, "-O0", "-c", str(file), "-o", str(file.with_suffix(".o"))]
    return subprocess.run(command, capture_output=True, text=True, check=False).stderr


@pytest.mark.parametrize(
    "compiler",
    [("gcc", "-O1"), ("gcc", "-O3", "-march=native"), (*ZIG, "-O1")],
    ids=["gcc", "gcc, for this processor", "zig"],
)
def test_compiles_without_a_warning(exported, compiler: tuple[str, ...]) -> None:
    if shutil.which(compiler[0]) is None:
        pytest.skip(f"{compiler[0]} is not installed")
    if "ziglang" in compiler:
        pytest.importorskip("ziglang")
    assert said(compiler, exported("articulated"), "src/*.c", "example/*.c") == ""


def test_one_lane_at_a_time_compiles_too(exported) -> None:
    assert said((*find_compiler(), "-O0", "-DLANES=1"), exported("articulated"), "src/*.c") == ""


def test_single_precision_compiles_too(exported) -> None:
    folder = exported("articulated", precision=Precision.SINGLE)
    mixed = ("-Wconversion", "-Wdouble-promotion")  # times are doubles, counts are integers
    plain = tuple(flag for flag in WARNINGS if flag not in mixed)
    assert said((*find_compiler(), "-O0"), folder, "src/*.c", "example/*.c", warnings=plain) == ""


@pytest.mark.parametrize("fast", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
def test_no_source_compiles_where_arithmetic_is_not_ieees(exported, fast: str, tmp_path: Path) -> None:
    """Such a library runs, and soon stops for a reason that is none: its checks of NaN are gone."""
    compiler = (*find_compiler(), "-w", fast)
    (tmp_path / "finite.c").write_text("#if __FINITE_MATH_ONLY__\n#error it is\n#endif\nint something;\n", "utf-8")
    if "it is" not in said(compiler, tmp_path, "finite.c", warnings=()):
        pytest.skip(f"{' '.join(find_compiler())} keeps to IEEE arithmetic under {fast}")
    folder = exported("articulated")
    for file in sorted((folder / "src").glob("*.c")):
        assert "drawbar needs IEEE arithmetic" in said(compiler, folder, f"src/{file.name}", warnings=())
    again = (*compiler, "-fno-fast-math", "-O0")  # as CMakeLists.txt takes it back
    allowed = said(again, folder, "src/*.c", warnings=())
    assert allowed == "" or fast == "-ffinite-math-only"  # one that is asked for by name


@pytest.mark.parametrize(
    ("flag", "precision", "refusal"),
    [
        ("-mfpmath=387", Precision.DOUBLE, "drawbar needs numbers as wide as their type"),  # gcc -m32 by itself
        ("-mfpmath=387", Precision.SINGLE, "drawbar needs numbers as wide as their type"),
        ("-fsingle-precision-constant", Precision.DOUBLE, "constants_are_doubles"),
    ],
)
def test_no_source_compiles_where_numbers_are_not_as_wide_as_their_type(
    exported, flag: str, precision: Precision, refusal: str, tmp_path: Path
) -> None:
    """Such a library runs: with registers of 80 bits its sines are wrong, and it steers 0.7 rad astray."""
    compiler = (*find_compiler(), "-w", flag)
    text = "#if __FLT_EVAL_METHOD__ == 2\n#error wider\n#endif\ntypedef char wider[sizeof(1.0) == 8 ? 1 : -1];\n"
    (tmp_path / "numbers.c").write_text(text, "utf-8")
    if "wider" not in said(compiler, tmp_path, "numbers.c", warnings=()):
        pytest.skip(f"{' '.join(find_compiler())} does not do what {flag} asks for")
    folder = exported("articulated", precision=precision)
    for file in sorted((folder / "src").glob("*.c")):
        assert refusal in said(compiler, folder, f"src/{file.name}", warnings=()), file.name


def test_sums_stay_as_they_are_written_where_clang_may_change_them(exported, tmp_path: Path) -> None:
    """No macro tells of -funsafe-math-optimizations. Sines round by adding a large number: they were wrong by 0.7."""
    compiler = next(filter(shutil.which, ("clang-14", "clang")), None)
    if compiler is None:
        pytest.skip("clang is not installed")
    flags = ("-std=c99", "-w", "-O0", "-funsafe-math-optimizations", "-S", "-emit-llvm")

    def compiled(folder: Path, source: Path) -> str:
        code = tmp_path / "code.ll"
        subprocess.run([compiler, *flags, f"-I{folder}/include", str(source), "-o", str(code)], check=True)
        return code.read_text("utf-8")

    (tmp_path / "sum.c").write_text("double sum(double a, double b) { return a + b; }\n", "utf-8")
    changed = re.compile(r" = f(add|sub|mul|div) reassoc ")
    assert changed.search(compiled(tmp_path, tmp_path / "sum.c"))
    for precision in Precision:
        folder = exported("articulated", precision=precision)
        for source in sorted(folder.glob("src/*.c")):
            assert not changed.search(compiled(folder, source)), source.name


@pytest.mark.parametrize("case", OTHERS)
def test_other_configurations_compile_too(exported, case: str) -> None:
    assert said((*find_compiler(), "-O0"), exported(*OTHERS[case]), "src/*.c") == ""


def test_every_header_is_included_by_something(exported) -> None:
    folder = exported("articulated")
    files = [*folder.glob("src/*"), *folder.glob("include/*")]
    included = {name for file in files for name in INCLUDE.findall(file.read_text("utf-8"))}
    assert included == {file.name for file in files if file.suffix == ".h"}


@pytest.mark.parametrize(
    "language", [("c", *WARNINGS), ("c++", "-std=c++98", "-Wall", "-Wextra", "-Wpedantic", "-Werror")]
)
@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_header_needs_no_other_before_it(
    exported, name: str, language: tuple[str, ...], tmp_path: Path
) -> None:
    arguments = ("-x", *language, f"-I{exported('articulated') / 'include'}")
    if said_of("int something = 1;\n", tmp_path / "header.c", *arguments):
        pytest.skip(f"{find_compiler()[0]} has no {language[0]}")
    assert said_of(f'#include "{name}"\nint something = 1;\n', tmp_path / "header.c", *arguments) == ""


@pytest.mark.parametrize("case", [("articulated",), *OTHERS.values()], ids=["product", *OTHERS])
def test_a_private_header_needs_what_its_component_defines_alone(
    exported, case: tuple[str, ...], tmp_path: Path
) -> None:
    """Those that the product has too are tried with the product."""
    folder, product = exported(*case) / "src", exported("articulated") / "src"
    texts = {file.name: file.read_text("utf-8") for file in (*folder.glob("*"), *folder.glob("../include/*"))}
    arguments = ("-std=c99", "-w", "-Werror=implicit-function-declaration", f"-I{folder}", f"-I{folder}/../include")

    def below(name: str) -> set[str]:
        return {name}.union(*map(below, INCLUDE.findall(texts[name])))

    checked = FRAGMENTS.union(PUBLIC, () if folder == product else (file.name for file in product.iterdir()))
    for unit in sorted(name for name in texts if name.endswith(".c")):
        for include in INCLUDE.finditer(texts[unit]):
            before = texts[unit][: include.start()]
            headers = sorted(below(include[1]) - checked)
            checked.update(headers)
            for header in headers:
                text = f'{before}\n#include "{header}"\n'
                assert said_of(text, tmp_path / "header.c", *arguments) == "", f"{header} in {unit}"
    assert len(checked) > 30


def test_nothing_of_pythons_own_library_is_written(exported) -> None:
    folder = exported("articulated") / "src"
    assert not {"hosted.h", "hosted_step.h", "clock.h", "fields.h", "ideal.h"} & {
        file.name for file in folder.iterdir()
    }
    for file in folder.iterdir():
        assert not re.search(r"^\s*#.*(HOSTED|<time\.h>|<windows\.h>)", file.read_text("utf-8"), re.MULTILINE), (
            file.name
        )


def test_the_same_again_the_next_time(exported, tmp_path: Path) -> None:
    first = exported("articulated")
    export_library(load_configuration("articulated"), tmp_path)
    written = sorted(file.relative_to(tmp_path) for file in tmp_path.rglob("*") if file.is_file())
    assert len(written) > 50
    for file in written:
        assert (tmp_path / file).read_bytes() == (first / file).read_bytes(), file


def test_no_path_of_this_machine_is_written(exported) -> None:
    folder = exported("articulated")
    for file in folder.glob("**/*.[ch]"):
        assert str(folder) not in file.read_text("utf-8")


def test_what_exists_in_simulation_only_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"The estimator of .* exists in simulation only"):
        export_library(load_configuration("articulated-ideal"), tmp_path)
    assert not any(tmp_path.iterdir())


def test_a_window_that_floats_do_not_suffice_for_is_refused(tmp_path: Path) -> None:
    configuration = load_configuration("articulated", ("estimator.window=101",))
    with pytest.raises(ConfigurationError, match=r"estimator.window = 101: in single precision at most 100 samples"):
        export_library(configuration, tmp_path, precision=Precision.SINGLE)
    assert not any(tmp_path.iterdir())


@pytest.fixture(scope="module")
def example(exported, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], list[list[str]]]:
    """Return a function that replays a table of measurements: the rows of what the example prints."""
    folder = exported("articulated")
    here = tmp_path_factory.mktemp("example")
    sources = [*map(str, folder.glob("src/*.c")), str(folder / "example" / "main.c")]
    command = [*find_compiler(), "-O0", f"-I{folder / 'include'}", *sources, "-lm", "-o", str(here / "example")]
    subprocess.run(command, check=True)

    def replay(measurements: str) -> list[list[str]]:
        (here / "measured.csv").write_text(measurements, "utf-8")
        arguments = [str(here / "example"), str(here / "measured.csv")]
        done = subprocess.run(arguments, cwd=folder / "example", capture_output=True, text=True, check=True)
        return list(csv.reader(done.stdout.splitlines()))

    return replay


@pytest.fixture
def measurements(exported) -> str:
    return (exported("articulated") / "example" / "measurements.csv").read_text("utf-8")


def test_the_example_replays_what_goes_with_it(example, measurements: str) -> None:
    names, *rows = example(measurements)
    assert names == ["time", "tractor_steering", "trailer_steering", "speed", "status", "meaning"]
    assert len(rows) == 150
    assert {row[4] for row in rows} == {"0"}
    assert {float(row[3]) for row in rows} == {1.0}


def test_a_table_has_the_members_of_its_structure(exported, measurements: str) -> None:
    folder = exported("articulated")
    tables = {"measurement": measurements, "path_node": (folder / "example" / "path.csv").read_text("utf-8")}
    header = (folder / "include" / "drawbar_signals.h").read_text("utf-8")
    for name, table in tables.items():
        (members,) = re.findall(rf"^struct drawbar_{name} {{\n(.*?)^}};", header, re.MULTILINE | re.DOTALL)
        names, *rows = csv.reader(table.splitlines())
        assert names == re.findall(r"^    (?:double|int32_t) (\w+);", members, re.MULTILINE)
        assert {len(row) for row in rows} == {len(names)}
        assert all(repr(float(value)) == value or repr(int(value)) == value for row in rows for value in row if value)


def test_what_the_example_is_not_given_has_its_default(example, measurements: str) -> None:
    """A machine of before: nothing that tells of the receivers, no attitude, no ages."""
    lines = list(csv.reader(measurements.splitlines()))
    assert example("\n".join(",".join(line[:9]) for line in lines)) == example(measurements)
    assert example("\n".join(",".join([*line[:9], *[""] * 18]) for line in lines)) == example(measurements)


def test_what_the_example_is_given_arrives(example, measurements: str) -> None:
    """Each column: a number beyond what its sensor can mean is told from the others by the step's flag."""
    names, first, *_ = csv.reader(measurements.splitlines())
    for i, name in enumerate(names[1:25], 1):
        told = [*first[:i], "1e9", *first[i + 1 :]]
        _, (*_, status, _) = example("\n".join(map(",".join, (names, told))))
        absurd = Status.POSITION if name.endswith(("_x", "_y")) else Flag.MEASUREMENT
        assert int(status) == (Status.OK if name.endswith("_age") else absurd), name
