"""The program `drawbar`, also as `python -m drawbar`; an interrupt while it loads is one line, as at any other time."""

import sys


def main() -> None:
    """Load and run the command line."""
    try:
        from drawbar.cli.main import main as program  # takes a while

        program()
    except KeyboardInterrupt:
        import signal

        signal.signal(signal.SIGINT, signal.SIG_IGN)  # nor while Python ends
        print("interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
