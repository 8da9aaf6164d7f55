"""Task: one run of an experiment, plain data in and out, so that any worker can do it and a file can keep it."""

import hashlib
import tomllib
from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import tomli_w
from numpy.typing import NDArray

from drawbar.benchmark.figures import on_one_core
from drawbar.config import Configuration
from drawbar.control.external import written_source
from drawbar.experiment.alteration import Alteration
from drawbar.experiment.deviation import DEVIATION, RecordedDeviation
from drawbar.geometry import Floats
from drawbar.recording.log import RunLog
from drawbar.report.metrics import Metrics, compute_metrics
from drawbar.report.path_errors import Bodies, PathErrors, true_path_errors
from drawbar.simulation import Simulation

if TYPE_CHECKING:
    from drawbar.experiment.trial import Trial

_BESIDE_THE_RUN = ("benchmark", "experiment", "cli")
"""what of the package no figure of a run depends on, but for these files of experiment"""
_OF_THE_RUN = ("task.py", "deviation.py", "alteration.py", "trial.py")
_BESIDE_THE_SOLVERS = ("name", "path", "start", "machine", "bounded_errors", "tuning")
"""sections of a configuration that no solver depends on"""
_WATCH = "watch."


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """What to drive and what to keep of it."""

    configuration: str
    """complete, TOML"""
    seed: int
    """of all randomness in the simulated machine"""
    columns: tuple[str, ...] = ()
    """kept step by step: names as in RunLog.column, error.BODY and progress.BODY of the true points on the
    ground, m, or deviation.NAME, the standard deviation of a state or parameter of the estimator's model; of a
    rehearsed run only watch.NAME (trial.py)"""
    one_core: bool = False
    """stay on a single core of the processor, for figures of time"""
    alterations: tuple[Alteration, ...] = ()
    """applied before the run begins, one after the other"""
    fault: Alteration | None = None
    """of a rehearsed run: applied to its Trial at the fault's place"""
    rehearsed: bool = False
    """drive on stand-ins of all devices, with receivers' bytes, gate and boards (trial.py), not on the plain machine"""

    @property
    def key(self) -> str:
        """Return the key of this task's result, different for every other task and for another drawbar."""
        altered = [text for each in self.alterations for text in (each.name, each.source)]
        fault = ["fault", self.fault.name, self.fault.source] if self.fault else []
        kept = (*self.columns, "altered by", *altered, *fault)
        return digest(
            source_digest(),
            controller_source(self.configuration),
            self.configuration,
            str(self.seed),
            str(self.one_core),
            str(self.rehearsed),
            *kept,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """What is kept of one run: n steps."""

    source: str
    """digest of the drawbar that measured it"""
    metrics: Metrics
    columns: Mapping[str, Floats]
    """(n,) each, SI"""


def run_task(task: Task) -> Result:
    """Drive the whole path; a run that was given up is a result as well, with `metrics.finished` false.

    Raises:
        DrawbarError: the configuration cannot be built.
        AttributeError: there is no such column.
    """
    if task.rehearsed:
        return watched_trial(approached_trial(task), task)
    with on_one_core() if task.one_core else nullcontext():
        log, deviations = _simulate(task)
    errors = true_path_errors(log)
    return Result(
        source=source_digest(),
        metrics=compute_metrics(log, errors),
        columns={name: _column(log, errors, deviations, name) for name in task.columns},
    )


def compile_solvers(configuration: str) -> None:
    """Build everything that a complete configuration (TOML) needs, once, so that its libraries lie in the cache."""
    Simulation(Configuration.model_validate(tomllib.loads(configuration)))


def solver_sections(configuration: str) -> str:
    """Return what is left of a complete configuration (TOML) without that on which no solver depends."""
    sections = tomllib.loads(configuration)
    return tomli_w.dumps({key: value for key, value in sections.items() if key not in _BESIDE_THE_SOLVERS})


@cache
def source_digest() -> str:
    """Return the hash of all of drawbar's own code that a figure of a run depends on."""
    with resources.as_file(resources.files("drawbar")) as root:
        files = sorted(file for suffix in ("py", "h") for file in root.rglob(f"*.{suffix}"))
        measuring = [file for file in files if file.relative_to(root).parts[0] not in _BESIDE_THE_RUN]
        measuring += [root / "experiment" / name for name in _OF_THE_RUN]
        return digest(*(file.read_text("utf-8") for file in measuring))


@cache
def controller_source(configuration: str) -> str:
    """Return the source of the user's own controller in a complete configuration (TOML); empty: there is none."""
    controller = tomllib.loads(configuration)["controller"]
    return written_source(controller["implementation"]) if controller["model"] == "external" else ""


def encode_result(result: Result) -> bytes:
    """Return the result as bytes (MessagePack: exact, NaN included)."""
    return msgspec.msgpack.encode(result, enc_hook=_array_to_bytes)


def decode_result(data: bytes) -> Result:
    """Return the result that was encoded. Raises msgspec.MsgspecError when the bytes are damaged."""
    return msgspec.msgpack.decode(data, type=Result, dec_hook=_bytes_to_array)


def _array_to_bytes(value: NDArray[np.float64]) -> bytes:
    return value.tobytes()


def _bytes_to_array(_kind: Any, value: bytes) -> Floats:
    return np.frombuffer(value)


def approached_trial(task: Task) -> "Trial":
    """Return the trial of a rehearsed run, which has been driven to its fault's place.

    Raises:
        DrawbarError: the configuration cannot be built.
        RuntimeError: the place was never reached.
    """
    from drawbar.experiment.trial import Trial  # it brings the whole machine along, which plain runs do not need

    trial = Trial(Configuration.model_validate(tomllib.loads(task.configuration)), task.seed)
    for each in task.alterations:
        each.apply(trial)
    trial.approach()
    return trial


def watched_trial(trial: "Trial", task: Task) -> Result:
    """Return what comes of a trial at its fault's place."""
    if task.fault:
        task.fault.apply(trial)
    trial.watch()
    log = trial.log()
    return Result(
        source=source_digest(),
        metrics=compute_metrics(log, true_path_errors(log)),
        columns={name: trial.column(name.removeprefix(_WATCH)) for name in task.columns},
    )


def _simulate(task: Task) -> tuple[RunLog, RecordedDeviation | None]:
    """Drive, and keep standard deviations where the task asks for any."""
    configuration = Configuration.model_validate(tomllib.loads(task.configuration))
    with Simulation(configuration, task.seed) as simulation:
        for alteration in task.alterations:
            alteration.apply(simulation)
        if not any(name.startswith(DEVIATION) for name in task.columns):
            return simulation.log(), None
        deviations = RecordedDeviation(simulation.autopilot, configuration)
        log = simulation.log(deviations.keep)
        return log, deviations


def _column(log: RunLog, errors: Bodies[PathErrors], deviations: RecordedDeviation | None, name: str) -> Floats:
    if deviations and name.startswith(DEVIATION):
        return deviations.column(name.removeprefix(DEVIATION))
    quantity, _, body = name.partition(".")
    if quantity in ("error", "progress"):
        values: Floats = getattr(getattr(errors, body), quantity)
        return values
    return log.column(name)


def digest(*texts: str) -> str:
    """Return a short hash of all texts."""
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:20]
