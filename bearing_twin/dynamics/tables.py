# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters laid out in the arrays that the compiled kernels take."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_orders, PLACES
from bearing_twin.dynamics import layout
from bearing_twin.dynamics.parameters import PROFILES
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters

__all__ = ['ball_table', 'constants', 'defect_table']

FloatArray = npt.NDArray[np.float64]


def constants(
    p: TwinParameters, sample_rate: float, steps: int, *, snaps: bool = True
) -> FloatArray:
    """
    Return the constants of one bearing, float64[layout.CONST_SIZE].

    The cage's walk has the variance per impact of ``(2 pi jitter / Z)^2 rad^2``, as a speed that
    is held for `layout.CHUNK` samples, over the root of the shaft speed. With ``snaps`` the
    predictor takes the snap.
    """
    orders = fault_orders(p.bearing)
    spread = p.jitter / p.bearing.n_balls
    const = np.zeros(layout.CONST_SIZE)
    const[layout.MI], const[layout.KI], const[layout.CI] = (
        p.inner_mass,
        p.inner_stiffness,
        p.inner_damping,
    )
    const[layout.MO], const[layout.KO], const[layout.CO] = (
        p.outer_mass,
        p.outer_stiffness,
        p.outer_damping,
    )
    const[layout.CB], const[layout.UNBALANCE] = p.contact_damping, p.unbalance
    const[layout.FTF_ORDER], const[layout.SPIN_ORDER] = orders.ftf, orders.bsf
    const[layout.JITTER] = spread * math.sqrt(orders.bpfi * sample_rate / layout.CHUNK)
    const[layout.NOISE_STD] = p.noise
    const[layout.STEP] = 1.0 / (sample_rate * steps)
    const[layout.SNAPS] = snaps
    const[layout.RESONANCE] = 2.0 * math.pi * p.resonance_hz
    const[layout.RESONANCE_DAMPING] = p.resonance_damping
    const[layout.D_BALL] = p.bearing.d_ball
    # Of the circles on which the balls touch the races; nearer to the pitch at a contact angle.
    const[layout.R_INNER] = 0.5 * p.bearing.d_pitch * (1.0 - p.bearing.gamma)
    const[layout.R_OUTER] = 0.5 * p.bearing.d_pitch * (1.0 + p.bearing.gamma)
    return const


def defect_table(p: TwinParameters) -> FloatArray:
    """
    Return one row a defect, float64[n, layout.DEFECT_SIZE].

    Depths are along the contact normal. The kernel works with radial gaps: a ball that sinks in
    by s at a contact angle alpha opens one of s / cos(alpha).
    """
    d, g = p.bearing.d_ball, p.bearing.gamma
    radial = 1.0 / math.cos(p.bearing.contact_angle)
    table = np.zeros((len(p.defects), layout.DEFECT_SIZE))
    for row, defect in zip(table, p.defects, strict=True):
        row[layout.PLACE] = PLACES.index(defect.place)
        row[layout.PROFILE] = PROFILES.index(defect.profile)
        row[layout.HALF], row[layout.FULL_DEPTH] = 0.5 * defect.width, radial * defect.depth
        row[layout.ANGLE], row[layout.BALL] = defect.angle / (2.0 * math.pi), defect.ball
        row[layout.PATH_INNER] = radial / (d * (1.0 - g))
        row[layout.PATH_OUTER] = radial / (d * (1.0 + g))
        row[layout.KINK_INNER] = _kink(row, row[layout.PATH_INNER])
        row[layout.KINK_OUTER] = _kink(row, row[layout.PATH_OUTER])
    return table


def _kink(row: FloatArray, curvature: float) -> float:
    """Where the path of a ball has a kink besides that at the edges, m; -1 if nowhere."""
    profile, half = PROFILES[int(row[layout.PROFILE])], row[layout.HALF]
    if profile == 'ball':  # where it touches the ground, or rolls over from edge to edge
        return max(0.0, float(half - math.sqrt(row[layout.FULL_DEPTH] / curvature)))
    return 0.5 * float(half) if profile == 'smooth' else -1.0


def ball_table(p: TwinParameters) -> FloatArray:
    """
    Return direction in the cage and undersize of each ball, float64[3, padded].

    The padding is undersized by a metre, so that it never touches.
    """
    n = p.bearing.n_balls
    table = np.zeros((3, -(-n // layout.LANES) * layout.LANES))
    table[layout.UNDERSIZE, n:] = 1.0
    angle = 2.0 * math.pi * np.arange(n) / n
    table[layout.BALL_COS, :n], table[layout.BALL_SIN, :n] = np.cos(angle), np.sin(angle)
    return table
