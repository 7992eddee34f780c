# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Grid of the settings that the paper leaves open: where the amplitude falls with beta0."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
import itertools
from typing import TYPE_CHECKING

from bearing_twin.paper import settings
from bearing_twin.paper.runs import RunSpec
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import Profile


FloatArray = npt.NDArray[np.float64]

RATE = 25600.0
PATHS = {'ball': 'path of a ball', 'rect': "equation 8's window"}
STATES: tuple[tuple[settings.Factor, float], ...] = (
    ('friction', settings.COLD),
    ('expansion', settings.HOT),
    ('friction', settings.HOT),
)
"""Factor and temperature of the three runs of a point, in order of beta0."""


@dataclass(frozen=True, kw_only=True)
class Space:
    """Values of the settings. A statement is judged by the share of them in which it holds."""

    profiles: tuple[Profile, ...] = ('ball', 'rect')
    speeds: tuple[float, ...] = (22.0, 25.4, 29.0)
    loads: tuple[float, ...] = (500.0, 1600.0, 3200.0)
    widths: tuple[float, ...] = (0.8e-3, 1.2e-3, 1.6e-3, 2.0e-3, 2.4e-3, 2.8e-3, 3.2e-3, 4.0e-3)
    depths: tuple[float, ...] = (15e-6, 40e-6, 80e-6)
    clearances: tuple[float, ...] = (0.0, 10e-6)

    @property
    def shape(self) -> tuple[int, ...]:
        """Return the number of values of each, in this order."""
        return tuple(len(getattr(self, field.name)) for field in dataclasses.fields(self))

    def specs(self) -> list[RunSpec]:
        """Return three runs per point: beta0 = 1, expansion at 110 degC, friction at 110 degC."""
        axes = (getattr(self, field.name) for field in dataclasses.fields(self))
        return [
            RunSpec(
                preset='paper', factor=factor, temperature=t, profile=profile, shaft_hz=speed,
                load=load, width=width, depth=depth, clearance=clearance, rate=RATE,
            )
            for profile, speed, load, width, depth, clearance in itertools.product(*axes)
            for factor, t in STATES
        ]  # fmt: skip


SPACE = Space()


@dataclass(frozen=True, kw_only=True)
class Grid:
    """
    How the amplitude follows beta0 in a space of settings.

    All temperature trends of the model are one statement: A falls with beta0. Expansion and
    hardness test it with changes of beta0 by 1 %, friction and all factors by 12 %.
    """

    space: Space
    small: FloatArray
    """d ln(amplitude) / d ln(beta0) for the change through expansion, shape ``space.shape``."""
    large: FloatArray
    """The same for the change through friction."""

    @property
    def falls(self) -> npt.NDArray[np.bool_]:
        """Where the amplitude falls with both, so that all four trends hold."""
        return (self.small < 0.0) & (self.large < 0.0)
