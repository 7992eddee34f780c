# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Records of the kernel of one bearing: numpy types whose fields compiled code reads by name.

Quadruples hold what belongs to x_i, y_i, x_o, y_o in this order.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

_F = np.float64
Records: TypeAlias = npt.NDArray[Any]
Record: TypeAlias = Any
"""Element of an array of records, whose fields are attributes."""


def _numbers(names: str) -> list[tuple[str, type]]:
    return [(name, _F) for name in names.split()]


def constants(names: str) -> np.dtype[Any]:
    """
    Return the type of a record of numbers.

    Examples
    --------
    >>> constants('load clearance').names
    ('load', 'clearance')

    """
    return np.dtype((np.record, _numbers(names)))


def filled(kind: np.dtype[Any], *owners: Any, **values: Any) -> Records:
    """
    Return one record of ``kind``: ``values``, and for other fields the attributes of that name.

    Of the ``owners`` the first that has the attribute gives it.

    Raises
    ------
    TypeError
        If a field has no value, or a value no field.

    Examples
    --------
    >>> filled(constants('real imag size'), 3.0 + 4.0j, size=5.0).tolist()
    [(3.0, 4.0, 5.0)]

    """
    names = kind.names or ()
    for name in names:
        if name not in values:
            values[name] = next((getattr(o, name) for o in owners if hasattr(o, name)), None)
    if wrong := [name for name in values if name not in names or values[name] is None]:
        msg = f'fields without a value, or values without a field: {", ".join(wrong)}'
        raise TypeError(msg)
    return np.array([tuple(values[name] for name in names)], kind)


STATE = np.dtype(
    [
        *((name, _F, 4) for name in ('q', 'v', 'a', 'j')),  # position and three derivatives
        *_numbers('cage shaft spin'),  # phases, turns
        *_numbers('cage_cos cage_sin shaft_cos shaft_sin'),
        ('sensor', _F, 4),  # two states along x, two along y
        *_numbers('loaded near'),  # see `integrator.contact`
        *((name, _F, 4) for name in ('next_q', 'next_v', 'next_a')),
        ('next_step', _F),  # the step to which the three above are predicted, s
    ]
)
"""State of one bearing."""

PRECISE = 'load_turns ftf_order spin_order jitter'
"""Constants that a fleet has in double precision as well: of the phases."""
SINGLE = (
    'd_ball inner_radius outer_radius resonance resonance_damping step snaps steps reads stiff'
)
"""Constants that a fleet does not have."""
MACHINE = np.dtype(
    [
        *_numbers('inner_light inner_stiffness inner_damping'),  # reciprocal of the mass, 1/kg
        *_numbers('outer_light outer_stiffness_x outer_stiffness_y'),
        *_numbers('outer_damping_x outer_damping_y'),
        *_numbers('up_x up_y load_turns'),  # against the load; direction of the load, turns
        *_numbers('contact_damping unbalance ftf_order spin_order'),
        *_numbers('jitter noise'),  # walk of the cage (see `tables.machine`), sensor noise
        *_numbers('d_ball inner_radius outer_radius'),  # radii of the races at the contacts, m
        *_numbers('resonance resonance_damping'),  # of the sensor, rad/s and damping ratio
        *_numbers('step snaps'),  # s; 1 where the predictor takes the snap
        ('steps', np.int64),  # steps per output sample
        ('reads', np.int64),  # how often a step the sensor is read
        ('stiff', np.int64),  # whether every step has to be short
        ('n_balls', np.int64),
    ]
)
"""Constants of one bearing; what is not in `SINGLE` is in each lane of a fleet too."""

DEFECT = np.dtype(
    [
        ('place', np.int64),  # index into `parameters.PLACES`
        *_numbers('profile half depth angle'),  # codes of `model.PROFILES`; m, m, turns
        ('ball', np.int64),
        *_numbers('inner_curvature outer_curvature'),  # of a ball's path on the race, 1/m
        *_numbers('inner_kink outer_kink'),  # see `model.Profile`
    ]
)
"""One defect."""

STEP = np.dtype(
    [
        *_numbers('turning k_b foot_x foot_y'),  # at the end of the step: rad/s, N/m^1.5, m
        *_numbers('pull_x pull_y pull_rate_x pull_rate_y'),  # unbalance, N and N/s
        *((name, _F, 3) for name in ('speeds', 'phases')),  # cage, shaft, balls: turns/s; turns
        *_numbers('cage_cos cage_sin shaft_cos shaft_sin'),  # at the start, as the phases
        ('kinked', np.int64),  # balls, one bit each, whose path has a kink within the step
    ]
)
"""Prescribed kinematics of one step."""

GAP, GAP_RATE, COS, SIN = range(4)
"""Rows of the balls of a step: gap to close (m), its rate (m/s), direction."""

LANES = 8
"""Balls are padded to a multiple of this, so that the compiler can use vector instructions."""

SPIN_TURNS = 2.0
"""Turns after which the phase of the balls' spin begins anew: the length of a ball's track."""

CHUNK = 32
"""Output samples, on a fixed grid, over which the cage's random walk holds its speed. At each
grid point the phases are wrapped and the rotated sines are computed anew."""
