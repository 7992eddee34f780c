# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Fields of numba's objects are known to compiled code only.
# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""
One bearing as a numba object (structref) for compiled functions.

Passing an object to a compiled function takes one microsecond. Passing the same tables as a nested
tuple takes four, because every call inspects each array in it.
"""

from __future__ import annotations

from typing import Any

from bearing_twin.numerics.compiled import compiled
from numba import types
from numba.experimental import structref


class _Fields(types.StructRef):
    """Numba type of an object; literal types of numbers become general ones."""

    def preprocess_fields(self, fields):
        return tuple((name, types.unliteral(kind)) for name, kind in fields)


@structref.register
class _EquationsType(_Fields):
    """Type of `Equations`."""


@structref.register
class _MotionType(_Fields):
    """Type of `Motion`."""


class Equations(structref.StructRefProxy):
    """Constants for the equations and the condition of one bearing; see :func:`equations`."""


class Motion(structref.StructRefProxy):
    """One bearing with its state; see :func:`motion`."""


structref.define_proxy(Equations, _EquationsType, ['constants', 'tables', 'contacts', 'deepest'])
structref.define_proxy(
    Motion, _MotionType,
    [
        'equations', 'resonators', 'taps', 'states', 'history', 'values', 'rings', 'drift', 'fade',
    ],
)  # fmt: skip


@compiled()
def equations(constants: Any, tables: Any, contacts: Any, deepest: float) -> Equations:
    """
    Return the `Equations` of one bearing.

    ``constants`` is a record of `coefficients.CONSTANTS`, ``tables`` `kernel.Tables`, ``contacts``
    `hertz.ellipses` of the bearing, and ``deepest`` the greatest depth of its defects, m.
    """
    return Equations(constants, tables, contacts, deepest)


@compiled()
def motion(
    equations: Equations,
    resonators: Any,
    taps: Any,
    states: Any,
    history: Any,
    values: Any,
    rings: Any,
    drift: Any,
    fade: Any,
) -> Motion:
    """
    Return the `Motion` of one bearing; advancing it changes the arrays in place.

    ``values`` are those of `coefficients.evaluate` at the next sample with both rings at the outer
    ring temperature. ``rings`` and ``drift`` are as in `inner_ring`, the others as in
    `kernel.advance`.
    """
    return Motion(equations, resonators, taps, states, history, values, rings, drift, fade)
