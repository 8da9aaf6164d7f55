"""The sections `path` and `guidance` of a configuration: what to drive, and how it becomes references."""

from dataclasses import dataclass
from typing import Annotated, Literal, Self

from pydantic import Field, field_validator, model_validator

from drawbar.settings import Length, NonNegativeLength, Positive, Settings

TrackLength = Annotated[float, Field(gt=0.0, le=1000.0)]
"""A length of the figure-eights, m; longer tracks are recorded lines."""


class PathSettings(Settings):
    """What to drive: a recorded line, or else figure-eights."""

    file: str = ""
    """AgOpenGPS field folder, CSV or GeoJSON file, relative to the configuration file that names it, or for --path
    and --set to the working directory; empty: the figure-eights"""
    track: str = ""
    """name of the line, where the file holds several"""
    extension: Annotated[float, Field(ge=0.0, le=10_000.0)] = 0.0
    """how far an A-B line of AgOpenGPS, which has no end, goes beyond its points, m; 0: to the field's boundary, or
    100 m where the field has none"""
    offset: Annotated[float, Field(ge=-100.0, le=100.0)] = 0.0
    """how far to the left of the line is driven (right: negative), m"""
    working_width: Annotated[float, Field(ge=0.0, le=60.0)] = 0.0
    """between parallel lines beside this one, which the operator may choose while the vehicle is not steered, m. 0:
    there is only this line"""
    beyond_boundary: Annotated[float, Field(ge=0.0, le=10_000.0)] = 1.0
    """how far `drawbar drive` may steer beyond the field's boundary, where the line's file holds one, m: lines that lie
    along it are driven"""
    radii: Annotated[tuple[TrackLength, ...], Field(strict=False, min_length=1)] = (10.0, 8.0, 6.67)
    """of the figure-eights, one after the other, m"""
    straight_length: TrackLength = 20.0
    """of the figure-eights' straights, m"""

    @property
    def both_ways(self) -> bool:
        """Whether it is driven in the direction in which the vehicle faces, as recorded and parallel lines are."""
        return bool(self.file) or self.working_width > 0.0

    @field_validator("file", "track")
    @classmethod
    def _unicode(cls, name: str) -> str:
        try:
            name.encode()
        except UnicodeEncodeError as error:
            raise ValueError(f"{name!r} is not Unicode, and a configuration is; rename it") from error
        if "\0" in name:
            raise ValueError("holds a zero character, which no name of a file has; leave it out")
        return name

    @model_validator(mode="after")
    def _track_of_a_file(self) -> Self:
        if self.track and not self.file:
            raise ValueError(f"track = {self.track!r} is given without a file; give path.file too, or leave track out")
        return self


@dataclass(frozen=True, slots=True, kw_only=True)
class LineLimits:
    """What a recorded line must keep to once it is made drivable: struct drawbar_line_limits."""

    curvature: float
    """1/m"""
    curvature_rate: float
    """1/m²"""
    tolerance: float
    """largest distance of a recorded point from the path, m"""


class GuidanceSettings(Settings):
    """How the path is turned into references for the controllers."""

    mode: Literal["preview", "look_ahead"] = "preview"
    """preview: stage j at the closest point plus j V dt; look_ahead: the paper's references"""
    look_ahead: NonNegativeLength = 1.6
    """distance of the paper's references ahead of the closest point, m"""
    turning_room: Length = 4.0
    """how far beside the path the turns may lead by which a vehicle that faces away gets onto it in preview mode, m"""
    window_behind: NonNegativeLength = 1.0
    """how far behind the last progress the closest point is searched, m"""
    window_ahead: Length = 3.0
    """how far ahead of the last progress the closest point is searched, m"""
    maximum_start_distance: Positive = 5.0
    """largest distance of the tractor from where a run begins on the path, m"""
    path_tolerance: Length = 0.50
    """largest deviation of a recorded point from the drivable path, m"""
    curvature_rate_limit: Positive = 0.3
    """largest change of curvature per metre of recorded lines and of turns onto the path, so that the steering can
    follow, 1/m²"""

    def line_limits(self, curvature: float) -> LineLimits:
        """Return those of a recorded line for a vehicle that turns so tightly, 1/m."""
        return LineLimits(curvature=curvature, curvature_rate=self.curvature_rate_limit, tolerance=self.path_tolerance)
