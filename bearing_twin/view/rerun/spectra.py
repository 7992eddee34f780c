# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Spectrum and squared envelope spectrum as bars over Hz, lines of the combs beside them."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.stamps import NANO
from bearing_twin.view.rerun.picture import Picture
from bearing_twin.view.spectrum import ENVELOPE, highest, SpectrumPicture
from bearing_twin.view.style import FAMILIES, LINE
import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.style import Colour
    from numpy.typing import NDArray

__all__ = ['SpectrumBars']

BARS = 300
"""Most bars drawn, of a pixel or two each; of neighbouring bins the highest is kept."""
TICK = 0.12
"""Length of a mark below the axis, as part of the highest bar."""
HAIR = 1.0 / 1200.0
"""Width of a cursor, as part of the frequencies shown."""


class SpectrumBars(Picture):
    """Draw the messages of one spectrum topic."""

    kind = 'spectrum'

    def draw(self, message: Any, time: int) -> bool:
        """Draw a spectrum whose window begins at ``time`` in ns."""
        picture = SpectrumPicture.of(message, self.asset.diagnosis)
        if picture is None:
            return False
        if message.kind == ENVELOPE:
            self.kind = 'envelope_spectrum'
        time += round(NANO / picture.spacing)
        picture = picture.deciding()
        indices, group = highest(picture.values, BARS)
        values = picture.values[indices]
        frequencies = picture.frequencies[indices]
        self._bars('level', time, frequencies, values, group * picture.spacing, LINE['spectrum'])
        top = float(values.max()) or 1.0
        hair = (picture.end - picture.start) * HAIR
        colours = {family.key: family.colour for family in FAMILIES} | {'shaft': LINE['ground']}
        for comb in picture.combs:
            lines = comb.harmonics(picture.end)
            sides = comb.sidebands(picture.end)
            places = np.concatenate([lines, sides])
            height = TICK * top * (1.6 if comb.found else 1.0)
            heights = -np.repeat([height, 0.5 * height], [lines.size, sides.size])
            name = f'{comb.family}_found' if comb.found else comb.family
            self._bars(name, time, places, heights, 4.0 * hair, colours[comb.family])
        return True

    def _bars(
        self,
        name: str,
        time: int,
        frequencies: NDArray[np.floating[Any]],
        values: NDArray[np.floating[Any]],
        width: float,
        colour: Colour,
    ) -> None:
        widths = np.full(values.shape, np.float32(width))
        self.canvas.put(
            name, time, rr.BarChart(values, abscissa=frequencies, widths=widths, color=colour)
        )
