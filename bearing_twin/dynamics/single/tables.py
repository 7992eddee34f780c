# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Conversion of parameters to the records of the compiled kernels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_orders, PLACES
from bearing_twin.bearing.hertz import ellipses
from bearing_twin.dynamics.equations import filters, layout
from bearing_twin.dynamics.equations.layout import CHUNK, COS, DEFECT, GAP, LANES, SIN
from bearing_twin.dynamics.equations.model import PROFILES
from bearing_twin.dynamics.equations.statics import against_load
from bearing_twin.dynamics.single import objects
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.equations.layout import Records
    from bearing_twin.dynamics.parameters import TwinParameters
    from bearing_twin.dynamics.single.kernel import Tables


FloatArray = npt.NDArray[np.float64]


def machine(p: TwinParameters, sample_rate: float, steps: int, *, stiff: bool = False) -> Records:
    """
    Return the constants of one bearing, one record `layout.MACHINE`.

    The random walk of the cage has a variance of ``(2 pi jitter / Z)^2 rad^2`` per impact. Its
    constant ``jitter`` is a speed over the square root of the shaft speed; the random speed is
    constant for `layout.CHUNK` samples. For ``stiff`` rings the predictor does not use the snap.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> record = machine(preset('paper'), 25600.0, 1)[0]
    >>> float(record['step']) * 25600.0, int(record['n_balls'])
    (1.0, 8)

    """
    orders, bearing = fault_orders(p.bearing), p.bearing
    up_x, up_y = against_load(p)
    (stiffness_x, stiffness_y), (damping_x, damping_y) = p.housing_stiffness, p.housing_damping
    return layout.filled(
        layout.MACHINE, p, bearing,
        inner_light=1.0 / p.inner_mass, outer_light=1.0 / p.outer_mass,
        outer_stiffness_x=stiffness_x, outer_stiffness_y=stiffness_y,
        outer_damping_x=damping_x, outer_damping_y=damping_y,
        up_x=up_x, up_y=up_y, load_turns=p.load_angle / (2.0 * math.pi),
        ftf_order=orders.ftf, spin_order=orders.bsf,
        jitter=p.jitter / bearing.n_balls * math.sqrt(orders.bpfi * sample_rate / CHUNK),
        # Contact circles of the races; a contact angle moves them towards the pitch circle.
        inner_radius=0.5 * bearing.d_pitch * (1.0 - bearing.gamma),
        outer_radius=0.5 * bearing.d_pitch * (1.0 + bearing.gamma),
        resonance=2.0 * math.pi * p.resonance_hz,
        step=1.0 / (sample_rate * steps), snaps=not stiff, steps=steps, stiff=stiff,
        reads=filters.oversampling(sample_rate) // steps,
    )  # fmt: skip


def defect_table(p: TwinParameters) -> Records:
    """
    Return one record `layout.DEFECT` per defect.

    Depths of defects are along the contact normal, but the kernel has radial gaps: at a contact
    angle alpha a depth s opens a gap of s / cos(alpha).

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> defect_table(preset('paper'))['half'].tolist()  # half of 2.45 mm
    [0.001225]

    """
    d, g = p.bearing.d_ball, p.bearing.gamma
    radial = 1.0 / math.cos(p.bearing.contact_angle)
    curvatures = radial / (d * (1.0 - g)), radial / (d * (1.0 + g))
    rows = []
    for defect in p.defects:
        profile, half = PROFILES[defect.profile], 0.5 * defect.width
        depth = radial * defect.depth
        kinks = (profile.kink(half, depth, curvature) for curvature in curvatures)
        rows.append(
            (
                PLACES.index(defect.place), profile.code, half, depth,
                defect.angle / (2.0 * math.pi), defect.ball, *curvatures, *kinks,
            )
        )  # fmt: skip
    return np.array(rows, DEFECT)


def ball_table(p: TwinParameters) -> FloatArray:
    """
    Return undersize and direction in the cage of each ball, float64[4, padded].

    Balls in the padding are undersized by a metre, so that they never touch.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> ball_table(preset('paper'))[COS].round(2).tolist()
    [1.0, 0.71, 0.0, -0.71, -1.0, -0.71, -0.0, 0.71]

    """
    n = p.bearing.n_balls
    table = np.zeros((4, -(-n // LANES) * LANES))
    table[GAP, n:] = 1.0
    angle = 2.0 * math.pi * np.arange(n) / n
    table[COS, :n], table[SIN, :n] = np.cos(angle), np.sin(angle)
    return table


def equations_of(p: TwinParameters, constants: Records, tables: Tables) -> objects.Equations:
    """
    Return the object of compiled code from the records of one bearing.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset, Simulator
    >>> simulator, p = Simulator(preset('paper')), preset('paper')
    >>> isinstance(equations_of(p, simulator.constants, simulator.tables), objects.Equations)
    True

    """
    deepest = max([defect.depth for defect in p.defects], default=0.0)
    return objects.equations(constants, tables, ellipses(p.bearing), deepest)
