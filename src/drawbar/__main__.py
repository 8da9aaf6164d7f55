"""`python -m drawbar` is the program `drawbar`."""

from drawbar.cli.main import main

if __name__ == "__main__":
    main()
