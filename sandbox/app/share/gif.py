"""GIF files: one palette for all pictures, a fixed pattern of dots where colours change slowly, and only what moves."""

import struct
from collections.abc import Sequence
from typing import BinaryIO

import numpy as np
import pygame
from numpy.typing import NDArray
from PIL import GifImagePlugin, Image

Frame = NDArray[np.uint32]
Indices = NDArray[np.uint8]

# Colours of the palette; the place after the last one means: as it was.
COLOURS = 255
UNCHANGED = COLOURS
# Pixels that the palette is made of, at most.
MOST_PIXELS = 50_000
# Colours are looked up with this many bits a channel; what is cut off decides the pattern of dots.
BITS = 6
CUT = 8 - BITS
# How strongly the eye sees red, green and blue.
WEIGHTS = np.sqrt(np.array([0.299, 0.587, 0.114], dtype=np.float32))
# Ordered dithering after Bayer 1973: thresholds 0..63, so that two pictures of the same thing are the same.
BAYER = np.array(
    [[0, 32, 8, 40, 2, 34, 10, 42], [48, 16, 56, 24, 50, 18, 58, 26], [12, 44, 4, 36, 14, 46, 6, 38],
     [60, 28, 52, 20, 62, 30, 54, 22], [3, 35, 11, 43, 1, 33, 9, 41], [51, 19, 59, 27, 49, 17, 57, 25],
     [15, 47, 7, 39, 13, 45, 5, 37], [63, 31, 55, 23, 61, 29, 53, 21]], dtype=np.uint32,
)  # fmt: skip
# What a file may take [bytes] for each pixel of its pictures: 4 MB at 640x360, for up to so long [s]; longer ones more.
MOST_BYTES, MOST_SECONDS = 4e6 / (640 * 360), 10.0
# A file on its way beyond that leaves colours as they were that differ by less: so much more or less each picture. It
# is looked at once the first picture, of which all is new, weighs little among the others.
TOLERANCE_STEP, MOST_TOLERANCE, FIRST = 4.0, 80.0, 10
# Longest time that a picture can stay [1/100 s].
LONGEST_DELAY = 65_535


class GifWriter:
    """Writes `count` pictures of a size into a file, fps of them a second, for ever over again.

    samples: pictures with the colours that they will have.
    """

    def __init__(
        self, file: BinaryIO, size: tuple[int, int], fps: float, samples: Sequence[pygame.Surface], count: int
    ) -> None:
        self._file, self._fps = file, fps
        width, height = size
        self._budget = MOST_BYTES * width * height * max(1.0, count / fps / MOST_SECONDS) / count
        self._written, self._tolerance = 0, 0.0
        palette = _palette([_pixels(sample) for sample in samples])
        self._colours = palette.astype(np.float32) * WEIGHTS
        self._apart = np.zeros((COLOURS + 1, COLOURS + 1), dtype=np.float32)
        for place, colour in enumerate(self._colours):
            self._apart[place, : len(palette)] = np.sqrt(((self._colours - colour) ** 2).sum(axis=1))
        # For each colour of BITS bits a channel the place of the nearest in the palette; UNCHANGED: nobody has asked.
        self._table = np.full(1 << 3 * BITS, UNCHANGED, dtype=np.uint8)
        # A part of what is cut off, for each channel of 0xRRGGBB.
        dots = (BAYER >> np.uint32(CUT + 2)) & np.uint32((1 << CUT) - 1)
        self._dots = np.tile(dots, (-(-height // 8), -(-width // 8)))[:height, :width] * np.uint32(0x010101)
        self._shown: Indices | None = None
        # The last picture that changed anything, kept until it is known how long it stays.
        self._waiting: tuple[bytes, int] | None = None
        self._count = 0
        colours = np.zeros((COLOURS + 1, 3), dtype=np.uint8)
        colours[: len(palette)] = palette
        file.write(b"GIF89a" + struct.pack("<HHBBB", width, height, 0xF7, 0, 0) + colours.tobytes())
        file.write(b"!\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00")

    def add(self, surface: pygame.Surface) -> None:
        """Write the next picture."""
        indices = self._indices(_pixels(surface))
        if self._shown is None:
            self._shown, changed = indices, np.ones(indices.shape, dtype=np.bool_)
        else:
            changed = indices != self._shown
            if self._tolerance > 0.0:
                changed &= self._apart[self._shown, indices] > self._tolerance
            np.copyto(self._shown, indices, where=changed)
        if changed.any():
            self._flush()
            data = _patch(indices, changed)
            self._waiting = data, self._count
            self._written += len(data)
        self._count += 1
        step = TOLERANCE_STEP if self._written > self._budget * self._count else -TOLERANCE_STEP
        self._tolerance = min(max(self._tolerance + step, 0.0), MOST_TOLERANCE) if self._count > FIRST else 0.0

    def close(self) -> None:
        """Write the last frames and the trailer, which makes the file whole."""
        self._flush()
        self._file.write(b";")

    def _flush(self) -> None:
        if self._waiting is None:
            return
        data, since = self._waiting
        delay = min(self._hundredths(self._count) - self._hundredths(since), LONGEST_DELAY)
        # It stays where the next one shows nothing.
        self._file.write(b"!\xf9\x04" + struct.pack("<BHBB", 0x05, delay, UNCHANGED, 0) + data)

    def _hundredths(self, picture: int) -> int:
        """When a picture is due: rounded each for itself, so that what is lost does not add up."""
        return round(100.0 * picture / self._fps)

    def _indices(self, frame: Frame) -> Indices:
        """The places of a picture's colours in the palette."""
        top = np.uint32(256 - (1 << CUT))
        channels = [np.minimum((frame >> np.uint32(shift)) & np.uint32(255), top) for shift in (16, 8, 0)]
        red, green, blue = ((channel + (self._dots & np.uint32(255))) >> np.uint32(CUT) for channel in channels)
        cells = (red << np.uint32(2 * BITS)) | (green << np.uint32(BITS)) | blue
        found = self._table[cells]
        unknown = cells[found == UNCHANGED]
        if len(unknown):
            self._look_up(np.unique(unknown))
            found = self._table[cells]
        return found

    def _look_up(self, cells: Frame) -> None:
        """Find the nearest colours for cells (n,) of the table."""
        channels = [(cells >> np.uint32(shift)) & np.uint32((1 << BITS) - 1) for shift in (2 * BITS, BITS, 0)]
        # With what the dots add, colours are on average as light as they were.
        colours = np.stack(channels, axis=-1).astype(np.float32) * ((256 - (1 << CUT)) / ((1 << BITS) - 1))
        for part in np.array_split(np.arange(len(cells)), -(-len(cells) // 1024)):
            apart = (colours[part] * WEIGHTS)[:, None] - self._colours
            self._table[cells[part]] = np.argmin((apart * apart).sum(axis=2), axis=1)


def _pixels(surface: pygame.Surface) -> Frame:
    """Pixels (h, w) 0xRRGGBB of a surface of 32 bits."""
    rows = np.frombuffer(surface.get_buffer().raw, dtype=np.uint32).reshape(surface.get_height(), -1)
    return rows[:, : surface.get_width()] & np.uint32(0xFFFFFF)


def _palette(samples: Sequence[Frame]) -> NDArray[np.uint8]:
    """Colours (n, 3) for all samples; what stays as it is in the first counts once, or it would take them all."""
    first = samples[0]
    seen = [first.ravel(), *(sample[sample != first] for sample in samples[1:])]
    pixels = np.concatenate(seen)
    pixels = pixels[:: -(-len(pixels) // MOST_PIXELS)]
    width = 256 if len(pixels) >= 256 else len(pixels)
    pixels = pixels[: len(pixels) // width * width]
    channels = np.stack([pixels >> np.uint32(16), pixels >> np.uint32(8), pixels], axis=-1).astype(np.uint8)
    picture = Image.fromarray(channels.reshape(-1, width, 3))
    found = picture.quantize(COLOURS, method=Image.Quantize.MEDIANCUT, kmeans=1, dither=Image.Dither.NONE)
    colours = np.array(found.getpalette(), dtype=np.uint8).reshape(-1, 3)
    return np.unique(colours[:COLOURS], axis=0)


def _patch(indices: Indices, changed: NDArray[np.bool_]) -> bytes:
    """The smallest rectangle with all that has changed, as an image block; what has not is left as it was."""
    rows, columns = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
    place = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    patch = np.where(changed[place], indices[place], np.uint8(UNCHANGED))
    corner = int(columns[0]), int(rows[0])
    return b"".join(GifImagePlugin.getdata(Image.fromarray(patch), corner))
