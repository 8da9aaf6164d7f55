"""Views of the compiled solver's memory: arrays by name, guarded against being replaced instead of written."""

import numpy as np

from drawbar.errors import SolverError
from drawbar.geometry import Floats


class Guarded:
    """A class whose arrays are memory of a compiled solver: binding another array to such a name is an error."""

    def __setattr__(self, name: str, value: object) -> None:
        """Set an attribute, but not another array in place of one that is the solver's own memory."""
        present = self.__dict__.get(name)
        if isinstance(present, np.ndarray | StageBounds) and value is not present:
            raise SolverError(
                f"{name} = ... would bind another array of which the compiled solver knows nothing; "
                f"write into its own: {name}[...] = ..."
            )
        super().__setattr__(name, value)


class StageBounds(dict[str, Floats]):
    """One side of the bounds, by name of a variable: (stages,) arrays in the solver's own memory, to read and write."""

    def __missing__(self, name: str) -> Floats:
        """Refuse a name without a bound, with the names that have one."""
        raise SolverError(
            f"No bound on {name!r} was declared; there are {', '.join(self) or 'none'}. To set one while the solver "
            f"runs, declare it in the problem, with infinite ends at first."
        )

    def __setitem__(self, name: str, value: object) -> None:
        """Refuse to replace an array."""
        raise SolverError(f"Write into the solver's own memory: [{name!r}][...] = ...")

    def update(self, *_: object, **__: object) -> None:
        """Raise SolverError: arrays are not replaced."""
        raise SolverError("Write into the solver's own memory, one bound after the other: [name][...] = ...")


def read_only(array: Floats) -> Floats:
    """Return a view that cannot be written to."""
    view = array.view()
    view.flags.writeable = False
    return view
