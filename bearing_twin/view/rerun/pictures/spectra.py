# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Spectrum and squared envelope spectrum as bars over Hz, with comb marks below the axis."""

from __future__ import annotations

from functools import cache, lru_cache
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.diagnosis.thresholds import INDEX_FAULT, INDEX_SUSPECT
from bearing_twin.stamps import NANO
from bearing_twin.view.rerun.canvas import png
from bearing_twin.view.rerun.pictures.lanes import AGAIN
from bearing_twin.view.rerun.pictures.picture import labelled_power, numbered_end, Picture
from bearing_twin.view.spectrum import ENVELOPE, highest, SpectrumPicture
from bearing_twin.view.style import FAMILIES, LINE
from bearing_twin.view.verdict import number
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
import pyarrow as pa
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas
    from bearing_twin.view.rerun.pictures.picture import Asset
    from bearing_twin.view.spectrum import Comb
    from bearing_twin.view.style import Colour


BARS = 200
"""Largest number of bars, of two pixels or more; each has the highest of neighbouring bins."""
MARK = 0.1
"""Length of the marks below the axis, relative to the axis above it."""
MARK_WIDTH = 1.0 / 200.0
"""Width of a mark, relative to the frequencies shown."""
STEP = 0.25
"""Step to which axis heights are rounded up, as modulation index; marks scale with them."""
HIGH, LOW = 0.6, 0.35
"""Fractions of a power of ten up to which a laptop numbers each tenth on the axis of the index,
and on that of the first harmonic."""
LEGEND = (740, 80)
"""Width and height of the legend, pixels."""
COLOURS = {family.key: family.colour for family in FAMILIES} | {'shaft': LINE['ground']}
LIMITS = {'limit': INDEX_FAULT, 'remark': INDEX_SUSPECT}
"""Limits of the modulation index by colour: of a fault, and of suspect."""
NARROW, WIDE = 4.0, 6.0
"""
Largest number of steps of 1, 10 or 100 Hz at which the viewer numbers every step on a laptop's
screen, beside another recording and alone.
"""


class SpectrumBars(Picture):
    """Draw the messages of one spectrum topic."""

    kind = 'spectrum'

    def __init__(self, canvas: Canvas, asset: Asset) -> None:
        super().__init__(canvas, asset)
        self._marked: dict[str, tuple[NDArray[np.float64], float, int]] = {}
        self._axes: dict[str, tuple[tuple[bytes, float], int]] = {}
        self._near = False
        self._kind = ''

    def draw(self, message: Any, time: int) -> bool:
        """Draw a spectrum whose window begins at ``time`` in ns."""
        diagnosis = self.asset.diagnosis
        picture = SpectrumPicture.of(message, diagnosis)
        if picture is None:
            return False
        self._kind = str(message.kind)
        self.asset.headline.spectrum(message)
        self._draw(message, picture, time + round(NANO / picture.spacing))
        return True

    def finish(self) -> None:
        """Show the window of the worst sustained verdict if the card shows that verdict."""
        headline = self.asset.headline
        if not headline.ending:
            return
        message = headline.spectra.get(self._kind)
        if message is not None and (picture := SpectrumPicture.of(message, headline.worst.best)):
            self._draw(message, picture, self.asset.judged + 1)

    def _draw(self, message: Any, picture: SpectrumPicture, time: int) -> None:
        if message.kind != ENVELOPE:
            self._part('all', time, picture, float(picture.values.max()))
            return
        self.kind = 'envelope_spectrum'
        whole, near = picture.deciding(), picture.zoom()
        stop = numbered_end(whole.end, NARROW if self.asset.narrow else WIDE)
        whole = picture.cut(0.0, stop)
        # The axis always includes the limit of a fault, so that a healthy spectrum stays low.
        # It grows in steps, so that the marks keep their length.
        top = max(float(whole.values.max()), self.asset.scales.index, INDEX_FAULT)
        top = STEP * math.ceil(top / STEP)
        self._part('whole', time, whole, top)
        width = MARK_WIDTH * whole.end
        # A spectrum of a narrow band may end before the second number of the axis.
        if self._changed('whole/limit', time, np.array([stop]), top, width):
            # A bar begins at its abscissa: these dark bars are as wide as the axis, and their
            # upper edges are the limits.
            for name, limit in LIMITS.items():
                red, green, blue = LINE[name]
                ground = red // 7, green // 7, blue // 7
                self._bars(f'whole/{name}', time, np.zeros(1), np.array([limit]), stop, ground)
            end = np.array([stop + width])
            self._hold('whole/scale', time, end, labelled_power(top, HIGH) or top, width)
        if near is not None:
            self._part('near', time, near, top)
            end, width = np.array([near.end]), MARK_WIDTH * (near.end - near.start)
            if (least := labelled_power(top, LOW)) and self._changed(
                'near/limit', time, end, least, width
            ):
                self._hold('near/scale', time, end, least, width)
            self.asset.panels.add('near')
        elif self._near:
            self.canvas.put('near', time, rr.Clear(recursive=True))
            self._marked = {k: v for k, v in self._marked.items() if not k.startswith('near/')}
            self._axes = {k: v for k, v in self._axes.items() if not k.startswith('near/')}
        self._near = near is not None
        nominal = {c.family: c.fundamental for c in picture.combs if not c.found}
        places = np.array([0.0, *nominal.values()])
        if self._changed('legend', time, places, 0.0, MARK_WIDTH * whole.end):
            legend = _legend(tuple((k, number(hertz)) for k, hertz in nominal.items()))
            self.canvas.put('legend', time, legend)

    def _hold(
        self, name: str, time: int, end: NDArray[np.float64], top: float, width: float
    ) -> None:
        """Extend an axis to ``top`` with a thin bar at its end, since it takes no range."""
        self._bars(name, time, end, np.array([top]), 0.1 * width, LINE['grid'])

    def _part(self, name: str, time: int, picture: SpectrumPicture, top: float) -> None:
        indices, group = highest(picture.values, BARS)
        frequencies = picture.frequencies[indices]
        width = group * picture.spacing
        if picture.threshold.size and name == 'whole':
            self._bars(
                f'{name}/threshold', time, frequencies, picture.threshold[indices], width,
                LINE['threshold'],
            )  # fmt: skip
        self._bars(
            f'{name}/values', time, frequencies, picture.values[indices], width, LINE['spectrum']
        )
        combs = {f'{name}/{c.family}{"_found" if c.found else ""}': c for c in picture.combs}
        shown = {
            key
            for key, comb in combs.items()
            if self._marks(key, time, comb, picture, MARK * (top or 1.0))
        }
        # The window before may have shown another fault: its marks are cleared.
        for key in [k for k in self._marked if k.startswith(f'{name}/') and k not in shown]:
            if not key.endswith('/limit'):
                self.canvas.put(key, time, rr.Clear(recursive=False))
                del self._marked[key], self._axes[key]

    def _marks(
        self, name: str, time: int, comb: Comb, picture: SpectrumPicture, length: float
    ) -> bool:
        """
        Mark the lines of a comb; return whether there are any.

        Marks of harmonics found are long, nominal ones short; those of sidebands are half as long.
        """
        lines, sides = comb.harmonics(picture.end), comb.sidebands(picture.end)
        lines, sides = lines[lines >= picture.start], sides[sides >= picture.start]
        length *= 2.0 if comb.found else 1.0
        places, width = np.concatenate([lines, sides]), MARK_WIDTH * (picture.end - picture.start)
        if places.size and self._changed(name, time, places, length, width):
            lengths = -np.repeat([length, 0.5 * length], [lines.size, sides.size])
            self._bars(name, time, places, lengths, width, COLOURS[comb.family])
        return bool(places.size)

    def _changed(
        self, name: str, time: int, places: NDArray[np.float64], length: float, width: float
    ) -> bool:
        """Whether marks are to be drawn: new, visibly moved, or after ``AGAIN``."""
        before, long, drawn = self._marked.get(name, (places[:0], 0.0, 0))
        there = before.size == places.size and long == length
        if there and abs(before - places).max() < 0.25 * width and 0 <= time - drawn < AGAIN:
            return False
        self._marked[name] = places, length, time
        return True

    def _bars(
        self,
        name: str,
        time: int,
        frequencies: NDArray[np.floating],
        values: NDArray[np.floating],
        width: float,
        colour: Colour,
    ) -> None:
        axis = frequencies.tobytes(), width
        before, drawn = self._axes.get(name, (None, 0))
        if axis == before and 0 <= time - drawn < AGAIN:
            # The positions are unchanged, and sending them takes twice as long as the heights.
            bars = rr.BarChart.from_fields(values=vector(values))
        else:
            self._axes[name] = axis, time
            widths = np.full(values.shape, np.float32(width))
            bars = rr.BarChart(
                vector(values), abscissa=vector(frequencies), widths=widths, color=colour
            )
        self.canvas.put(name, time, bars)


def vector(values: NDArray[np.floating]) -> pa.Array:
    """
    Return a vector, shape (n,), as the Arrow array in which Rerun keeps a tensor.

    Rerun makes a new empty array for each of the eleven other types of number, which takes five
    times as long. Here they are reused from a tensor that Rerun has made once.
    """
    blank, names, heads, kinds, own = _tensor()
    kinds, union = list(kinds), blank.field('buffer').type
    kinds[own] = pa.ListArray.from_arrays(
        [0, values.size], np.ascontiguousarray(values, np.float64), type=kinds[own].type
    )
    buffer = pa.Array.from_buffers(union, 1, [None, *heads], children=kinds)
    size = np.array([values.size], np.uint64)
    shape = pa.ListArray.from_arrays([0, 1], size, type=blank.field('shape').type)
    return pa.StructArray.from_arrays([shape, names, buffer], fields=list(blank))


@cache
def _tensor() -> tuple[pa.StructType, pa.Array, list[pa.Buffer], list[pa.Array], int]:
    """Return a tensor's type, names, buffer heads, arrays by number type, and index of its own."""
    blank = rr.components.TensorDataBatch(np.zeros(1)).as_arrow_array()
    buffer = blank.field('buffer')
    kinds = [buffer.field(k) for k in range(buffer.type.num_fields)]
    own = buffer.type_codes[0].as_py()
    return blank.type, blank.field('names'), buffer.buffers()[1:3], kinds, own


@lru_cache(maxsize=32)
def _legend(hertz: tuple[tuple[str, str], ...]) -> rr.EncodedImage:
    """
    Return a colour legend as an image: a legend in the plot would cover lines.

    Parameters
    ----------
    hertz
        Family and fundamental of the combs. If an axis has only one number, they give the scale to
        the marks.

    """
    known = dict(hertz)
    lower = {'shaft': 'shaft', 'threshold': 'noise', 'limit': 'fault limit', 'remark': 'suspect'}
    colours = COLOURS | LINE
    font = ImageFont.load_default(26)
    image = Image.new('RGB', LEGEND, (24, 24, 24))
    draw = ImageDraw.Draw(image)
    for top, row in ((0, {f.key: f.label for f in FAMILIES}), (38, lower)):
        left = 10.0
        for key, label in row.items():
            name = f'{label} {known[key]}' if key in known else label
            draw.rectangle((left, top + 12, left + 20, top + 32), fill=colours[key])
            draw.text((left + 28, top + 4), name, (230, 230, 230), font)
            left += 28 + draw.textlength(name, font) + 26
    return png(image, 32)
