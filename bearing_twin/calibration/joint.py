# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Compare several records of one machine: recognise ringing, and give one width of all."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from bearing_twin.calibration.answer.estimates import spacing_shortfall
from bearing_twin.calibration.answer.impacts import follows_speed, ringing
from bearing_twin.calibration.answer.refusals import Kind
from bearing_twin.calibration.answer.result import Estimate, in_words, UNBOUNDED_REASONS
from bearing_twin.calibration.candidates.posterior import weighted_quantile, WIDTH
from bearing_twin.errors import BearingTwinError
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.calibration.answer.impacts import Impacts
    from bearing_twin.calibration.answer.result import Calibration
    from bearing_twin.calibration.candidates.cloud import Situation


def corrected_by_speeds(found: Calibration, others: Iterable[Impacts]) -> Calibration:
    """
    Return a calibration, corrected by the impacts of records at other speeds.

    If the time between the impacts is the same at another speed, they are ringing, not a passage.
    If their distance on the race is the same, they are a passage, even if the record alone is
    doubtful. The width is then their distance plus `spacing_shortfall`.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.calibration import fit
    >>> noise = 0.01 * np.random.default_rng(1).standard_normal(25600)
    >>> healthy = fit(noise, 12800.0, find_bearing('6205'), 25.0, unit='m/s^2', place='none')
    >>> corrected_by_speeds(healthy, []) is healthy
    True

    """
    width, seen = found.quantities[WIDTH], found.impacts
    if seen is None or found.refusal in (Kind.NO_IMPACTS, Kind.TOO_WIDE, Kind.ALIKE):
        return found
    others = tuple(others)
    if width.identifiable:
        refusal = ringing(seen, others)
        if refusal is None:
            return found
        # The peak is ringing, so that the other edge may be anywhere.
        high = found.situation.ball_spacing_mm
        limited = replace(width, q05=0.0, q95=high, identifiable=False, why=refusal.why)
        return _with(found, limited, refusal.kind)
    alike = follows_speed(seen, others)
    if not alike:
        return found
    return _with(found, passage_width(found.situation, (seen, *alike)), None)


def _with(found: Calibration, width: Estimate, refusal: Kind | None) -> Calibration:
    return replace(
        found,
        quantities=found.quantities | {WIDTH: width},
        statement=in_words(found.defect, width, refusal),
        refusal=refusal,
    )


def passage_width(here: Situation, seen: Sequence[Impacts]) -> Estimate:
    """
    Return the width of a passage that several records show, in closed form.

    ``here`` is the situation of the first record, and ``seen`` has the impacts of each.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> from bearing_twin.calibration.candidates.cloud import Situation
    >>> from bearing_twin.calibration.answer.impacts import Impacts
    >>> machine = Situation(
    ...     bearing=find_bearing('6205'), place='outer', shaft_hz=20.0, sample_rate=25600.0
    ... )
    >>> seen = [Impacts('outer', hz, 0.04 / hz, 1e-4) for hz in (20.0, 30.0)]
    >>> round(passage_width(machine, seen).median, 2)
    2.8

    """
    # Shaft turns to mm on the race: the contact speed is proportional to the shaft speed.
    turns = np.array([each.turn for each in seen])
    lobes = np.array([each.lobe_s * each.shaft_hz for each in seen])
    scale = 1e3 * here.speed / here.shaft_hz
    low, high = (f'{end(each.shaft_hz for each in seen[1:]):.1f}' for end in (min, max))
    speeds = low if low == high else f'{low} to {high}'
    most, middle = (1e3 * spacing_shortfall(here, share) for share in (0.95, 0.5))
    return Estimate(
        # As for one record: the impacts are at the edges themselves, less the half width of one.
        q05=max(0.0, scale * float((turns - lobes).min())),
        median=scale * float(np.median(turns)) + middle,
        q95=scale * float(turns.max()) + most,
        unit='mm',
        identifiable=True,
        why=f'the impacts are {scale * seen[0].turn:.2f} mm apart on the race, and as far at '
        f'{speeds} Hz: a passage; the rest is the path of a ball over the edges',
    )


def common_width(found: list[Calibration]) -> tuple[list[Calibration], Estimate, str]:
    """
    Compare calibrations of one machine; return them, their common width and a statement.

    The width is an equal mixture of the records that tell it. More records do not narrow its
    interval, because all share the same model error.

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
    >>> common_width([healthy, healthy])[2]
    'no defect above 0.1 mm'

    """
    places = sorted({each.defect for each in found})
    bearings = {each.situation.bearing for each in found}
    if len(places) != 1 or len(bearings) != 1:
        names = ', '.join(sorted(bearing.name for bearing in bearings))
        raise BearingTwinError(
            f'the {len(found)} records are not of one defect (bearing {names}; part '
            f'{", ".join(places)}): say which part with --place, or fit them one by one'
        )
    seen = [each.impacts for each in found if each.impacts is not None]
    alone = [each.quantities[WIDTH].identifiable for each in found]
    found = [corrected_by_speeds(each, seen) for each in found]
    if places == ['none']:
        # A healthy record does not clear another one that may have a defect.
        clearest = min(found, key=lambda each: (each.refusal is None, each.quantities[WIDTH].q95))
        return found, clearest.quantities[WIDTH], clearest.statement
    width = _mixture(found, alone)
    if all(each.refusal is Kind.NO_IMPACTS for each in found):
        return found, width, found[0].statement
    unlimited = [each.refusal for each in found if each.refusal in UNBOUNDED_REASONS]
    return found, width, in_words(places[0], width, *unlimited[:1])


def _mixture(found: list[Calibration], alone: list[bool]) -> Estimate:
    """Return the common width of records of one defect; ``alone``: which tell it alone."""
    widths = [each.quantities[WIDTH] for each in found]
    telling = [width for width in widths if width.identifiable]
    # Records that tell a width alone are more exact than the closed form over several.
    of = [each for each, width, own in zip(found, widths, alone, strict=True)
          if own and width.identifiable]  # fmt: skip
    of = of or (found if not telling else [])
    # The interval covers those of the records, which allow for the model error.
    said = [each.quantities[WIDTH] for each in of] or telling
    low, high = min(width.q05 for width in said), max(width.q95 for width in said)
    if of:
        values = np.concatenate([each.candidates[WIDTH] for each in of])
        weights = np.concatenate([each.weights / len(of) for each in of])
        median = float(weighted_quantile(values, weights, (0.5,))[0])
    else:
        median = float(np.median([width.median for width in said]))
    why = f'{len(telling)} of {len(found)} records tell it'
    if not telling:
        low, why = 0.0, found[0].quantities[WIDTH].why
    return Estimate(
        q05=low, median=median, q95=high, unit='mm', identifiable=bool(telling), why=why
    )
