"""A compiled recurrence x+ = F(x, u, c): a CasADi function that a C loop applies step after step."""

import ctypes
import re

import casadi as ca
import numpy as np

from drawbar.codegen.cache import build
from drawbar.codegen.library import load
from drawbar.geometry import Floats

_UNIT = """
{casadi}
void run(const double *state, const double *inputs, const double *constants, double *states, long long count)
{{
    double w[{sz_w} + 1];
    for (long long k = 0; k < count; ++k) {{
        const double *arguments[] = {{state, inputs + {nu} * k, constants}};
        double *results[] = {{states + {nx} * k}};
        {name}(arguments, results, 0, w, 0);
        state = states + {nx} * k;
    }}
}}
"""


class CompiledRecurrence:
    """Fill `state`, `inputs` and `constants`, call, read `states`; nothing is allocated per call.

    The number of steps is data: it compiles nothing.
    """

    def __init__(self, function: ca.Function, steps: int) -> None:
        """Compile the function through CasADi's own C generator.

        Args:
            function: F of x (nx, 1), u (nu, 1) and c (nc, 1), from SX expressions.
            steps: of one call.

        Raises:
            CompilerError: no compiler, or it refused the code.
        """
        nx, nu, nc = (function.numel_in(i) for i in range(3))
        self.state: Floats = np.zeros(nx)
        """(nx,) before the first step"""
        self.inputs: Floats = np.zeros((steps, nu))
        """(steps, nu) of each step"""
        self.constants: Floats = np.zeros(nc)
        """(nc,) the same for all steps"""
        self.states: Floats = np.zeros((steps, nx))
        """(steps, nx) after each step"""
        self._run = load(build(function.name(), _source(function))).run
        self._run.restype = None
        arrays = (self.state, self.inputs, self.constants, self.states)
        self._arguments = (*(ctypes.c_void_p(each.ctypes.data) for each in arrays), ctypes.c_longlong(steps))

    def __call__(self) -> None:
        """Take the steps."""
        self._run(*self._arguments)


def _source(function: ca.Function) -> str:
    x, u, c = function.sx_in()
    dense = ca.Function(function.name(), [x, u, c], [ca.densify(function(x, u, c))])
    generator = ca.CodeGenerator(f"{function.name()}.c", {"with_header": False})
    generator.add(dense)
    text = re.sub(r"/\* This file was automatically.*?\*/", "", generator.dump(), flags=re.DOTALL)  # it has a date
    return _UNIT.format(casadi=text, name=function.name(), nx=x.numel(), nu=u.numel(), sz_w=dense.sz_w())
