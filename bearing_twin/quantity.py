# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Declare a quantity once, beside its field: unit, range, choices and description.

A dataclass declares its fields with :func:`quantity` and checks them with :func:`check_fields`.
Node parameters, offline runs, fleet files and the tables of the documentation read the same
declaration. :func:`signed` writes a difference of two values.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, MISSING
import functools
from numbers import Integral
from types import MappingProxyType
from typing import Any, cast

from bearing_twin.errors import BearingTwinError

LONGEST_TEXT = 4096
"""Longest text that is accepted as a value, characters: the longest path on Linux."""


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """Meaning, unit and permitted values of a quantity."""

    description: str
    unit: str = ''
    low: float | None = None
    high: float | None = None
    choices: tuple[str, ...] = ()
    special: tuple[Any, str] | None = None
    """A value that is valid outside the range, and its meaning: ``(0.0, 'none')``."""
    running: bool = True
    """Whether it can be changed while a node is active, or only in state 'unconfigured'."""

    @property
    def special_text(self) -> str:
        """Return the special value and its meaning as ``0: none``; '' if there is none."""
        if self.special is None or self.special[0] is None:
            return ''
        value, meaning = self.special
        return f'{value:g}: {meaning}' if value != '' else f"'': {meaning}"

    def check(self, name: str, value: Any) -> None:
        """
        Refuse a value that is not finite, out of range, not one of the choices, or too long.

        Examples
        --------
        >>> Quantity(description='Mass.', unit='kg', low=0.1, high=5.0).check('mass', 0.0)
        Traceback (most recent call last):
        bearing_twin.errors.BearingTwinError: mass=0.0 is outside 0.1..5 kg; choose a value inside

        """
        if self.special is not None and value == self.special[0]:
            return
        if isinstance(value, str) and len(value) > LONGEST_TEXT:
            msg = f'{name}: {len(value)} characters are too many; give {LONGEST_TEXT} at most'
            raise BearingTwinError(msg)
        remedy = f' ({self.special_text})' if self.special_text else ''
        if self.choices and value not in self.choices:
            known = ', '.join(choice or "''" for choice in self.choices)
            msg = f'{name}={value!r} is not one of {known}; choose one of these{remedy}'
            raise BearingTwinError(msg)
        if self.low is not None and self.high is not None:
            check_range(name, value, self.low, self.high, self.unit, remedy)


def check_range(
    name: str, value: float, low: float, high: float, unit: str, remedy: str = ''
) -> None:
    """Refuse a ``value`` that is not finite or outside ``low``..``high``."""
    try:
        if low <= value <= high:
            return
        if name.endswith('shaft_hz') and low <= value / 60.0 <= high:
            remedy = f': {value:g} 1/min are {value / 60.0:.5g} Hz'
        wrong, remedy = f'{value} is outside', f'; choose a value inside{remedy}'
    except (TypeError, ValueError):
        # Text, None, a complex number or an array.
        wrong = f'{value!r:.40} is not a number; give one of'
    limits = f'{low:g}..{high:g} {unit}'.rstrip()
    raise BearingTwinError(f'{name}={wrong} {limits}{remedy}')


def check_whole(name: str, value: int) -> None:
    """Refuse a ``value`` that is not an integer: a conversion would drop its fraction."""
    if not isinstance(value, Integral):
        msg = f'{name}={value!r} is not a whole number; give one without a decimal point'
        raise BearingTwinError(msg)


def quantity(
    default: Any,
    description: str,
    unit: str = '',
    low: float | None = None,
    high: float | None = None,
    **more: Any,
) -> Any:
    """
    Return a dataclass field; it is required if ``default`` is ``...``.

    ``more`` holds further fields of :class:`Quantity`.
    """
    about = Quantity(description=description, unit=unit, low=low, high=high, **more)
    return field(default=MISSING if default is ... else default, metadata={'quantity': about})


@functools.cache
def quantities(owner: Any) -> Mapping[str, tuple[Any, Quantity]]:
    """Return default and declaration of each quantity of a dataclass, by field name."""
    return MappingProxyType(
        {
            f.name: (f.default, f.metadata['quantity'])
            for f in fields(owner)
            if 'quantity' in f.metadata
        }
    )


def check_fields(instance: Any, prefix: str = '') -> None:
    """Refuse an instance of a dataclass if one of its quantities is outside its limits."""
    for name, (_, about) in quantities(cast('Any', type(instance))).items():
        about.check(prefix + name, getattr(instance, name))


def signed(difference: float, digits: int = 1) -> str:
    """
    Return a difference with its sign and so many digits; what rounds to zero is ``+0``.

    >>> signed(6.04), signed(-0.04), signed(-0.4, 0)
    ('+6.0', '+0.0', '+0')

    """
    # Adding zero turns -0.0 into 0.0.
    return f'{round(difference, digits) + 0.0:+.{digits}f}'
