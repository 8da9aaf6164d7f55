"""Bursts of a receiver's frames, as a stream gets them."""

from drawbar.protocols.gnss.epoch import Epoch
from drawbar.protocols.gnss.stream import EpochStream


def run(stream: EpochStream, bursts: list[tuple[float, list[bytes]]], gap: float = 0.001) -> list[Epoch]:
    """Push bursts that begin at given times, their frames some ms after each other, read as they come; then silence."""
    epochs = []
    for begin, frames in bursts:
        for index, frame in enumerate(frames):
            epochs += stream.poll(begin + gap * index) + stream.push(frame, begin + gap * index)
    return epochs + stream.poll(1e9)
