"""Signals: what flows through one control step: frozen, timestamped, SI units, ENU, counter-clockwise.

Each signal is declared once, in this folder, and each status in `statuses.py`: `c_headers.py` prints the C structures,
enumerations and texts from these declarations (`drawbar_signals.h`, `signals.h`), `layout.py` moves values between the
two languages. All signals are imported from here.
"""

from drawbar.signals.inner import (
    BodyPlace,
    BodyPlan,
    BodyReference,
    BodySteering,
    Places,
    Plan,
    RecordedPlace,
    Reference,
)
from drawbar.signals.public import (
    Actuation,
    BodyActuation,
    BodyDiagnostics,
    Command,
    Diagnostics,
    Estimate,
    Measurement,
    PathNode,
    Pose,
)
from drawbar.signals.quantities import (
    Array,
    Metres,
    MetresPerSecond,
    Quantity,
    Radians,
    RadiansPerSecond,
    Ratio,
    Seconds,
)
from drawbar.signals.record import SolveTimes, StepRecord, Truth
from drawbar.statuses import (
    FixQuality,
    FixStatus,
    Flag,
    GateVerdict,
    GuidanceStatus,
    MonitorVerdict,
    SolverStatus,
    Status,
)

__all__ = [
    "Actuation",
    "Array",
    "BodyActuation",
    "BodyDiagnostics",
    "BodyPlace",
    "BodyPlan",
    "BodyReference",
    "BodySteering",
    "Command",
    "Diagnostics",
    "Estimate",
    "FixQuality",
    "FixStatus",
    "Flag",
    "GateVerdict",
    "GuidanceStatus",
    "Measurement",
    "Metres",
    "MetresPerSecond",
    "MonitorVerdict",
    "PathNode",
    "Places",
    "Plan",
    "Pose",
    "Quantity",
    "Radians",
    "RadiansPerSecond",
    "Ratio",
    "RecordedPlace",
    "Reference",
    "Seconds",
    "SolveTimes",
    "SolverStatus",
    "Status",
    "StepRecord",
    "Truth",
]
