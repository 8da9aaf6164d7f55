"""A controller of the user's own in the place of the product's: `controller.model = "my_package:MyController"`.

It takes part in the whole control step: the estimator before it, the gate and the run monitor behind it, the records.
"""

import ctypes
import importlib
import importlib.util
import inspect
import sys
import traceback
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from drawbar.codegen import Unit, Workspace
from drawbar.control.settings import ExternalControllerSettings
from drawbar.errors import ConfigurationError
from drawbar.signals import BodyReference, Estimate, Reference
from drawbar.signals.layout import Layout
from drawbar.vehicle.parameters import VehicleParameters

_ESTIMATE = Layout(Estimate)
_HEAD = 6
"""numbers of struct drawbar_body_reference before the pointer to its samples: progress, lateral error, closest point"""


class Controller(ABC):
    """Steers both bodies; a subclass is named in a configuration and made once for each run."""

    def __init__(self, vehicle: VehicleParameters, sample_time: float, gains: dict[str, float]) -> None:
        """Take what is known before a run.

        Args:
            vehicle: lengths and limits.
            sample_time: s.
            gains: the configuration's `controller.gains`.
        """
        self.vehicle, self.sample_time, self.gains = vehicle, sample_time, gains

    @abstractmethod
    def command(self, estimate: Estimate, reference: Reference) -> tuple[float, float]:
        """Return both steering angles, rad: of the front wheels and of the actuated joint, left positive.

        They are clipped to the vehicle's limits. What is not finite is refused by the gate: the last command is
        repeated for a second, then the vehicle stops.

        Args:
            estimate: where the vehicle is when the command begins to act.
            reference: the path at the closest points and over the horizon.
        """


class External:
    """What joins a Controller to the control step: C calls it back; its exceptions wait for the caller of the step."""

    def __init__(self, controller: Controller, horizon: int) -> None:
        """Take the controller and the number of stages of its references."""
        self._controller, self._horizon = controller, horizon
        address, angles = ctypes.c_void_p, ctypes.POINTER(ctypes.c_double)
        self.callback = ctypes.CFUNCTYPE(None, address, address, address, angles)(self._called)
        self.error: BaseException | None = None
        """what the newest call raised"""

    def _called(self, estimate: int, tractor: int, trailer: int, angles: Any) -> None:
        try:
            known = _ESTIMATE.unpack(ctypes.string_at(estimate, _ESTIMATE.size))
            reference = Reference(time=known.time, tractor=self._reference(tractor), trailer=self._reference(trailer))
            _put(angles, self._controller.command(known, reference))
        except Exception as error:  # an exception cannot pass through C
            kind = type(self._controller)
            self.error = _failure(f"{kind.__module__}:{kind.__name__}", error, kind.command)
        except BaseException as error:
            self.error = error

    def _reference(self, address: int) -> BodyReference:
        head = np.ctypeslib.as_array((ctypes.c_double * _HEAD).from_address(address)).copy()
        samples = ctypes.c_void_p.from_address(address + 8 * _HEAD).value or 0
        count = 4 * (self._horizon + 1)
        return BodyReference(
            progress=float(head[0]),
            lateral_error=float(head[1]),
            closest=head[2:],
            samples=np.ctypeslib.as_array((ctypes.c_double * count).from_address(samples)).reshape(-1, 4).copy(),
        )


def _put(angles: Any, returned: Any) -> None:
    """Put what a command returned into two doubles; TypeError: it is no pair of numbers."""
    try:
        angles[0], angles[1] = returned
    except (TypeError, ValueError) as error:
        raise TypeError(f"command() returned {returned!r:.100}, not two steering angles in rad") from error


@dataclass(frozen=True, slots=True, kw_only=True)
class ExternalUnit(Unit):
    """The unit that calls a controller of the user's own."""

    external: External


def external_unit(vehicle: VehicleParameters, settings: ExternalControllerSettings, sample_time: float) -> ExternalUnit:
    """Return the unit that calls a controller of the user's own, which is made here.

    Raises:
        ConfigurationError: there is no such class, it is no Controller, or it cannot be made.
    """
    kind = _class(settings.implementation)
    try:
        controller = kind(vehicle, sample_time, dict(settings.gains))
    except Exception as error:
        raise _failure(settings.implementation, error, kind) from error
    external = External(controller, settings.horizon)
    address = ctypes.cast(external.callback, ctypes.c_void_p).value or 0

    def configure(workspace: Workspace) -> None:
        workspace.array("joint_sign")[:] = vehicle.joint_sign
        workspace.array("call").view(np.uint64)[:] = address

    source = f'#define N {settings.horizon}\n#include "external.h"\n'
    return ExternalUnit(name="controller", source=source, configure=configure, simulation_only=True, external=external)


def _failure(place: str, error: Exception, failed: object = None) -> ConfigurationError:
    """Return what a failure of the controller at MODULE:CLASS is for its user: what failed, and at which line.

    Args:
        place: MODULE:CLASS.
        error: what came out.
        failed: the user's class or function that was called; None: its module did not load.
    """
    frames = [(frame.filename, frame.lineno) for frame in traceback.extract_tb(error.__traceback__)]
    if isinstance(error, SyntaxError):
        frames.append((error.filename or "", error.lineno))
    elif failed is not None:
        declared = _declared(failed)
        frames = [declared, *(frame for frame in frames if Path(declared[0]).parent in Path(frame[0]).parents)]
    file, line = frames[-1]
    return ConfigurationError(
        f'controller.model = "{place}": {type(error).__name__}: {error} ({file}:{line}); mend the controller there.'
    )


def _declared(of: Any) -> tuple[str, int | None]:
    """Return the file and the line at which a class or function of the user's begins."""
    try:
        return inspect.getsourcefile(of) or "", inspect.getsourcelines(of)[1]
    except (OSError, TypeError):
        return sys.modules[of.__module__].__file__ or "", None


def written_source(place: str) -> str:
    """Return the text of the package of MODULE:CLASS, or of its module and those beside it; empty: there is none."""
    module = place.partition(":")[0]
    with _from_here():
        try:
            spec = importlib.util.find_spec(module.partition(".")[0])
        except (ImportError, ValueError):
            spec = None
    if spec is None or spec.origin is None:
        return ""
    folder = Path(spec.origin).parent
    files = folder.rglob("*.py") if spec.submodule_search_locations else folder.glob("*.py")
    return "\0".join(file.read_text("utf-8", errors="replace") for file in sorted(files))


@contextmanager
def _from_here() -> Iterator[str]:
    """Let modules of the working directory be found; yields it."""
    here = str(Path.cwd())
    added = [] if here in sys.path else [here]
    sys.path.extend(added)
    try:
        yield here
    finally:
        for each in added:
            sys.path.remove(each)


def _class(place: str) -> Callable[..., Controller]:
    """Return the class that stands at MODULE:CLASS, on Python's path or in the working directory."""
    module, _, name = place.partition(":")
    with _from_here() as here:
        try:
            kind = getattr(importlib.import_module(module), name)
        except (ImportError, AttributeError) as error:
            raise ConfigurationError(
                f'controller.model = "{place}": {error}; give MODULE:CLASS of a module on Python\'s path or in the '
                f"working directory {here}."
            ) from error
        except Exception as error:
            raise _failure(place, error) from error
    if not (isinstance(kind, type) and issubclass(kind, Controller)):
        raise ConfigurationError(f'controller.model = "{place}": {name} is not a subclass of drawbar.Controller.')
    return kind
