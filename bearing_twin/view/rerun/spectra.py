# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Spectrum and squared envelope spectrum as bars over Hz, with cursors."""

from __future__ import annotations

from typing import Any, TYPE_CHECKING

from bearing_twin.view.style import FAMILIES, LINE
import numpy as np
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Canvas
    from numpy.typing import NDArray

__all__ = ['HARMONICS', 'SpectrumBars', 'cursors']

BARS = 300
"""Most bars drawn, of a pixel or two each; of neighbouring bins the highest is kept."""
TICK = 0.12
"""Length of a cursor below the axis, as part of the highest bar."""
HAIR = 1.0 / 1200.0
"""Width of a cursor, as part of the frequencies shown."""
HARMONICS = 4


def cursors(message: Any, *, harmonics: int = HARMONICS) -> dict[str, list[tuple[float, float]]]:
    """
    Return where the defects strike, as (frequency in Hz, relative height) by family.

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
        start, spacing = float(message.start_hz), float(message.bin_hz)
        if values.size == 0 or not spacing > 0.0:
            return
        end = start + values.size * spacing
        hair = (end - start) * HAIR
        frequencies, values, width = pooled(values, start, spacing)
        self._bars('level', time, frequencies, values, width, LINE['spectrum'])
        top = float(values.max()) or 1.0
        drawn = cursors(message)
        for family in FAMILIES:
            lines = [(f, h) for f, h in drawn.get(family.key, ()) if start <= f <= end]
            places = np.array([f for f, _ in lines])
            heights = np.array([h for _, h in lines])
            # A hair line through the plot, and below the axis a tick that hides no bar.
            self._bars(
                family.label.replace(' ', ''),
                time,
                np.concatenate([places, places]),
                np.concatenate([heights * top * 1.05, -heights * top * TICK]),
                np.repeat([hair, 4.0 * hair], len(lines)),
                family.colour,
            )

    def _bars(
        self,
        name: str,
        time: int,
        frequencies: NDArray[np.floating[Any]],
        values: NDArray[np.floating[Any]],
        widths: NDArray[np.floating[Any]] | float,
        colour: tuple[int, ...],
    ) -> None:
        self._canvas.put(
            f'{self._name}/{name}',
            time,
            rr.BarChart(
                values,
                abscissa=frequencies,
                widths=np.broadcast_to(np.float32(widths), values.shape),
                color=colour,
            ),
        )


def pooled(
    values: NDArray[np.float64], start: float, spacing: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """
    Return at most BARS peaks: their frequencies in Hz, their heights, and the bars' width.

    Each is the highest of its neighbours, at the frequency that it has.
    """
    group = -(-values.size // BARS)
    edges = np.arange(0, values.size, group)
    padded = np.full(edges.size * group, -np.inf)
    padded[: values.size] = values
    highest = edges + padded.reshape(-1, group).argmax(axis=1)
    return start + highest * spacing, values[highest], group * spacing
