"""Store of fields: a GeoJSON file for each, in one folder."""

from dataclasses import replace
from pathlib import Path

from drawbar.errors import PathError, StorageError
from drawbar.fields.field import Field, FieldLine, plain_name
from drawbar.fields.formats import geojson

_SUFFIX = ".geojson"


class FieldStore:
    """A folder of fields."""

    def __init__(self, folder: Path) -> None:
        """Take the folder; it is made when the first field is saved."""
        self.folder = folder

    def names(self) -> list[str]:
        """Return the names of all fields in it, sorted."""
        return sorted(each.stem for each in self.folder.glob(f"*{_SUFFIX}"))

    def load(self, name: str) -> Field:
        """Return a field by one of these names; raises PathError where there is none, or its file is damaged."""
        if name not in self.names():
            raise PathError(
                f"{self.folder}: has no field {name!r}; its fields are: {', '.join(self.names()) or 'none'}"
            )
        (field,) = geojson.read(self.folder / f"{name}{_SUFFIX}")
        return replace(field, name=name)

    def add(self, field: Field) -> str:
        """Keep a new field; return its name, with a number where the name is taken. Raises StorageError."""
        taken = self.names()
        numbered = (f"{field.name} ({number})" for number in range(2, len(taken) + 3))
        name = next(each for each in (field.name, *numbered) if each not in taken)
        self._write(replace(field, name=name))
        return name

    def add_line(self, name: str, line: FieldLine) -> str:
        """Add a line to a field; return its name, with a number where the name is taken. Raises as load() and add()."""
        field = self.load(name)
        taken = [each.name for each in field.lines]
        plain = plain_name(line.name) or f"line {len(taken) + 1}"  # as it is read again
        numbered = (f"{plain} ({number})" for number in range(2, len(taken) + 3))
        unique = next(each for each in (plain, *numbered) if each not in taken)
        self._write(replace(field, lines=(*field.lines, replace(line, name=unique))))
        return unique

    def _write(self, field: Field) -> None:
        """Write a field's file, as a whole or not at all."""
        new = self.folder / f"{field.name}{_SUFFIX}.new"
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            new.write_bytes(geojson.write(field))
            new.replace(self.folder / f"{field.name}{_SUFFIX}")
        except OSError as error:
            raise StorageError(f"{self.folder}: the field cannot be kept there ({error.strerror})") from error
