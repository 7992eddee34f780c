# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Temperature tables of GCr15 bearing steel, 20 to 110 degC, and the paper's factor beta0.

Zhang, C.; Liu, T.; Wang, Y.; He, H.; Zhang, C. Symmetry 2023, 15, 2166.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from bearing_twin.errors import BearingTwinError
from bearing_twin.given import real_number
from bearing_twin.quantity import check_fields, quantity
import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


def _column(*values: float) -> FloatArray:
    column = np.array(values)
    column.setflags(write=False)
    return column


TEMPERATURES = _column(20, 30, 40, 50, 60, 70, 80, 90, 100, 110)
"""Nodes of the three tables, degC."""
TABLE_LOW, TABLE_HIGH = float(TEMPERATURES[0]), float(TEMPERATURES[-1])
EXPANSION_TABLE = _column(5, 6, 7, 9, 9.5, 10, 12, 13, 15, 16)
"""Table 1, instantaneous thermal expansion coefficient in its printed unit (see `alpha`)."""
HARDNESS_TABLE = _column(67.1, 65.2, 63.6, 63.6, 63.7, 63.8, 63.2, 63.0, 62.8, 62.4)
"""Table 2, hardness, HRC. It is not monotonic: it rises from 63.6 to 63.8 over 50 to 70 degC."""
FRICTION_TABLE = _column(
    0.0150, 0.0155, 0.0157, 0.0203, 0.0205, 0.0263, 0.0812, 0.0942, 0.0986, 0.1030
)
"""Table 3, average friction coefficient, dimensionless."""

BETA0_LOW, BETA0_HIGH = 0.5, 1.5
"""Limits of beta0 over the tables. Outside, stiffness and spall depth leave the range in which the
model was examined: contact is lost, or the force is not monotonic."""


def check_temperature(temperature: float) -> float:
    """
    Return ``temperature`` if it is finite and inside the tables.

    Raises
    ------
    BearingTwinError
        Otherwise. Nothing is extrapolated, since table 3 jumps threefold within 10 K.

    Examples
    --------
    >>> check_temperature(60.0)
    60.0

    """
    temperature = real_number('temperature', temperature)
    if not TABLE_LOW <= temperature <= TABLE_HIGH:
        msg = (
            f'temperature {temperature} degC is outside {TABLE_LOW:g}..{TABLE_HIGH:g} degC, the '
            'range of tables 1 to 3; clamp or hold it before it reaches the model'
        )
        raise BearingTwinError(msg)
    return temperature


def alpha(temperature: float, unit: float = 1e-5) -> float:
    """
    Instantaneous linear thermal expansion coefficient, 1/K, by linear interpolation.

    Parameters
    ----------
    temperature
        degC, 20 to 110.
    unit
        Unit of table 1, 1/K. The paper prints '10^5 K^-1'. ``1e-5`` restores the lost minus sign
        and keeps the paper's numbers; ``1e-6`` is the magnitude of real steel (12e-6/K).

    Examples
    --------
    >>> alpha(20.0)
    5e-05

    """
    return float(np.interp(check_temperature(temperature), TEMPERATURES, EXPANSION_TABLE)) * unit


def hardness(temperature: float) -> float:
    """
    Rockwell hardness, HRC, at 20 to 110 degC, by linear interpolation of table 2.

    Examples
    --------
    >>> hardness(110.0)
    62.4

    """
    return float(np.interp(check_temperature(temperature), TEMPERATURES, HARDNESS_TABLE))


def friction(temperature: float) -> float:
    """
    Average friction coefficient at 20 to 110 degC, by linear interpolation of table 3.

    Examples
    --------
    >>> friction(110.0)
    0.103

    """
    return float(np.interp(check_temperature(temperature), TEMPERATURES, FRICTION_TABLE))


def beta0(
    rise: float, alpha: float, hardness: float, friction: float, weights: tuple[float, ...]
) -> float:
    """
    Return the paper's factor on stiffness and defect depth; arguments are not checked.

    Parameters
    ----------
    rise
        T - T0, K.
    alpha, hardness, friction
        Values at T: 1/K, HRC, dimensionless.
    weights
        Weight of expansion (0 or 1), weights delta_h and delta_mu of hardness and friction,
        reference values H0 (HRC) and mu0.

    Examples
    --------
    >>> beta0(90.0, alpha(110.0), hardness(110.0), friction(110.0), (1.0, 0.0, 0.0, 63.6, 0.015))
    1.0144

    """
    expansion, delta_h, delta_mu, h0, mu0 = weights
    change = delta_h * (hardness - h0) / h0 + delta_mu * (friction - mu0) / mu0
    return 1.0 + expansion * alpha * rise + change


@dataclass(frozen=True, kw_only=True)
class Beta0:
    """
    The paper's factor on stiffness K_b and defect depth C_d; each term can be switched off.

    ``beta0 = 1 + alpha(T) (T - T0) + delta_h (H(T) - H0)/H0 + delta_mu (mu(T) - mu0)/mu0``

    The paper gives no weights of hardness and friction. With the other defaults ``delta_mu`` can
    be up to 0.08; above max(0.0025, 0.0126 delta_h) friction is the strongest of the three terms,
    as the paper claims. H0 is the paper's 63.6 HRC. The table has that value at 40 degC, so
    ``beta0(20) = 1 + 0.055 delta_h``.

    Notes
    -----
    Symmetry 2023, 15, 2166, section 3.4. The paper writes the hardness symbol in the friction
    term by mistake; here each term has its own weight. ``alpha(T) (T - T0)`` is taken literally,
    although the strain is the integral of alpha.

    Examples
    --------
    >>> round(Beta0().at(20.0), 4)
    1.0055

    """

    expansion: bool = quantity(
        True, 'Thermal mode paper: beta0 with the term of thermal expansion.'
    )
    hardness: bool = quantity(True, 'Thermal mode paper: beta0 with the term of hardness.')
    friction: bool = quantity(True, 'Thermal mode paper: beta0 with the term of friction.')
    alpha_unit: Literal[1e-5, 1e-6] = quantity(  # type: ignore[valid-type]
        1e-5,
        "Unit of table 1: 1e-5 (the paper's numbers) or 1e-6 (magnitude of real steel).",
        '1/K',
        1e-6,
        1e-5,
    )
    delta_h: float = quantity(
        0.10, 'Weight of hardness in beta0, which must stay in 0.5..1.5.', '', 0.0, 2.0
    )
    delta_mu: float = quantity(
        0.02, 'Weight of friction in beta0, which must stay in 0.5..1.5.', '', 0.0, 2.0
    )
    reference_temperature: float = quantity(
        20.0, 'Reference temperature T0 of beta0.', 'degC', TABLE_LOW, TABLE_HIGH
    )
    reference_hardness: float = quantity(
        63.6, 'Reference hardness H0 of beta0.', 'HRC', 1.0, 100.0
    )
    reference_friction: float = quantity(
        0.0150, 'Reference friction mu0 of beta0 and of the slip model mu_proportional.', '', 1e-4,
        10.0,
    )  # fmt: skip

    def __post_init__(self) -> None:
        if self.alpha_unit not in (1e-5, 1e-6):
            msg = f'alpha_unit={self.alpha_unit} 1/K; choose 1e-5 (as printed) or 1e-6 (steel)'
            raise BearingTwinError(msg)
        check_fields(self)
        # Between two nodes beta0 is quadratic. Its curvature, from the slope of alpha, is too
        # small to leave the limits when both nodes are inside.
        for temperature in TEMPERATURES:
            value = self.at(float(temperature))
            if not BETA0_LOW <= value <= BETA0_HIGH:
                msg = (
                    f'beta0={value:.3f} at {temperature:g} degC is outside '
                    f'{BETA0_LOW}..{BETA0_HIGH}: stiffness and spall depth would leave the '
                    f"model's validity; reduce delta_mu={self.delta_mu} (default 0.02) or "
                    f'delta_h={self.delta_h} (default 0.10), or change what they are relative to: '
                    f'reference_friction={self.reference_friction} (default 0.015), '
                    f'reference_hardness={self.reference_hardness} (default 63.6)'
                )
                raise BearingTwinError(msg)

    def at(self, temperature: float) -> float:
        """Return beta0 at ``temperature`` in degC, 20 to 110."""
        rise = temperature - self.reference_temperature
        return beta0(
            rise,
            alpha(temperature, self.alpha_unit),
            hardness(temperature),
            friction(temperature),
            self.weights,
        )

    @property
    def weights(self) -> tuple[float, float, float, float, float]:
        """Argument ``weights`` of :func:`beta0`; 0 for a term that is switched off."""
        return (
            float(self.expansion),
            self.delta_h if self.hardness else 0.0,
            self.delta_mu if self.friction else 0.0,
            self.reference_hardness,
            self.reference_friction,
        )
