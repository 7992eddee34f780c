# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Record of a group of `vector.L` bearings of a fleet, one lane each.

Every field is whole cache lines long, so that lanes are loaded and stored aligned.
"""

from __future__ import annotations

from typing import Any

from bearing_twin.dynamics.equations.coefficients import INPUTS
from bearing_twin.dynamics.equations.layout import MACHINE, PRECISE, SINGLE
from bearing_twin.dynamics.parameters import MAX_DEFECTS
from bearing_twin.numerics.vector import L
import numpy as np

MAX_SPALLS = MAX_DEFECTS
"""Most spalls of one bearing of a fleet."""

WAVE_STEPS = 3
"""Steps between the instants at which the waves under the balls are looked up."""

_APART = f'{PRECISE} {SINGLE}'.split()
SHARED = ' '.join(name for name in MACHINE.names or () if name not in _APART)
"""Constants of `layout.MACHINE` that lanes have in single precision."""

_F, _D = np.float32, np.float64


def _lanes(names: str, kind: type = _F) -> list[tuple[Any, ...]]:
    return [(name, kind, L) for name in names.split()]


def _rows(names: str, rows: int) -> list[tuple[Any, ...]]:
    return [(name, _F, (rows, L)) for name in names.split()]


SPALL = np.dtype(
    [
        # Phases that it follows, and where it is (turns); slots of balls or halves of a ball's
        # turn per turn of these, their length (m); 1 on a race, 0 on a ball.
        *_lanes('by_cage by_shaft by_spin angle', _D),
        *_lanes('scale metres on_race'),
        # The ball that bears it, the only ball it acts on (-1: any); half width and depth (m),
        # profile; curvature of the path at even and odd halves of a ball's turn (1/m).
        *_lanes('ball only half depth profile even odd'),
        # From a grid point to the next: slots passed at it and per step, speed along it (m/s),
        # slot of its ball, lowest and highest slot it acts on.
        *_lanes('passed growth speed fixed low high'),
        # At the present step: slot under which it is, what it takes from the contact (m) and at
        # what rate (m/s), how much of the step.
        *_lanes('slot taken taken_rate share'),
    ]
)

GROUP = np.dtype(
    [
        # Carried on: motion and sensor, directions of slot 0 and of the shaft (cos, sin, cos,
        # sin); phases of cage, shaft and spin at the last grid point, and their speeds.
        *_rows('q v a j sensor directions', 4),
        *_lanes('cage shaft spin cage_hz shaft_hz spin_hz', _D),
        # Constants of `layout.MACHINE`, and what only a fleet has.
        *_lanes(PRECISE, _D),
        *_lanes(f'{SHARED} per_ball'),
        *_lanes('seed', np.uint64),
        *_rows('to_z to_w', 6),  # rows of `filters.resonator`
        *_rows('read', 3),
        # Nodes of the tables of `waviness`; the highest wave of any ball, m.
        *_lanes('outer_nodes inner_nodes ball_nodes', np.int64),
        *_lanes('highest'),
        # Prescribed from a grid point to the next: inputs and their growth per step; directions
        # turned by a step; speeds (rad/s), unbalance (N), random number of the cage's walk.
        ('inputs', _F, (INPUTS, 2, L)),
        *_rows('turned', 4),
        *_lanes('turning omega pull walk'),
        ('spalls', SPALL, MAX_SPALLS),
        # Most balls and spalls of any lane, whether any has waviness.
        ('balls_in', np.int64),
        ('spalls_in', np.int64),
        ('wavy', np.int64),
        ('padding', np.int64, 5),
    ]
)
CARRIED = slice(24 * L), slice(12 * L, 18 * L)
"""Numbers of single precision that are carried on, and of double precision."""

BALL_COS, BALL_SIN, NUMBER = range(3)
"""Rows of a slot. Balls stand in slots, whose numbers go 0, 1, -1, 2, -2, ... from the direction
of the load to both sides; slot 0 is the last ball before it. So those that may be loaded come
first. Rows: direction relative to slot 0, zero where a lane has no such ball; negative number."""
BALL_ROWS = 3
