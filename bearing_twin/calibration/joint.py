# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Several records of one machine: impacts that do not follow the speed, and one width of all."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from bearing_twin.calibration.posterior import weighted_quantile
from bearing_twin.calibration.refusals import Kind, ringing
from bearing_twin.calibration.result import Estimate, in_words
from bearing_twin.errors import BearingTwinError
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from bearing_twin.calibration.result import Calibration

__all__ = ['compared', 'joined']

WIDTH = 'defect_width_mm'


def compared(found: Calibration, others: Iterable[tuple[str, float, float]]) -> Calibration:
    """
    Return a calibration without the width that other speeds contradict.

    Impacts that stay as far apart in time while the speed changes are ringing, not a passage.

    Parameters
    ----------
    found
        Of one record.
    others
        Place of the defect, shaft speed in Hz and time between the impacts in s of other records
        of the machine.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.calibration import fit
    >>> noise = 0.01 * np.random.default_rng(1).standard_normal(25600)
    >>> healthy = fit(noise, 12800.0, find_bearing('6205'), 25.0, unit='m/s^2', place='none')
    >>> compared(healthy, [('none', 50.0, 1e-3)]) is healthy
    True

    """
    width = found.quantities[WIDTH]
    if found.spacing_s is None or not width.identifiable:
        return found
    refusal = ringing(found.defect, found.situation.shaft_hz, found.spacing_s, others)
    if refusal is None:
        return found
    why = f'at most {width.q95:.2f} mm: {refusal.why}'
    limited = replace(width, q05=0.0, identifiable=False, why=why)
    return replace(
        found,
        quantities=found.quantities | {WIDTH: limited},
        statement=in_words(found.defect, limited),
        refusal=refusal.kind,
    )


def joined(found: list[Calibration]) -> tuple[list[Calibration], Estimate, str]:
    """
    Return calibrations of one machine, compared with each other, and its width with a statement.

    The width is what the records that tell it leave possible, each as likely as the other. Its
    interval is no narrower for their number: what the model gets wrong it gets wrong in all.

    Raises
    ------
    BearingTwinError
        If the records do not have a defect of the same part of the same bearing.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.calibration import fit
    >>> noise = 0.01 * np.random.default_rng(1).standard_normal(25600)
    >>> healthy = fit(noise, 12800.0, find_bearing('6205'), 25.0, unit='m/s^2', place='none')
    >>> joined([healthy, healthy])[2]
    'no defect above 0.2 mm'

    """
    places = sorted({each.defect for each in found})
    bearings = {each.situation.bearing for each in found}
    if len(places) != 1 or len(bearings) != 1:
        names = ', '.join(sorted(bearing.name for bearing in bearings))
        msg = (
            f'the {len(found)} records are not of one defect (bearing {names}; part '
            f'{", ".join(places)}): say which part with --place, or fit them one by one'
        )
        raise BearingTwinError(msg)
    seen = [
        (each.defect, each.situation.shaft_hz, each.spacing_s)
        for each in found
        if each.spacing_s is not None
    ]
    found = [compared(each, seen) for each in found]
    if places == ['none']:
        # A record that may be of a defect is not made healthy by another.
        clearest = min(found, key=lambda each: (each.refusal is None, each.quantities[WIDTH].q95))
        return found, clearest.quantities[WIDTH], clearest.statement
    telling = [each for each in found if each.quantities[WIDTH].identifiable]
    of = telling or found
    values = np.concatenate([each.candidates[WIDTH] for each in of])
    weights = np.concatenate([each.weights / len(of) for each in of])
    low, median, high = (float(v) for v in weighted_quantile(values, weights, (0.05, 0.5, 0.95)))
    # No higher than what each says of itself, which allows for what the model gets wrong.
    low = min(low, *(each.quantities[WIDTH].q05 for each in of))
    why = f'{len(telling)} of {len(found)} records tell it'
    if not telling:
        low, why = 0.0, found[0].quantities[WIDTH].why
        # What each says of itself may be wider than any candidate: so is what they say together.
        high = max(high, *(each.quantities[WIDTH].q95 for each in of))
    width = Estimate(
        q05=low, median=median, q95=high, unit='mm', identifiable=bool(telling), why=why
    )
    if all(each.refusal is Kind.NO_IMPACTS for each in found):
        return found, width, found[0].statement
    return found, width, in_words(places[0], width)
