"""Reads the columns of a part of a log for another process, which asks for them: see columns.py.

`python -m drawbar.recording.columns_main FILE FIRST_BYTE NAME...`; the blocks come out pickled,
one after the other, then None.
"""

import pickle
import sys
from pathlib import Path

from drawbar.recording.columns import read_blocks
from drawbar.recording.stream import WHOLE


def main() -> None:
    """Read and write block by block."""
    _, file, first, *names = sys.argv
    for block in read_blocks(Path(file), range(int(first), WHOLE.stop), tuple(names)):
        pickle.dump(block, sys.stdout.buffer, pickle.HIGHEST_PROTOCOL)
    pickle.dump(None, sys.stdout.buffer)  # that was all


if __name__ == "__main__":
    main()
