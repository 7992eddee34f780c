# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Record types of a group of `vector.L` bearings of a fleet, one lane per bearing.

The length of every field is a multiple of a cache line, so that loads and stores are aligned.
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
"""Steps between two instants at which the waviness under the balls is looked up."""

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
        # Weights of the phases in its position, and its angle (turns); passages per turn: slots of
        # a race or half turns of a ball, and their length (m); 1 on a race, 0 on a ball.
        *_lanes('by_cage by_shaft by_spin angle', _D),
        *_lanes('scale metres on_race'),
        # Ball that has the spall, only ball that a worn pocket acts on (-1: any); half width and
        # depth (m), profile; path curvature at even and odd half turns of a ball (1/m).
        *_lanes('ball only half depth profile even odd'),
        # Between two grid points: passages at the first and per step, speed along the spall (m/s),
        # slot of its ball, lowest and highest slot it acts on.
        *_lanes('passed growth speed fixed low high'),
        # At the present step: slot under it, depth of the ball (m) and its rate (m/s), fraction of
        # the step inside it.
        *_lanes('slot taken taken_rate share'),
    ]
)

GROUP = np.dtype(
    [
        # State: motion and sensor, directions of slot 0 and of the shaft (cos, sin, cos, sin);
        # phases of cage, shaft and spin at the last grid point (turns), and speeds (turns/s).
        *_rows('q v a j sensor directions', 4),
        *_lanes('cage shaft spin cage_hz shaft_hz spin_hz', _D),
        # Constants of `layout.MACHINE`, and those of a fleet only.
        *_lanes(PRECISE, _D),
        *_lanes(f'{SHARED} per_ball'),
        *_lanes('seed', np.uint64),
        *_rows('to_z to_w', 6),  # rows of `filters.resonator`
        *_rows('read', 3),
        # Nodes of the tables of `waviness`; largest gap reduction of a ball by waviness, m.
        *_lanes('outer_nodes inner_nodes ball_nodes', np.int64),
        *_lanes('highest'),
        # Prescribed between two grid points: inputs and their growth per step; rotation of the
        # directions by a step (cos, sin, cos, sin); speeds of cage and shaft (rad/s), unbalance
        # (N), random number of the cage walk.
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
"""State within a group: single-precision numbers, and double-precision numbers."""

BALL_COS, BALL_SIN, NUMBER = range(3)
"""Rows of a slot: direction (cos, sin) relative to slot 0, zero if a lane has no such ball;
negative slot number. Each ball is in a slot. Slot 0 has the last ball before the direction of the
load. Slots are numbered 0, 1, -1, 2, -2, ... to both sides, so that balls that may be loaded come
first."""
BALL_ROWS = 3
