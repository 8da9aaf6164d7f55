"""The program `drawbar`, also as `python -m drawbar`; an interrupt while it loads is one line, as at any other time."""

import _thread
import signal
import sys
from threading import Timer
from types import FrameType

_INTERRUPTED = 130
"""exit code, as shells have it"""
_AGAIN = 0.01
"""s after which an interrupt that CasADi or Python has dropped is raised again"""


def main() -> None:
    """Load and run the command line."""
    interrupted = False

    def interrupt(number: int, frame: FrameType | None) -> None:
        nonlocal interrupted
        interrupted = True
        if not _in_casadi(frame):
            raise KeyboardInterrupt
        _interrupt_again()

    try:
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, interrupt)
            sys.unraisablehook = _tell_or_interrupt_again
        from drawbar.cli.main import main as program  # takes a while

        if interrupted:  # and a library has caught it
            raise KeyboardInterrupt
        program()
    except SystemExit as end:
        if end.code == _INTERRUPTED:
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # once is enough, also while Python ends
        raise
    except (Exception, KeyboardInterrupt) as error:
        if not (interrupted or isinstance(error, KeyboardInterrupt)):  # some libraries make another error of it
            raise
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        print("interrupted", file=sys.stderr)
        sys.exit(_INTERRUPTED)


def _interrupt_again() -> None:
    again = Timer(_AGAIN, _thread.interrupt_main)
    again.daemon = True
    again.start()


def _tell_or_interrupt_again(dropped: "sys.UnraisableHookArgs") -> None:
    """Print an error that Python drops, as in a destructor; an interrupt is raised once more."""
    if dropped.exc_type is KeyboardInterrupt:
        _interrupt_again()
    else:
        sys.__unraisablehook__(dropped)


def _in_casadi(frame: FrameType | None) -> bool:
    """Whether Python code that CasADi calls is running: CasADi drops what is raised there."""
    while frame is not None and not frame.f_globals.get("__name__", "").startswith("casadi"):
        frame = frame.f_back
    return frame is not None


if __name__ == "__main__":
    main()
