"""The program `drawbar`, also as `python -m drawbar`; an interrupt while it loads is one line, as at any other time."""

import signal
import sys
from types import FrameType


def main() -> None:
    """Load and run the command line."""
    interrupted = False

    def interrupt(number: int, frame: FrameType | None) -> None:
        nonlocal interrupted
        interrupted = True
        raise KeyboardInterrupt

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, interrupt)
    try:
        from drawbar.cli.main import main as program  # takes a while

        program()
    except (Exception, KeyboardInterrupt) as error:
        if not (interrupted or isinstance(error, KeyboardInterrupt)):  # some libraries make another error of it
            raise
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # nor while Python ends
        print("interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
