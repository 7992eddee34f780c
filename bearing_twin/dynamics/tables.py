# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters laid out in the arrays that the compiled kernels take."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_orders
from bearing_twin.dynamics import kernel
from bearing_twin.dynamics.parameters import PLACES, PROFILES
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters

__all__ = ['ball_table', 'constants', 'defect_table']

FloatArray = npt.NDArray[np.float64]


def constants(p: TwinParameters, sample_rate: float, oversample: int) -> FloatArray:
    """
    Return the constants of one bearing, float64[kernel.CONST_SIZE].

    The cage's walk has the variance per impact of ``(2 pi jitter / Z)^2 rad^2``, as a speed that
    is held for `kernel.CHUNK` samples, over the root of the shaft speed.
    """
    orders = fault_orders(p.bearing)
    spread = p.jitter / p.bearing.n_balls
    const = np.zeros(kernel.CONST_SIZE)
    const[kernel.MI], const[kernel.KI], const[kernel.CI] = (
        p.inner_mass,
        p.inner_stiffness,
        p.inner_damping,
    )
    const[kernel.MO], const[kernel.KO], const[kernel.CO] = (
        p.outer_mass,
        p.outer_stiffness,
        p.outer_damping,
    )
    const[kernel.CB], const[kernel.UNBALANCE] = p.contact_damping, p.unbalance
    const[kernel.FTF_ORDER], const[kernel.SPIN_ORDER] = orders.ftf, orders.bsf
    const[kernel.JITTER] = spread * math.sqrt(orders.bpfi * sample_rate / kernel.CHUNK)
    const[kernel.NOISE_STD] = p.noise
    const[kernel.STEP] = 1.0 / (sample_rate * oversample)
    const[kernel.D_BALL] = p.bearing.d_ball
    const[kernel.R_INNER] = 0.5 * (p.bearing.d_pitch - p.bearing.d_ball)
    const[kernel.R_OUTER] = 0.5 * (p.bearing.d_pitch + p.bearing.d_ball)
    return const


def defect_table(p: TwinParameters) -> FloatArray:
    """Return one row a defect, float64[n, kernel.DEFECT_SIZE]."""
    d, pitch = p.bearing.d_ball, p.bearing.d_pitch
    table = np.zeros((len(p.defects), kernel.DEFECT_SIZE))
    for row, defect in zip(table, p.defects, strict=True):
        row[kernel.PLACE] = PLACES.index(defect.place)
        row[kernel.PROFILE] = PROFILES.index(defect.profile)
        row[kernel.HALF], row[kernel.FULL_DEPTH] = 0.5 * defect.width, defect.depth
        row[kernel.ANGLE], row[kernel.BALL] = defect.angle / (2.0 * math.pi), defect.ball
        row[kernel.PATH_INNER] = 1.0 / d + 1.0 / (pitch - d)
        row[kernel.PATH_OUTER] = 1.0 / d - 1.0 / (pitch + d)
    return table


def ball_table(p: TwinParameters) -> FloatArray:
    """
    Return direction in the cage and undersize of each ball, float64[3, padded].

    The padding is undersized by a metre, so that it never touches.
    """
    n = p.bearing.n_balls
    table = np.zeros((3, -(-n // kernel.LANES) * kernel.LANES))
    table[kernel.UNDERSIZE, n:] = 1.0
    angle = 2.0 * math.pi * np.arange(n) / n
    table[kernel.BALL_COS, :n], table[kernel.BALL_SIN, :n] = np.cos(angle), np.sin(angle)
    return table
