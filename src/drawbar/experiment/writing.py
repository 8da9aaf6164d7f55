"""Writing an experiment's files: where that fails, the error names the file, the cause and what to do."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from drawbar.errors import StorageError


@contextmanager
def writing(file: Path) -> Iterator[None]:
    """Write a file in this context.

    Raises StorageError: it cannot be written.
    """
    try:
        yield
    except OSError as error:
        raise StorageError(
            f"{file}: cannot be written ({error.strerror}); free space or make it writable, then the same command goes "
            f"on from the runs that are finished."
        ) from error
