"""Targets: the machines that a library is built for, and what is asked of the compiler for each."""

from dataclasses import dataclass
from enum import StrEnum

from drawbar.errors import ConfigurationError
from drawbar.misspelt import meant

FLAGS = (
    "-std=c99",
    "-O2",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fvisibility=hidden",
    "-ffunction-sections",
    "-fdata-sections",
    "-g0",
)
"""The same on all targets. No fused multiply-add, so that targets agree; never -ffast-math."""
SMALL = {
    "line.c": "-Os",
    "guidance.c": "-Os",
    "path.c": "-Os",
    "step.c": "-Os",
    "gate.c": "-Os",
    "run_monitor.c": "-Os",
    "predictor.c": "-Os",
    "tractor_law.c": "-Os",
    "trailer_law.c": "-Os",
    "sanity.c": "-Os",
    "alignment.c": "-Os",
    "actuate.c": "-Os",
}
"""sources whose time hardly counts, and what is asked for them beside these flags: that they are small. Compiled as the
others are, a typical step of the product would have 1 % fewer instructions on x86-64, nine tenths of them guidance's;
predictor and run monitor together no fewer."""
_SIZED = "-fstack-size-section"
_ROLLED = ("-mllvm", "-unroll-allow-partial=false")
"""for a Cortex-M: loops unrolled in part are a fifth more code, for 0.2 % (M4) to 5 % (M7) fewer instructions"""


class Precision(StrEnum):
    """The type of an exported library's numbers."""

    DOUBLE = "double"
    SINGLE = "single"


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """One machine, as zig names it."""

    name: str
    """in our words; also the folder of what is built"""
    triple: str
    flags: tuple[str, ...]
    """on top of FLAGS"""
    headers: tuple[str, ...] = ()
    """folders of zig's own include tree that stand in for a C library, where the target has none"""
    static: str
    """file name of the static library"""
    shared: str = ""
    """file name of the shared library; empty: the target has none"""
    imports: str = ""
    """file name of the import library that goes with the shared one"""

    @property
    def stack_known(self) -> bool:
        """Whether object files hold the stack use of their functions; COFF and Mach-O have no place for it."""
        return _SIZED in self.flags


TARGETS = (
    *(
        Target(
            name=f"linux-{processor}",
            triple=f"{processor}-linux-gnu",
            flags=(_SIZED, "-fPIC"),
            static="libdrawbar.a",
            shared="libdrawbar.so",
        )
        for processor in ("x86_64", "aarch64")
    ),
    Target(
        name="linux-armv7",
        triple="arm-linux-gnueabihf",
        flags=(_SIZED, "-fPIC", "-mcpu=cortex_a7"),
        static="libdrawbar.a",
        shared="libdrawbar.so",
    ),
    Target(
        name="windows-x86_64",
        triple="x86_64-windows-gnu",
        flags=(
            *("-mno-incremental-linker-compatible", "-s"),  # no dates and no names of temporary files
            "-U__CRT__NO_INLINE",  # <math.h>'s inline functions inline: zig asks for calls of them
            "-Dhypotf=_hypotf",  # as Windows names it
        ),
        static="libdrawbar.a",
        shared="drawbar.dll",
        imports="drawbar.lib",
    ),
    Target(
        name="macos-aarch64",
        triple="aarch64-macos",
        flags=(),
        static="libdrawbar.a",
        shared="libdrawbar.dylib",
    ),
    Target(
        name="cortex-m7",
        triple="thumb-freestanding-eabihf",
        # its unit for doubles; one lane at a time, as it has no SIMD for doubles: more would only cost stack
        flags=(_SIZED, "-mcpu=cortex_m7+fp_armv8d16", *_ROLLED, "-fno-unwind-tables", "-DLANES=1"),
        headers=("arm-linux-musl", "generic-musl"),
        static="libdrawbar.a",
    ),
    Target(
        name="cortex-m4",
        triple="thumb-freestanding-eabihf",
        # a unit for floats alone: doubles are computed by __aeabi_dadd and its kind, of the C compiler's own library
        flags=(_SIZED, "-mcpu=cortex_m4+vfp4d16sp", *_ROLLED, "-fno-unwind-tables", "-DLANES=1"),
        headers=("arm-linux-musl", "generic-musl"),
        static="libdrawbar.a",
    ),
)


def find_target(name: str) -> Target:
    """Return the target of that name or triple.

    Raises:
        ConfigurationError: there is none, or several of that triple; names which there are.
    """
    found = [target for target in TARGETS if name in (target.name, target.triple)]
    if len(found) == 1:
        return found[0]
    known = ", ".join(f"{target.name} ({target.triple})" for target in TARGETS)
    near = "" if found else meant(name, [target.name for target in TARGETS])
    raise ConfigurationError(
        f"--target {name!r}: {'several targets' if found else 'no such target'}{near}; there are {known}."
    )
