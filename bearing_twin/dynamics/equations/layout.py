# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Record types of the kernel state and constants, with fields that compiled code reads by name.

Fields of four elements are in the order x_i, y_i, x_o, y_o.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

_F = np.float64
Records: TypeAlias = npt.NDArray[Any]
Record: TypeAlias = Any
"""Element of a record array; its fields are attributes."""


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
    Return one record of ``kind`` from ``values`` and the attributes of ``owners``.

    A field without a value takes the attribute of its name from the first owner that has it.

    Raises
    ------
    TypeError
        If a field has no value, or a value has no field.

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
        *_numbers('loaded near'),  # see `integrator._balls_force`
        *((name, _F, 4) for name in ('next_q', 'next_v', 'next_a')),
        ('next_step', _F),  # the step to which the three above are predicted, s
    ]
)
"""State of one bearing."""

PRECISE = 'load_turns ftf_order spin_order jitter'
"""Constants of the phases, which a fleet also has in double precision."""
SINGLE = (
    'd_ball inner_radius outer_radius resonance resonance_damping step snaps steps reads stiff'
)
"""Constants of the kernel of one bearing that a fleet does not have."""
MACHINE = np.dtype(
    [
        *_numbers('inner_light inner_stiffness inner_damping'),  # light: reciprocal mass, 1/kg
        *_numbers('outer_light outer_stiffness_x outer_stiffness_y'),
        *_numbers('outer_damping_x outer_damping_y'),
        *_numbers('up_x up_y load_turns'),  # against the load; direction of the load, turns
        *_numbers('contact_damping unbalance ftf_order spin_order'),
        *_numbers('jitter noise'),  # random walk of the cage (see `tables.machine`), sensor noise
        *_numbers('d_ball inner_radius outer_radius'),  # radii of the races at the contacts, m
        *_numbers('resonance resonance_damping'),  # of the sensor, rad/s and damping ratio
        *_numbers('step snaps'),  # s; 1 if the predictor uses the snap
        ('steps', np.int64),  # steps per output sample
        ('reads', np.int64),  # sensor samples per step
        ('stiff', np.int64),  # whether every step has to be short
        ('n_balls', np.int64),
    ]
)
"""Constants of one bearing; each lane of a fleet has those that are not in `SINGLE`."""

DEFECT = np.dtype(
    [
        ('place', np.int64),  # index into `bearing.PLACES`
        *_numbers('profile half depth angle'),  # codes of `model.PROFILES`; m, m, turns
        ('ball', np.int64),
        *_numbers('inner_curvature outer_curvature'),  # of the ball path on the race, 1/m
        *_numbers('inner_kink outer_kink'),  # see `model.Profile`
    ]
)
"""One defect."""

STEP = np.dtype(
    [
        *_numbers('turning k_b foot_x foot_y'),  # at the end of the step: rad/s, N/m^1.5, m
        *_numbers('pull_x pull_y pull_rate_x pull_rate_y'),  # unbalance, N and N/s
        *((name, _F, 3) for name in ('speeds', 'phases')),  # cage, shaft, spin: turns/s, turns
        *_numbers('cage_cos cage_sin shaft_cos shaft_sin'),  # at the start, as the phases
        ('kinked', np.int64),  # bit mask of balls whose path has a kink within the step
    ]
)
"""Prescribed kinematics of one step."""

GAP, GAP_RATE, COS, SIN = range(4)
"""Rows of the ball array of a step: gap (m), its rate (m/s), cosine and sine of the ball angle."""

LANES = 8
"""The number of balls is padded to a multiple of this, for vector instructions."""

SPIN_TURNS = 2.0
"""Period of the ball spin phase, turns: the length of the track of a ball."""

CHUNK = 32
"""Output samples, on a fixed grid, with a constant speed in the random walk of the cage. At each
grid point the phases are wrapped and their sines are computed again."""
