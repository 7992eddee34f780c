# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Inner ring temperature and its effect on the inputs of the kernels, in the physical mode.

The inputs of the kernels have two parts: the values for equal ring temperatures, ramped over a
block, and a drift, the effect of the temperature difference. The drift is computed at the ticks of
a fixed grid of samples and ramped from tick to tick. Ticks do not depend on the blocks, so
splitting a block changes no bit.

``rings``, float64[2], are the inner ring temperatures at the last and the next tick, degC; NaN in
the paper's mode. ``drift``, float64[2, INPUTS], is the addition to the inputs at the last tick,
and its growth per output sample. A tick has ``tick`` samples.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.dynamics.equations import coefficients
from bearing_twin.numerics.compiled import compiled
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.equations.layout import Records

FloatArray = npt.NDArray[np.float64]

_TICK = 0.1
"""Interval between updates of the temperature, s; its time constant is several seconds."""


def tick_length(sample_rate: float) -> int:
    """
    Return the number of output samples per tick.

    Examples
    --------
    >>> tick_length(25600.0)
    2560

    """
    return max(1, round(_TICK * sample_rate))


@compiled()
def temperature(rings: FloatArray, since_tick: int, tick: int) -> float:
    """
    Inner ring temperature ``since_tick`` samples after the last tick, degC.

    Examples
    --------
    >>> temperature(np.array([60.0, 61.0]), since_tick=640, tick=2560)
    60.25

    """
    inner: float = rings[0] + (rings[1] - rings[0]) * (since_tick / tick)
    return inner


@compiled()
def inputs(
    values: FloatArray, behind: FloatArray, drift: FloatArray, since_tick: int
) -> FloatArray:
    """
    Return the inputs of the equations, float64[..., INPUTS], ``since_tick`` samples after a tick.

    They are in the order of the kernels. ``values`` come from `coefficients.evaluate`; ``behind``
    is the remaining distance of the inputs from them after a change.

    Examples
    --------
    >>> drift = np.zeros((2, coefficients.INPUTS))
    >>> drift[:, coefficients.CLEARANCE] = -1e-6, 1e-9
    >>> values = np.full(coefficients.CONDITION_SIZE, 5e-6)
    >>> at = inputs(values, np.zeros(coefficients.INPUTS), drift, since_tick=640)
    >>> round(1e6 * float(at[coefficients.CLEARANCE]), 2)
    4.64

    """
    total: FloatArray = values[..., : coefficients.INPUTS] + behind
    total += drift[..., 0, :] + drift[..., 1, :] * since_tick
    return total


def settle(
    constants: Records,
    isothermal: FloatArray,
    outer: float,
    hz: float,
    rings: FloatArray,
    drift: FloatArray,
) -> None:
    """
    Set the inner ring to its steady state; the module describes ``rings`` and ``drift``.

    ``isothermal`` are the values of `coefficients.evaluate` with both rings at ``outer``, degC.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> constants = coefficients.constants_of(preset('incipient', thermal_mode='physical'))
    >>> rings, drift = np.empty(2), np.empty((2, coefficients.INPUTS))
    >>> isothermal = np.empty(coefficients.CONDITION_SIZE)
    >>> coefficients.evaluate(constants, 60.0, 60.0, 25.0, isothermal)
    >>> settle(constants, isothermal, 60.0, 25.0, rings, drift)
    >>> rings.round(2).tolist()
    [63.34, 63.34]
    >>> round(1e6 * float(drift[0, coefficients.CLEARANCE]), 2)  # of the clearance, um
    -1.15

    """
    rings[:] = math.nan
    if constants[0].physical != 0.0:
        rings[:] = coefficients.inner_temperature(constants, outer, outer, hz, math.inf)
    drift[0] = _difference(constants, isothermal, outer, rings[0], hz)
    drift[1] = 0.0


def carry(
    constants: Records,
    isothermal: FloatArray,
    outer: float,
    hz: float,
    rings: FloatArray,
    drift: FloatArray,
    tick: int,
) -> None:
    """
    Recompute ``drift`` after a change of the constants, from the same ring temperatures.

    ``isothermal`` as in :func:`settle`.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> constants = coefficients.constants_of(preset('incipient', thermal_mode='physical'))
    >>> rings, drift = np.empty(2), np.empty((2, coefficients.INPUTS))
    >>> isothermal = np.empty(coefficients.CONDITION_SIZE)
    >>> coefficients.evaluate(constants, 60.0, 60.0, 25.0, isothermal)
    >>> settle(constants, isothermal, 60.0, 25.0, rings, drift)
    >>> heavy = coefficients.constants_of(
    ...     preset('incipient', thermal_mode='physical', load=1000.0)
    ... )
    >>> coefficients.evaluate(heavy, 60.0, 60.0, 25.0, isothermal)
    >>> carry(heavy, isothermal, 60.0, 25.0, rings, drift, 2560)
    >>> rings.round(2).tolist()  # the ring goes on from where it was
    [63.34, 63.34]

    """
    drift[0] = _difference(constants, isothermal, outer, rings[0], hz)
    drift[1] = (_difference(constants, isothermal, outer, rings[1], hz) - drift[0]) / tick


def advance(
    constants: Records,
    isothermal: FloatArray,
    outer: float,
    hz: float,
    rings: FloatArray,
    drift: FloatArray,
    tick: int,
    seconds: float,
) -> None:
    """
    Advance the inner ring by one tick of ``seconds`` towards its thermal equilibrium.

    ``isothermal`` as in :func:`settle`.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> constants = coefficients.constants_of(preset('incipient', thermal_mode='physical'))
    >>> rings, drift = np.empty(2), np.empty((2, coefficients.INPUTS))
    >>> isothermal = np.empty(coefficients.CONDITION_SIZE)
    >>> coefficients.evaluate(constants, 60.0, 60.0, 25.0, isothermal)
    >>> settle(constants, isothermal, 60.0, 25.0, rings, drift)
    >>> coefficients.evaluate(constants, 80.0, 80.0, 25.0, isothermal)
    >>> advance(constants, isothermal, 80.0, 25.0, rings, drift, 2560, 0.1)
    >>> rings.round(2).tolist()  # the outer ring is at 80 degC now, and the inner one follows
    [63.34, 63.61]

    """
    rings[0] = rings[1]
    rings[1] = coefficients.inner_temperature(constants, outer, rings[0], hz, seconds)
    drift[0] += drift[1] * tick
    drift[1] = (_difference(constants, isothermal, outer, rings[1], hz) - drift[0]) / tick


@compiled()
def _difference(
    constants: Records, isothermal: FloatArray, outer: float, inner: float, hz: float
) -> FloatArray:
    """Return the change of the inputs due to the temperature ``inner`` of the inner ring."""
    apart = np.empty(coefficients.CONDITION_SIZE)
    coefficients.evaluate(constants, outer, inner, hz, apart)
    return apart[: coefficients.INPUTS] - isothermal[: coefficients.INPUTS]


_advance = compiled()(advance)


@compiled()
def tick_one(
    constants: Records,
    values: FloatArray,
    was: tuple[float, float],
    now: tuple[float, float],
    rings: FloatArray,
    drift: FloatArray,
    tick: int,
    seconds: float,
) -> None:
    """
    Advance one bearing in the physical mode by a tick, at ``now``.

    ``was`` and ``now`` are outer ring temperature, degC, and shaft speed, Hz. ``values`` belong to
    ``was`` and are reused if the inputs have not changed.
    """
    isothermal = values
    if now != was:
        isothermal = np.empty(coefficients.CONDITION_SIZE)
        coefficients.evaluate(constants, now[0], now[0], now[1], isothermal)
    _advance(constants, isothermal, now[0], now[1], rings, drift, tick, seconds)


@compiled()
def tick_all(
    constants: Records,
    values: FloatArray,
    was: tuple[FloatArray, FloatArray],
    now: tuple[FloatArray, FloatArray],
    rings: FloatArray,
    drift: FloatArray,
    tick: int,
    seconds: float,
) -> None:
    """Apply `tick_one` to every bearing in the physical mode; first array axis: bearings."""
    for i in range(now[0].shape[0]):
        if constants[i].physical != 0.0:
            tick_one(
                constants[i : i + 1], values[i], (was[0][i], was[1][i]), (now[0][i], now[1][i]),
                rings[i], drift[i], tick, seconds,
            )  # fmt: skip
