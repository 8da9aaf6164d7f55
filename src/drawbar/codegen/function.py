"""Compile a plain CasADi function and call it on preallocated arrays."""

import ctypes
import re

import casadi as ca
import numpy as np

from drawbar.codegen.cache import build
from drawbar.codegen.library import load
from drawbar.geometry import Floats


class CompiledFunction:
    """A CasADi function as machine code: fill `inputs`, call, read `outputs`; nothing is allocated per call."""

    def __init__(self, function: ca.Function) -> None:
        """Compile the function through CasADi's own C generator.

        Args:
            function: any function with real inputs and outputs.

        Raises:
            CompilerError: no compiler, or it refused the code.
        """
        name = function.name()
        generator = ca.CodeGenerator(f"{name}.c", {"with_header": False})
        generator.add(_dense(function))
        library = load(build(name, _without_dates(generator.dump())))
        self.inputs: tuple[Floats, ...] = tuple(np.zeros(function.numel_in(i)) for i in range(function.n_in()))
        """one flat array per argument, column-major, dense"""
        self.outputs: tuple[Floats, ...] = tuple(np.zeros(function.numel_out(i)) for i in range(function.n_out()))
        """one flat array per result, column-major, dense"""
        compiled = getattr(library, name)
        compiled.restype = ctypes.c_int
        work = [ctypes.c_longlong() for _ in range(4)]
        getattr(library, f"{name}_work")(*(ctypes.byref(w) for w in work))
        n_arg, n_res, n_iw, n_w = (max(int(w.value), 1) for w in work)
        self._arg = (ctypes.c_void_p * max(n_arg, len(self.inputs)))(*(a.ctypes.data for a in self.inputs))
        self._res = (ctypes.c_void_p * max(n_res, len(self.outputs)))(*(a.ctypes.data for a in self.outputs))
        self._iw, self._w = (ctypes.c_longlong * n_iw)(), (ctypes.c_double * n_w)()
        self._call = compiled
        self._pointers = tuple(ctypes.c_void_p(ctypes.addressof(b)) for b in (self._arg, self._res, self._iw, self._w))

    def __call__(self) -> None:
        """Evaluate: outputs from inputs."""
        self._call(*self._pointers, 0)


def _dense(function: ca.Function) -> ca.Function:
    """Return the function with dense inputs and outputs under the same name."""
    arguments = [ca.MX.sym(f"a{i}", *function.size_in(i)) for i in range(function.n_in())]
    results = [ca.densify(r) for r in function.call(arguments)]
    inner = ca.Function(function.name(), arguments, results)
    return inner.expand() if function.is_a("SXFunction") else inner


def _without_dates(source: str) -> str:
    return re.sub(r"/\* This file was automatically.*?\*/", "", source, flags=re.DOTALL)
