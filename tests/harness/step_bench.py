"""The step of an exported library, between real gate and run monitor and components that do what a measurement says."""

import ctypes
from pathlib import Path

import numpy as np

from drawbar.guidance.path import PATH_UNIT
from drawbar.signals import Diagnostics, Estimate, Flag, Measurement, Status
from drawbar.signals.layout import Layout

HERE = Path(__file__).parents[1] / "step"
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")
SAMPLE, PATIENCE, ENDURANCE, LENGTH = 0.2, 1.0, 3.0, 10.0
NAMES = (
    *("ALIGNMENT", "ESTIMATOR", "GUIDANCE", "PREDICTOR", "TRACTOR", "TRAILER"),
    *("TRACTOR_LAW", "TRAILER_LAW", "GATE", "RUN_MONITOR", "SANITY"),
)
PARTS = "\n".join(f"#define DRAWBAR_{name}_SIZE 256" for name in (*NAMES, "WORK"))
UNITS = {
    "drawbar_size.h": f"#define DRAWBAR_STATE_DOUBLES 544\n#define DRAWBAR_SAMPLE_TIME {SAMPLE}\n",
    "drawbar_components.h": f"{PARTS}\n#define DRAWBAR_DEAD_TIME\n"
    f"#define DRAWBAR_STEP_SETTINGS {{{SAMPLE}, 1.0, 1.0, 0.5, {PATIENCE}, {ENDURANCE}, 0.3, 0.03, 0.03, 16.0}}\n"
    '#define DRAWBAR_VERSION "of this test"\n',
    "path.c": PATH_UNIT,
    "step.c": '#include "step.h"\n',
    "gate.c": """
#define UNIT(name) drawbar_gate_##name
#include <string.h>
#include "gate.h"
int UNIT(initialise)(struct component *component)
{
    const struct component gate = {
        .limits = {0.5, 0.4}, .signs = {1.0, 1.0}, .rates = {1.0, 1.0}, .lag = 0.1, .sample_time = 0.2,
        .speed_limit = 1.0, .patience = 1.0, .repeats = 4
    };
    memcpy(component, &gate, sizeof gate);
    return 0;
}
""",
    "run_monitor.c": """
#define UNIT(name) drawbar_run_monitor_##name
#include <string.h>
#include "run_monitor.h"
int UNIT(initialise)(struct component *component)
{
    const struct component monitor = {.lost = 5.0, .blind = 2.0};
    memcpy(component, &monitor, sizeof monitor);
    return 0;
}
""",
    "components.c": (HERE / "components.c").read_text(),
}
STATUS = {member.name: member.value for kind in (Status, Flag) for member in kind}
NAMES_OF = {
    "time": "time",
    "tractor_x": "progress",
    "tractor_y": "lateral_error",
    "trailer_x": "controllers",
    "trailer_y": "estimator",
    "hitch_angle": "fixes",
    "speed": "guidance",
    "tractor_steering": "tractor_steering",
    "trailer_steering": "trailer_steering",
}
"""how the components here read a measurement"""
MEASURED = tuple(NAMES_OF.values())
MEASUREMENT, ESTIMATE, DIAGNOSTICS = Layout(Measurement), Layout(Estimate), Layout(Diagnostics)


class Driver:
    """A state with a straight path, and everything a caller does with it."""

    def __init__(self, library):
        self.library = library
        self.state = (ctypes.c_double * 544)()
        arc = np.linspace(0.0, LENGTH, 41)
        self.nodes = np.column_stack([arc, arc, 0.0 * arc, 0.0 * arc])
        self.command = (ctypes.c_double * 4)()
        self.time = 100.0
        assert library.drawbar_init(self.state) == 0
        assert self.set_path() == 0

    def set_path(self):
        return self.library.drawbar_set_path(self.state, ctypes.c_void_p(self.nodes.ctypes.data), len(self.nodes))

    def measurement(self, *, elapsed=SAMPLE, **values):
        self.time += elapsed
        known = {**dict.fromkeys(MEASURED, 0.0), "time": self.time, **values}
        given = MEASUREMENT.buffer()
        MEASUREMENT.pack(given, Measurement(**{name: known[alias] for name, alias in NAMES_OF.items()}))
        return given

    def feedback(self, **values):
        return self.library.drawbar_feedback(self.state, self.measurement(**values), self.command)

    def prepare(self):
        return self.library.drawbar_prepare(self.state)

    def step(self, **values):
        """Return status and command (time, both steering angles, speed) of one step."""
        status = self.library.drawbar_step(self.state, self.measurement(**values), self.command)
        return status, list(self.command)

    def calls(self):
        made = ctypes.c_char * 64
        return made.in_dll(self.library, "calls")


def statuses(driver, count, **values):
    return [driver.step(**values)[0] for _ in range(count)]


def told_by(driver):
    told = DIAGNOSTICS.buffer()
    assert driver.library.drawbar_get_diagnostics(driver.state, told) == 0
    return DIAGNOSTICS.unpack(told)
