# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One window of vibration: everything that is computed before it is judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_orders, PLACES
from bearing_twin.diagnosis.comb import HARMONICS, order_spectra, OrderSpectra
from bearing_twin.diagnosis.impulsive_outliers import limit_impulsive_outliers
from bearing_twin.diagnosis.severity import measure_severity
from bearing_twin.diagnosis.shaft import refine_shaft_hz, ShaftSpeed
from bearing_twin.diagnosis.spectra import band_tree, envelope_spectra, line_cap, whiten
import numpy as np
from scipy import fft

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing
    from bearing_twin.diagnosis.result import Severity
    from bearing_twin.diagnosis.settings import DiagnosisSettings
    from bearing_twin.diagnosis.spectra import EnvelopeSpectra
    from numpy.typing import NDArray

__all__ = ['Window', 'analyse_window', 'highest_fault_order']

_TREE_DEPTH = 3


@dataclass(frozen=True)
class Window:
    """Analysis of one window, before any decision."""

    orders: OrderSpectra
    speed: ShaftSpeed
    bands: list[tuple[float, float]]
    envelopes: EnvelopeSpectra
    amplitude: NDArray[np.float32]
    """One-sided amplitude spectrum in the signal's unit, bin k at k bin_hz."""
    bin_hz: float
    severity: Severity
    revolutions: float


def highest_fault_order(bearing: Bearing) -> float:
    """
    Order of the highest fault family.

    >>> from bearing_twin.bearing import find_bearing
    >>> round(highest_fault_order(find_bearing('6205')), 3)
    5.415

    """
    orders = fault_orders(bearing)
    return max(orders.impacts(name) for name in PLACES)


def highest_order(bearing: Bearing) -> float:
    """Highest order that the chain looks at: four harmonics of the highest family, with slip."""
    return 1.1 * HARMONICS * highest_fault_order(bearing)


def analyse_window(
    x: NDArray[np.float64],
    sample_rate: float,
    bearing: Bearing,
    shaft_hz: float,
    settings: DiagnosisSettings,
    *,
    unit: str = '',
) -> Window:
    """
    Everything that is computed before windows are averaged and judged.

    The window must have passed :func:`check_record`.

    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.diagnosis.settings import DiagnosisSettings
    >>> noise = np.random.default_rng(0).standard_normal(51200)
    >>> window = analyse_window(noise, 25600.0, find_bearing('6307'), 25.0, DiagnosisSettings())
    >>> window.revolutions, round(window.severity.rms, 1)
    (50.0, 1.0)

    """
    x = x - x.mean()
    bin_hz = sample_rate / len(x)
    spectrum = fft.rfft(x.astype(np.float32) / np.float32(len(x)))
    severity = measure_severity(
        x,
        spectrum,
        sample_rate,
        unit=unit or settings.unit,
        power_group=settings.power_group,
        mounting=settings.mounting,
    )
    scale = np.float32(1.0) / np.float32(severity.rms)
    limited = limit_impulsive_outliers(x, sample_rate, fault_orders(bearing).ftf * shaft_hz)
    if limited is x:
        scaled = spectrum * scale
    else:
        scaled = fft.rfft(limited.astype(np.float32) * (scale / np.float32(len(x))))
    width = max(int(8.0 * shaft_hz / bin_hz), 64)
    tree = band_tree(
        len(scaled) - 1,
        bin_hz,
        depth=_TREE_DEPTH,
        narrowest_hz=highest_order(bearing) * shaft_hz,
    )
    envelopes = envelope_spectra(
        whiten(scaled, width, cap=line_cap(len(x) / sample_rate * shaft_hz)),
        tree,
        max_hz=highest_order(bearing) * shaft_hz,
        floor_width=max(int(4.0 * shaft_hz / bin_hz), 32),
    )
    power = scaled.real**2 + scaled.imag**2
    speed = refine_shaft_hz(power, bin_hz, envelopes, shaft_hz, settings.speed_tolerance)
    return Window(
        order_spectra(envelopes, [band[0] for band in tree.bands], speed.shaft_hz, shaft_hz),
        speed,
        tree.bands,
        envelopes,
        2.0 * np.abs(spectrum),
        bin_hz,
        severity,
        len(x) / sample_rate * speed.shaft_hz,
    )
