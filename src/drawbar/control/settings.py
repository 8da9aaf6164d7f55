"""The controller and tube sections of a configuration."""

from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, Field

from drawbar.settings import Horizon, Length, NonNegative, NonNegativeLength, Positive, PositiveAngle, Settings, Share


class Coupling(StrEnum):
    """What the trailer's controller knows of the tractor's motion (g_2 in equation nonlinearmodel)."""

    NEGLECTED = "neglected"
    """nothing: g_2 = 0, as in the paper"""
    MEASURED = "measured"
    """computed from local measurements and held over the horizon; no exchange between controllers"""
    FOLLOWING = "following"
    """its line, and that it comes back to it from where local measurements show it; no exchange between controllers"""
    PLANNED = "planned"
    """the tractor controller's plan; distributed"""


CouplingSetting = Annotated[Coupling, Field(strict=False)]


def _of_angles(coupling: Coupling) -> Coupling:
    if coupling is Coupling.FOLLOWING:
        raise ValueError("is known to the articulated model only; give 'neglected', 'measured' or 'planned'")
    return coupling


Structure = Literal["decentralised", "centralised"]
"""One small problem for each body, or one large problem for both (the paper's CeNMPC), which does not
need `coupling` and `sharing`"""


class TricycleControllerSettings(Settings):
    """The paper's nominal controllers (section IV-B): weights on position and on the change of steering."""

    model: Literal["tricycle"]
    structure: Structure = "decentralised"
    """a problem for each body, or one for both, which does not need coupling and sharing"""
    horizon: Horizon = 20
    """N, samples"""
    coupling: Annotated[CouplingSetting, AfterValidator(_of_angles)] = Coupling.NEGLECTED
    """what the trailer's controller knows of the tractor's motion"""
    position_weight: NonNegative = 1.0
    """Q, 1/m²"""
    steering_weight: Positive = 10.0
    """R, on the distance to the last measured steering, 1/rad²"""
    terminal_weight: NonNegative = 10.0
    """S, on the position at the end of the horizon, 1/m²"""


class ArticulatedTractorWeights(Settings):
    """Weights of the tractor's stage cost."""

    lateral: Positive = 75.0
    """1/m²"""
    heading: NonNegative = 55.0
    """1/rad²; against the lateral weight it sets the length within which an offset is taken back, sqrt(55/75) m"""
    steering: NonNegative = 4.0
    """on the distance to the curvature feed-forward, 1/rad²"""
    steering_rate: Positive = 1.0
    """up to 1 m/s; divided by the speed above, s²/rad²"""


class ArticulatedTrailerWeights(Settings):
    """Weights of the trailer's stage cost."""

    lateral: Positive = 80.0
    """1/m²"""
    steering: NonNegative = 0.002
    """1/rad²"""
    steering_rate: Positive = 1.0
    """s²/rad²"""


class SharingSettings(Settings):
    """How far the tractor leaves its line for a trailer whose steering is exhausted; all zero: not at all."""

    share: Share = 0.7
    """of the trailer's steady error beyond `accepted_error`, what the tractor takes over by going to the other side"""
    accepted_error: NonNegativeLength = 0.04
    """steady error that stays with the trailer, m"""
    widening: NonNegative = 0.05
    """how far the tractor keeps outside a curve per curvature, m²: 5 mm at 0.1 1/m"""


class ArticulatedControllerSettings(Settings):
    """The product's nominal controllers: lateral errors along a preview of the path."""

    model: Literal["articulated"]
    structure: Structure = "decentralised"
    """a problem for each body, or one for both, which does not need coupling and sharing"""
    horizon: Horizon = 20
    """N, samples"""
    coupling: CouplingSetting = Coupling.FOLLOWING
    """what the trailer's controller knows of the tractor's motion"""
    yaw_rate_lag: Positive = 0.9
    """time constant of the filter on the tractor's measured yaw rate before it is held over the horizon, where the
    coupling is "measured": noise would be held over the trailer's preview, s"""
    return_length: Positive = 0.9
    """way within which the tractor is taken to come back to its line, where the coupling is "following", m"""
    sharing: SharingSettings = SharingSettings()
    """Decentralised structure only"""
    tractor: ArticulatedTractorWeights = ArticulatedTractorWeights()
    trailer: ArticulatedTrailerWeights = ArticulatedTrailerWeights()


class TrailerProportionalIntegral(Settings):
    """The textbook's way to steer a trailer: PI on its lateral error. Both gains zero: the joint is held straight."""

    proportional: NonNegative = 0.0
    """rad/m"""
    integral: NonNegative = 0.0
    """rad/(m s)"""


class PurePursuitSettings(Settings):
    """Pure pursuit (Coulter 1992) for the tractor, a PI controller on the lateral error for the trailer."""

    model: Literal["pure_pursuit"]
    horizon: Horizon = 20
    """samples of the path ahead that the guidance hands over; beyond them it goes on in an arc"""
    look_ahead: Length = 1.3
    """distance of the pursued point along the path, m"""
    trailer: TrailerProportionalIntegral = TrailerProportionalIntegral()


class LqrSettings(Settings):
    """Linear quadratic regulator of the tractor in path coordinates, PI on the lateral error for the trailer."""

    model: Literal["lqr"]
    horizon: Horizon = 20
    """samples of the path ahead that the guidance hands over"""
    lateral: Positive = 1.0
    """weight of the lateral error, 1/m²"""
    heading: NonNegative = 3.0
    """weight of the heading error, 1/rad²"""
    steering: Positive = 0.3
    """weight of the steering beyond the curvature's, 1/rad²"""
    lead: NonNegative = 0.4
    """how far ahead the path's curvature is fed forward, since the steering lags, s"""
    approach_angle: PositiveAngle = 0.5
    """steepest angle at which the path is approached from afar, rad"""
    trailer: TrailerProportionalIntegral = TrailerProportionalIntegral()


def is_module_and_class(place: str) -> bool:
    """Return whether a text has the form MODULE:CLASS."""
    module, separator, name = place.partition(":")
    return bool(separator) and name.isidentifier() and all(part.isidentifier() for part in module.split("."))


def _module_and_class(place: str) -> str:
    if not is_module_and_class(place):
        raise ValueError("is not MODULE:CLASS, for example my_package.control:MyController")
    return place


class ExternalControllerSettings(Settings):
    """A controller of the user's own; `controller.model = "my_package:MyController"` is the short form."""

    model: Literal["external"]
    implementation: Annotated[str, AfterValidator(_module_and_class)]
    """MODULE:CLASS of a subclass of drawbar.Controller, on Python's path or in the working directory"""
    horizon: Horizon = 20
    """samples of the path ahead that the guidance hands over"""
    gains: Mapping[str, float] = {}
    """numbers that the controller is given"""


class Nominal(StrEnum):
    """What the ancillary law holds the vehicle to: the nominal state x̄ of the tube."""

    PREDICTED = "predicted"
    """what was predicted for now one sample ago; the nominal problem starts at the estimate"""
    PROPAGATED = "propagated"
    """the nominal model running on its own (Mayne 2004)"""
    OPTIMISED = "optimised"
    """a decision variable within the invariant set around the estimate (Mayne 2005, 2006)"""


class AncillaryGain(Settings):
    """One body's K: command per error against the nominal state, in its heading's frame."""

    lateral: float = 0.0
    """rad/m"""
    yaw: float = 0.0
    """rad/rad"""
    articulation: float = 0.0
    """of the articulated trailer, in place of lateral and yaw, rad/rad"""
    steering: float = 0.0
    """where the model has the steering angle as a state, rad/rad"""


Declared = Mapping[str, NonNegative]
"""bounds by name; `drawbar tube CONFIG` lists the names and units that a model has"""


DECLARED_SECTIONS = ("disturbances", "estimation", "increments")
"""of BodyTubeSettings, each of which declares bounds"""


class BodyTubeSettings(AncillaryGain):
    """One body's ancillary gain, and the bounds from which its invariant set is computed; none declared, no set."""

    lqr: Mapping[str, Positive] = {}
    """weights of states and `command` from which the gain follows instead of being given, 1/unit²"""
    disturbances: Declared = Field(default_factory=dict)
    """largest error, over one sample, of what the nominal model assumes, in the unit of each"""
    estimation: Declared = Field(default_factory=dict)
    """largest error of the estimate of each state, in its unit"""
    increments: Declared = Field(default_factory=dict)
    """largest part of a new estimate that the last one did not foretell, by state, in its unit; where not given it
    follows from `estimation` as if the errors of successive estimates had nothing to do with each other"""
    kept_rate: Share = 0.0
    """part of the steering rate that plans keep: where the declared bounds leave less, `disturbances.steering_rate`
    counts as what the cylinder then falls short; articulated models only"""


class TubeOperatingRange(Settings):
    """Where the errors are linearised: at the middle of these ranges, and allowing for all of them."""

    speed: Annotated[tuple[Positive, Positive], Field(strict=False)] = (0.85, 1.05)
    """speed over ground per set speed"""
    tractor_slip: Annotated[tuple[Positive, Positive], Field(strict=False)] = (0.8, 1.0)
    """kappa"""
    trailer_slip: Annotated[tuple[Positive, Positive], Field(strict=False)] = (0.8, 1.0)
    """eta, where the model has it"""


class TubeSettings(Settings):
    """The ancillary laws u = ū + K (x - x̄), and what the invariant sets are computed from."""

    former_keys: ClassVar[Mapping[str, str]] = {"work": "operating_range"}
    nominal: Annotated[Nominal, Field(strict=False)] = Nominal.PREDICTED
    """what the ancillary law holds the vehicle to"""
    tighten: bool = True
    """let the nominal problems keep to what the sets leave of their bounds; false: to see what that is worth"""
    tractor: BodyTubeSettings = BodyTubeSettings()
    trailer: BodyTubeSettings = BodyTubeSettings()
    operating_range: TubeOperatingRange = TubeOperatingRange()
