"""Fuzzing of the receivers' parsers at length: fuzz.py [FRAMES [SEED]], with tests/harness in PYTHONPATH.

Frames of the stand-in are altered in their bodies and given right checksums, altered without, cut, joined and mixed
with noise; all go the whole way from bytes to epochs. Between them stand intact frames, which must all come out.
Nothing may raise. Prints how many frames there were, how long one took and what was dropped.
"""

import random
import sys
import time
from collections import Counter

from hostile_frames import altered, broken, corpus
from receiver_frames import nmea

from drawbar.protocols.gnss.assembly import Assembler
from drawbar.protocols.gnss.decoding import Decoder
from drawbar.protocols.gnss.framing import Framer
from drawbar.protocols.gnss.settings import EpochSettings

_BATCH = 100
"""frames between two intact ones and a look at the clock"""


def fuzz(count: int, seed: int) -> tuple[int, float, Counter[str]]:
    """Fuzz with at least `count` frames; return how many came out whole, CPU time of each of the slowest 100, counts.

    Raises whatever a parser raises, and AssertionError if an intact frame does not come out.
    """
    chance = random.Random(seed)
    frames = corpus(chance)
    framer, decoder, assembler = Framer(), Decoder(), Assembler(EpochSettings())
    whole, longest = 0, 0.0
    for batch in range(-(-count // _BATCH)):
        control = nmea.sentence(
            f"GNGGA,{batch % 86400:06d}.00,5052.6123456,N,00442.1234567,E,4,17,0.7,42.3,M,45.7,M,1.2,0"
        )
        chosen = [altered(chance.choice(frames), chance) for _ in range(_BATCH)]
        data = b"".join(broken(each, chance) if chance.random() < 0.2 else each for each in chosen)
        cuts = sorted(chance.randrange(len(data)) for _ in range(8))
        started, found = time.process_time(), []
        for start, end in zip([0, *cuts], [*cuts, len(data)], strict=True):
            found += framer.push(data[start:end], float(batch))
        found += framer.push(control, float(batch)) + framer.settle()
        for frame in found:
            message = decoder.decode(frame)
            if message is not None:
                assembler.add(message, frame.time)
        assembler.close()
        longest = max(longest, time.process_time() - started)
        assert control.rstrip() in [frame.data for frame in found], f"batch {batch} of seed {seed} lost an intact frame"
        whole += len(found)
    return whole, longest / _BATCH, framer.dropped + decoder.dropped + assembler.dropped


def main(arguments: list[str]) -> None:
    """Fuzz with as many frames as are asked for, in steps, and say after each what has been done."""
    count, seed = int(arguments[0]) if arguments else 100_000, int(arguments[1]) if arguments[1:] else 0
    done, intact, slowest, total, begin = 0, 0, 0.0, Counter[str](), time.perf_counter()
    while done < count:
        step = min(100_000, count - done)
        whole, longest, dropped = fuzz(step, seed)
        done, intact, slowest, total, seed = (
            done + step,
            intact + whole,
            max(slowest, longest),
            total + dropped,
            seed + 1,
        )
        mean = (time.perf_counter() - begin) / done
        print(
            f"{done} frames, {intact} with right checksums, {mean * 1e6:.0f} µs each with their making, none raised; ",
            end="",
        )
        print(f"slowest hundred {slowest * 1e6:.0f} µs each", flush=True)
    for kind, number in total.most_common():
        print(f"{number:12d}  {kind}")


if __name__ == "__main__":
    main(sys.argv[1:])
