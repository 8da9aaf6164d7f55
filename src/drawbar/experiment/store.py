"""Store of finished results on disk: one file each, whole or not there, found again by the key of its task."""

import os
import shutil
from pathlib import Path

import msgspec

from drawbar.errors import DrawbarError
from drawbar.experiment.task import Result, Task, decode_result, encode_result, source_digest
from drawbar.experiment.writing import writing


class ResultStore:
    """The results that the present drawbar has measured so far."""

    def __init__(self, folder: Path) -> None:
        """Open or create the folder; results of another version of drawbar's code are deleted from it.

        Raises DrawbarError when the folder cannot be written.
        """
        self._folder = folder / source_digest()
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise DrawbarError(
                f"{folder}: results cannot be kept there ({error.strerror}); make it writable."
            ) from error
        for stale in folder.iterdir():
            if stale != self._folder:
                shutil.rmtree(stale, ignore_errors=True)

    def get(self, task: Task) -> Result | None:
        """Return the result of a task, or None when it has not been measured."""
        try:
            return decode_result(self._file(task).read_bytes())
        except (FileNotFoundError, msgspec.MsgspecError):
            return None

    def put(self, task: Task, result: Result) -> None:
        """Keep the result of a task; a process killed meanwhile leaves no half of it.

        Raises StorageError: it cannot be written.
        """
        file = self._file(task)
        part = file.with_suffix(f".{os.getpid()}")
        with writing(file):
            self._folder.mkdir(parents=True, exist_ok=True)  # drawbar with other code may have deleted it meanwhile
            try:
                part.write_bytes(encode_result(result))
                os.replace(part, file)
            finally:
                part.unlink(missing_ok=True)

    def _file(self, task: Task) -> Path:
        return self._folder / f"{task.key}.msgpack"
