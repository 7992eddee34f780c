# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Spectrum and squared envelope spectrum as bars over Hz, with cursors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import rerun as rr

from bearing_twin.view.style import FAMILIES, LINE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from bearing_twin.view.canvas import Canvas

__all__ = ['SpectrumBars', 'cursors']

BARS = 1500
"""Most bars drawn; of neighbouring bins the highest is kept."""
HARMONICS = 4


def cursors(message: Any, *, harmonics: int = HARMONICS) -> dict[str, list[tuple[float, float]]]:
    """Return where the defects strike, as (frequency in Hz, relative height) by family.

    Parameters
    ----------
    message
        Spectrum message.
    harmonics
        Number of harmonics of each family.

    Notes
    -----
    A defect on the inner ring passes the load once a turn, one on a ball once a turn of the cage:
    their harmonics have sidebands at the shaft speed and at the FTF (Randall and Antoni,
    Mechanical Systems and Signal Processing 25, 2011, section 2). Sidebands are half as high.
    """
    side = {'inner': message.shaft_hz, 'ball': message.ftf}
    base = {
        'inner': message.bpfi,
        'outer': message.bpfo,
        'ball': 2.0 * message.bsf,
        'cage': message.ftf,
    }
    found: dict[str, list[tuple[float, float]]] = {}
    for family, frequency in base.items():
        if not frequency > 0.0:
            continue
        lines = []
        for k in range(1, harmonics + 1):
            lines.append((k * frequency, 1.0))
            if family in side and side[family] > 0.0:
                lines.append((k * frequency - side[family], 0.5))
                lines.append((k * frequency + side[family], 0.5))
        found[family] = sorted(lines)
    return found


class SpectrumBars:
    """Draw the messages of one spectrum topic."""

    def __init__(self, canvas: Canvas, name: str) -> None:
        self._canvas = canvas
        self._name = name

    def draw(self, message: Any, time: int) -> None:
        """Draw a spectrum at ``time`` in ns."""
        values = np.nan_to_num(np.asarray(message.values, dtype=np.float64))
        width = float(message.bin_hz)
        if values.size == 0 or not width > 0.0:
            return
        start = float(message.start_hz)
        values, width, start = pooled(values, width, start)
        frequencies = start + np.arange(values.size) * width
        self._bars('bars', time, frequencies, values, width, LINE['envelope'])
        top = 1.05 * float(values.max()) or 1.0
        # As thin as can be seen, and never thinner than a bar.
        thin = max(width, values.size * width / 1200.0)
        drawn = cursors(message)
        for family in FAMILIES:
            lines = [(f, h) for f, h in drawn.get(family.key, ()) if start <= f <= frequencies[-1]]
            self._bars(
                f'cursors/{family.label.replace(" ", "")}',
                time,
                np.array([f for f, _ in lines]),
                np.array([h for _, h in lines]) * top,
                thin,
                family.colour,
            )

    def _bars(
        self,
        name: str,
        time: int,
        frequencies: NDArray[np.floating[Any]],
        values: NDArray[np.floating[Any]],
        width: float,
        colour: tuple[int, ...],
    ) -> None:
        self._canvas.put(
            f'{self._name}/{name}',
            time,
            rr.BarChart(
                values,
                abscissa=frequencies,
                widths=np.full(values.size, width, dtype=np.float32),
                color=colour,
            ),
        )


def pooled(
    values: NDArray[np.float64], width: float, start: float
) -> tuple[NDArray[np.float64], float, float]:
    """Return at most BARS values, each the highest of its neighbours, with width and start."""
    group = -(-values.size // BARS)
    if group == 1:
        return values, width, start
    edges = np.arange(0, values.size, group)
    highest = np.maximum.reduceat(values, edges)
    return highest, width * group, start + 0.5 * width * (group - 1)
