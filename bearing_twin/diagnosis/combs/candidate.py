# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Candidates: combs that may belong to a fault place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from bearing_twin.diagnosis.thresholds import HARMONICS, INDEX_SUSPECT, Z_CAGE, Z_FAULT

RACES = ('inner', 'outer')
"""Places whose shaft sidebands are measured."""
UNTESTED = 1.0
"""Sideband ratio of a comb whose sidebands were not measured."""


@dataclass(frozen=True)
class Candidate:
    """
    The best comb of one fault place.

    >>> inner = Candidate('inner', order=4.93, slip=0.01, z=9.0, index=0.8)
    >>> inner.weight, str(inner)
    (7.2, 'inner: comb at 4.930 orders, significance 9.0, modulation index 0.80')
    """

    place: str
    order: float
    """Measured fundamental, in multiples of the shaft speed."""
    slip: float
    """Cage slip that explains the order."""
    z: float
    """Score less the cost of the slip, standard deviations."""
    index: float
    """Modulation index."""
    band: int = 0
    """Index of the band in the band tree."""
    harmonics: int = HARMONICS
    """Number of harmonics that no multiple of the shaft masks."""
    shaft_sideband_ratio: float = UNTESTED
    """Mean amplitude of the shaft sidebands over that of the harmonics."""

    @property
    def weight(self) -> float:
        """
        Weight for comparing faults that claim the same lines.

        The sidebands of a race fault are lower than its harmonics. So a comb beside higher lines
        is more likely a sideband itself.
        """
        return self.z * self.index / max(self.shaft_sideband_ratio, 0.25)

    @property
    def significant(self) -> bool:
        """Whether the comb is neither chance nor too weak to be reported."""
        least = Z_CAGE if self.place == 'cage' else Z_FAULT
        return self.z >= least and self.index >= INDEX_SUSPECT and self.harmonics >= 2

    def __str__(self) -> str:
        what = 'impacts' if self.place == 'elsewhere' else f'{self.place}: comb'
        return (
            f'{what} at {self.order:.3f} orders, significance {self.z:.1f}, '
            f'modulation index {self.index:.2f}'
        )


class Claims(NamedTuple):
    """Combs, after each comb that two places claim has been assigned to one of them."""

    kept: tuple[Candidate, ...]
    contested: tuple[tuple[Candidate, Candidate], ...] = ()
    """Pairs of (stronger, weaker) if neither sidebands nor slip tell the place of a comb."""


class LoadZone(NamedTuple):
    """Combs that are no shaft sidebands of an inner race in the load zone."""

    kept: tuple[Candidate, ...]
    uncertain: Candidate | None = None
    """Removed comb that is the strongest, if the inner race's comb is not clearly stronger."""
