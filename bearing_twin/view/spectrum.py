# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Data of a drawn spectrum, prepared once for the viewer, the report and ``--plot``.

A defect on the inner ring passes the load zone once per revolution of the shaft, a defect on a
ball once per revolution of the cage: their harmonics have sidebands at the shaft speed and at the
FTF (Randall and Antoni, Mechanical Systems and Signal Processing 25, 2011, section 2).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
import math
from typing import Any

from bearing_twin.bearing.vocabulary import PLACES
from bearing_twin.diagnosis.thresholds import HARMONICS
from bearing_twin.view.style import FAMILIES
from bearing_twin.view.verdict import impacts, pretty, same_window
import numpy as np
from numpy.typing import NDArray

ENVELOPE = 'squared_envelope_spectrum'
CHANCE = 1e-3
"""Fraction of the bins of noise that lies above the threshold."""
ZOOM_BINS = 20
"""Least number of bins on either side of the first harmonic in the zoom."""


@dataclass(frozen=True)
class Comb:
    """Harmonics and sidebands of a fault family or of the shaft."""

    family: str
    """Key of ``FAMILIES``, or ``'shaft'``."""
    found: bool
    """Whether it was measured in this window; else nominal: from the geometry, without slip."""
    fundamental: float
    """Fundamental frequency, Hz."""
    sideband: float
    """Distance of the sidebands from each harmonic, Hz; 0: none."""

    @property
    def label(self) -> str:
        """Name with the kind and frequency."""
        name = next((f.label for f in FAMILIES if f.key == self.family), self.family)
        kind = '' if self.family == 'shaft' else ' found' if self.found else ' nominal'
        return f'{name}{kind} {self.fundamental:.2f} Hz'

    def harmonics(self, top: float = math.inf) -> NDArray[np.floating]:
        """Return the first harmonics up to ``top``, Hz; of the shaft all of them."""
        count = HARMONICS
        if self.family == 'shaft' and math.isfinite(top):
            count = int(top / self.fundamental)
        lines = self.fundamental * np.arange(1, count + 1)
        return lines[lines <= top]

    def sidebands(self, top: float = math.inf) -> NDArray[np.floating]:
        """Return the first sidebands of each harmonic between 0 and ``top``, Hz."""
        if not self.sideband > 0.0:
            return np.zeros(0)
        lines = (self.harmonics()[:, None] + [-self.sideband, self.sideband]).ravel()
        return lines[(lines > 0.0) & (lines <= top)]


def combs(spectrum: Any, diagnosis: Any = None) -> list[Comb]:
    """
    Return the combs of a spectrum: a nominal one of every family, the shaft's, the one found.

    Nominal frequencies come from the Spectrum message, the one found from its Diagnosis.
    """
    side = {'inner': spectrum.shaft_hz, 'ball': spectrum.ftf}
    base = {place: impacts(spectrum, place) for place in PLACES} | {'shaft': spectrum.shaft_hz}
    found = [
        Comb(family, found=False, fundamental=float(hertz), sideband=float(side.get(family, 0.0)))
        for family, hertz in base.items()
        if hertz > 0.0
    ]
    if diagnosis is not None and diagnosis.fault_hz > 0.0 and diagnosis.faults:
        family = str(diagnosis.faults[0])
        hertz = float(diagnosis.fault_hz)
        found.append(
            Comb(family, found=True, fundamental=hertz, sideband=float(side.get(family, 0.0)))
        )
    return found


@dataclass(frozen=True)
class SpectrumPicture:
    """
    A spectrum ready to be drawn.

    It has the whole range of frequencies; `cut`, `deciding` and `zoom` return parts.
    """

    title: str
    """Title; of an envelope spectrum with the demodulated band."""
    quantity: str
    """Name and unit of the values."""
    start: float
    """Frequency of the first value, Hz."""
    spacing: float
    """Distance between values, Hz."""
    values: NDArray[np.float64]
    """
    Amplitudes. In an envelope spectrum: the modulation index of each line, which is twice the root
    of its power. A single line at the limit of the index is then enough for a fault.
    """
    floor: NDArray[np.float64]
    """Local noise floor of the values; empty if there is none."""
    threshold: NDArray[np.float64]
    """Value that one bin of noise in a thousand exceeds; empty if there is no floor."""
    band: tuple[float, float]
    """Demodulated band, Hz; (0, 0) if there is none."""
    combs: list[Comb]

    @classmethod
    def of(cls, spectrum: Any, diagnosis: Any = None) -> SpectrumPicture | None:
        """Prepare a Spectrum message, with the diagnosis of its window; None if it is empty."""
        values = np.nan_to_num(np.asarray(spectrum.values, dtype=np.float64))
        spacing = float(spectrum.bin_hz)
        if values.size == 0 or not spacing > 0.0:
            return None
        start = float(spectrum.start_hz)
        if spectrum.kind != ENVELOPE:
            quantity = f'amplitude [{pretty(spectrum.unit)}]'
            none = np.zeros(0)
            return cls('Spectrum', quantity, start, spacing, values, none, none, (0.0, 0.0), [])
        floor = np.asarray(spectrum.floor, dtype=np.float64)
        floor = floor if floor.size == values.size else np.zeros(0)
        title, band = 'Squared envelope spectrum', (spectrum.band_low, spectrum.band_high)
        if band[1] > band[0]:
            title += f' of the band {band[0] / 1e3:.1f} to {band[1] / 1e3:.1f} kHz'
        same = diagnosis is not None and same_window(spectrum, diagnosis)
        return cls(
            title=title,
            quantity='modulation index [1]',
            start=start,
            spacing=spacing,
            values=2.0 * np.sqrt(values),
            floor=2.0 * np.sqrt(floor),
            # The power of a bin of noise over its floor is distributed as Exp(1).
            threshold=2.0 * np.sqrt(-math.log(CHANCE) * floor),
            band=band if band[1] > band[0] else (0.0, 0.0),
            combs=combs(spectrum, diagnosis if same else None),
        )

    @property
    def end(self) -> float:
        """Frequency of the last value, Hz."""
        return self.start + (self.values.size - 1) * self.spacing

    @property
    def frequencies(self) -> NDArray[np.floating]:
        """Frequency of each value, Hz."""
        return self.start + self.spacing * np.arange(self.values.size)

    @property
    def found(self) -> Comb | None:
        """Return the comb that was found, if any."""
        return next((comb for comb in self.combs if comb.found), None)

    def cut(self, low: float, high: float) -> SpectrumPicture:
        """Return the part between two frequencies in Hz."""
        first = max(0, math.ceil((low - self.start) / self.spacing - 1e-9))
        last = max(first + 1, math.floor((high - self.start) / self.spacing + 1e-9) + 1)
        return replace(
            self,
            start=self.start + first * self.spacing,
            values=self.values[first:last],
            floor=self.floor[first:last],
            threshold=self.threshold[first:last],
        )

    def deciding(self) -> SpectrumPicture:
        """Return the part that holds the harmonics of every family."""
        top = max((comb.harmonics()[-1] for comb in self.combs), default=self.end)
        return self.cut(self.start, min(1.04 * top, self.end))

    def zoom(self) -> SpectrumPicture | None:
        """
        Return the neighbourhood of the first harmonic found; None if nothing is found.

        It includes the nominal harmonic and is 5 or 25 times a power of ten wide: on a laptop's
        screen Rerun numbers an axis at powers of ten, and a range of less than two such steps may
        have only one number.
        """
        found = self.found
        if found is None:
            return None
        at, least = found.fundamental, ZOOM_BINS * self.spacing
        off = (abs(at - c.fundamental) for c in self.combs if c.family == found.family)
        least = max(least, 1.2 * max(off))
        decade = 10.0 ** math.floor(math.log10(least / 2.5) + 1e-9)
        reach = next(r * decade for r in (2.5, 12.5, 25.0) if r * decade > least * (1.0 - 1e-9))
        return self.cut(at - reach, at + reach)


def low_high(values: NDArray[np.float64], edges: NDArray[np.integer]) -> NDArray[np.float64]:
    """Return the lowest and highest value from each edge to the next, shape (n, 2)."""
    pairs = [np.minimum.reduceat(values, edges), np.maximum.reduceat(values, edges)]
    return np.stack(pairs, axis=1)


def highest(values: NDArray[np.float64], most: int) -> tuple[NDArray[np.int64], int]:
    """
    Return at most ``most`` indices, each of the highest value of its group, and the group size.

    Peaks keep their frequency and height however few points are drawn.
    """
    group = max(1, -(-values.size // most))
    edges = np.arange(0, values.size, group)
    padded = np.full(edges.size * group, -np.inf)
    padded[: values.size] = values
    return edges + padded.reshape(-1, group).argmax(axis=1), group
