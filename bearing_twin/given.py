# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Values that a caller gives, checked before they change any state.

NumPy would turn text into numbers, drop imaginary parts and masks, and round huge integers. Here
such values are errors.
"""

from __future__ import annotations

from typing import Any

from bearing_twin.errors import BearingTwinError
import numpy as np
from numpy.typing import NDArray


def real_numbers(name: str, values: Any) -> NDArray[np.float64]:
    """
    Return real numbers of any shape as an array.

    Raises
    ------
    BearingTwinError
        If the values are text, complex, truth values, masked, ragged, or integers that no integer
        of NumPy holds.

    Examples
    --------
    >>> real_numbers('x', [1, 2])
    array([1., 2.])
    >>> real_numbers('x', ['1', '2'])
    Traceback (most recent call last):
    bearing_twin.errors.BearingTwinError: x holds <U1, e.g. '1'; give real numbers

    """
    try:
        found = np.asarray(values)
    except (OverflowError, TypeError, ValueError):
        msg = f'{name} has rows of different lengths or no numbers; give real numbers'
        raise BearingTwinError(msg) from None
    if np.ma.is_masked(values):
        raise BearingTwinError(f'{name} has masked values; fill them first, e.g. with NaN')
    if found.dtype.kind not in 'fiu':
        example = ''.join(f', e.g. {value!r:.40}' for value in found.reshape(-1)[:1].tolist())
        raise BearingTwinError(f'{name} holds {found.dtype}{example}; give real numbers')
    # Signalling NaN and the largest long doubles would warn.
    with np.errstate(invalid='ignore', over='ignore'):
        return found.astype(np.float64, copy=False)


def real_number(name: str, value: Any) -> float:
    """
    Return one real number, NaN and infinity included.

    Examples
    --------
    >>> real_number('shaft_hz', '25')
    Traceback (most recent call last):
    bearing_twin.errors.BearingTwinError: shaft_hz='25' is not a real number; give one

    """
    if isinstance(value, float):
        return float(value)
    try:
        found = real_numbers(name, value)
    except BearingTwinError:
        found = np.empty(0)
    if found.shape != ():
        raise BearingTwinError(f'{name}={value!r:.40} is not a real number; give one')
    return float(found)


def check_kind(name: str, value: Any, kind: type, remedy: str) -> None:
    """
    Refuse a value that is no instance of a class.

    Examples
    --------
    >>> check_kind('load', '5', float, 'give it in N')
    Traceback (most recent call last):
    bearing_twin.errors.BearingTwinError: load='5' is not a float; give it in N

    """
    if not isinstance(value, kind):
        raise BearingTwinError(f'{name}={value!r:.40} is not a {kind.__name__}; {remedy}')


def one_axis(values: Any, name: str = 'x') -> NDArray[np.float64]:
    """
    Return the samples of one axis, shape (n,).

    Examples
    --------
    >>> one_axis([[1.0, 2.0]])
    Traceback (most recent call last):
    bearing_twin.errors.BearingTwinError: x has shape (1, 2); give one axis as a 1-D array

    """
    found = real_numbers(name, values)
    if found.ndim != 1:
        raise BearingTwinError(f'{name} has shape {found.shape}; give one axis as a 1-D array')
    return found
