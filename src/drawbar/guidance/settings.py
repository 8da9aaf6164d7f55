"""The guidance section of a configuration."""

from typing import Literal

from drawbar.settings import Length, NonNegativeLength, Positive, Settings


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
