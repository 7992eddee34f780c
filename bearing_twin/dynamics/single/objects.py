# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Fields of numba's objects are known to compiled code only.
# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""
One bearing as an object of compiled code.

To give a compiled function an object costs a microsecond; to give it the same tables as a nested
tuple costs four, because each array in it is looked at anew in every call.
"""

from __future__ import annotations

from typing import Any

from bearing_twin.numerics.compiled import compiled
from numba import types
from numba.experimental import structref


class _Fields(types.StructRef):
    """Type of an object; a number in it may take any value."""

    def preprocess_fields(self, fields):
        return tuple((name, types.unliteral(kind)) for name, kind in fields)


@structref.register
class _EquationsType(_Fields):
    """Type of `Equations`."""


@structref.register
class _MotionType(_Fields):
    """Type of `Motion`."""


class Equations(structref.StructRefProxy):
    """What the equations of one bearing take, and its condition; see :func:`equations`."""


class Motion(structref.StructRefProxy):
    """One bearing that moves; see :func:`motion`."""


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
    Put together what the equations of one bearing take.

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
    Put together a bearing that moves; its arrays are changed in place.

    ``values`` are those of `coefficients.evaluate` at the next sample with the outer ring's
    temperature for both, ``rings`` and ``drift`` as in `inner_ring`, the others as in
    `kernel.advance`.
    """
    return Motion(equations, resonators, taps, states, history, values, rings, drift, fade)
