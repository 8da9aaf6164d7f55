"""The C runtime under AddressSanitizer and UndefinedBehaviorSanitizer, fed with random and senseless numbers."""

import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from drawbar.codegen import build
from drawbar.codegen.cache import runtime_sources
from drawbar.codegen.compiler import find_compiler
from drawbar.optimal import Bound, ControlProblem, EstimationProblem, quadratic_program
from drawbar.optimal.quadratic_program import QuadraticProgram, Sizes
from drawbar.optimal.solver_source import introspection, solver_source
from drawbar.optimal.transcription import transcribe
from drawbar.signals import SolverStatus
from drawbar.vehicle.articulated import articulated, articulated_trailer
from drawbar.vehicle.model import Model
from drawbar.vehicle.parameters import VehicleParameters
from drawbar.vehicle.tricycle import tricycle, tricycle_tractor

HERE = Path(__file__).parent
WARNINGS = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")
SANITIZERS = ("-O1", "-march=native", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
VEHICLE = VehicleParameters()
BOX = Bound(lower=-1.0, upper=1.0)


def control(model: Model) -> str:
    outputs = [output.name for output in model.outputs]
    problem = ControlProblem(
        model=model,
        horizon=5,
        sample_time=0.2,
        weights=dict.fromkeys(outputs, 1.0),
        terminal_weights=dict.fromkeys(outputs, 0.0) | {outputs[0]: 1.0},
        bounds={model.inputs[0].name: BOX},
    )
    transcription = transcribe(problem)
    return solver_source(transcription) + introspection(transcription)


def constrained(model: Model) -> str:
    """Return the solver of a controller with a bounded output and a bounded, weighed change of an input."""
    outputs, steering = [output.name for output in model.outputs], model.inputs[0].name
    problem = ControlProblem(
        model=replace(model, outputs=tuple(replace(each, name=f"{each.name}_seen") for each in model.outputs)),
        horizon=5,
        sample_time=0.2,
        weights={f"{name}_seen": 1.0 for name in outputs},
        terminal_weights={f"{name}_seen": 0.0 for name in outputs},
        bounds={f"{outputs[0]}_seen": BOX, f"{outputs[-1]}_seen": BOX},
        change_weights={steering: 1.0},
        change_bounds={steering: BOX},
    )
    transcription = transcribe(problem)
    return solver_source(transcription) + introspection(transcription)


def estimation(model: Model) -> str:
    estimated = [variable.name for variable in (*model.states, *model.parameters)]
    problem = EstimationProblem(
        model=model,
        horizon=4,
        sample_time=0.2,
        weights={output.name: 1.0 for output in model.outputs},
        prior_deviation=dict.fromkeys(estimated, 1.0),
        process_deviation=dict.fromkeys(estimated, 1.0),
        bounds={model.inputs[0].name: BOX},
    )
    transcription = transcribe(problem)
    return solver_source(transcription) + introspection(transcription)


UNITS = {
    "tricycle_tractor": lambda: control(tricycle_tractor(VEHICLE)),
    "constrained_tractor": lambda: constrained(tricycle_tractor(VEHICLE)),
    "articulated_trailer": lambda: control(articulated_trailer(VEHICLE)),
    "tricycle_estimator": lambda: estimation(tricycle(VEHICLE)),
    "articulated_estimator": lambda: estimation(articulated(VEHICLE)),
}


def compiled(folder: Path, unit: str, host: str, calls: int, flags: tuple[str, ...]) -> Path:
    """Compile a host program around a unit and return it."""
    for name, text in {**runtime_sources(), "unit.c": unit}.items():
        (folder / name).write_text(text, "utf-8")
    program = folder / "program"
    command = [*find_compiler(), *WARNINGS, *flags, f"-DCALLS={calls}", f"-I{folder}", f"-I{HERE}"]
    done = subprocess.run(
        [*command, "-o", str(program), str(HERE / host), "-lm"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[:3000]
    return program


def counted(program: Path) -> dict[SolverStatus, int]:
    """Run the program; return how often each status came."""
    done = subprocess.run([str(program)], capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stdout[-500:] + done.stderr[:3000]
    return dict(zip(SolverStatus, map(int, done.stdout.split()), strict=True))


@pytest.fixture(scope="module", autouse=True)
def sanitizers(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Skip where the compiler cannot link the sanitizers or the machine cannot run them."""
    folder = tmp_path_factory.mktemp("trial")
    (folder / "trial.c").write_text("int main(void) { return 0; }\n")
    program = folder / "trial"
    command = [*find_compiler(), *SANITIZERS, "-o", str(program), str(folder / "trial.c")]
    built = subprocess.run(command, capture_output=True, check=False).returncode == 0
    if not built or subprocess.run([str(program)], capture_output=True, check=False).returncode != 0:
        pytest.skip("this compiler has no address and undefined-behaviour sanitizers")


@pytest.mark.parametrize("name", UNITS)
def test_random_iterations_raise_no_sanitizer(name: str, tmp_path: Path) -> None:
    counts = counted(compiled(tmp_path, UNITS[name](), "iteration.c", 6000, SANITIZERS))
    least = 100 if name == "constrained_tractor" else 600  # hard bounds on states, at random, leave few points
    assert counts[SolverStatus.SOLVED] > least, counts
    assert counts[SolverStatus.BAD_INPUT] > 60, counts


@pytest.mark.parametrize("free", [False, True])
def test_random_quadratic_programs_raise_no_sanitizer(
    free: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    units: list[str] = []

    def noted(name: str, unit: str) -> Path:
        units.append(unit)
        return build(name, unit)

    monkeypatch.setattr(quadratic_program, "build", noted)
    QuadraticProgram(Sizes(stages=4, states=3, inputs=2, bounds=10, free_initial=free))
    counts = counted(compiled(tmp_path, units[0], "program.c", 8000, SANITIZERS))
    assert counts[SolverStatus.SOLVED] > 800, counts
    assert counts[SolverStatus.BAD_INPUT] > 10, counts
