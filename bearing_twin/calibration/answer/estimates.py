# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Estimates of a fit: interval of each quantity, whether it is identifiable, and why."""

from __future__ import annotations

from dataclasses import replace
import math
from typing import TYPE_CHECKING

from bearing_twin.calibration.answer.healthy import (
    CONFIDENCES,
    LOUDER_DB,
    SLIPPED,
    smallest_detectable_width,
    SPEED_ERROR,
)
from bearing_twin.calibration.answer.refusals import Kind, Refusal
from bearing_twin.calibration.answer.result import Estimate
from bearing_twin.calibration.candidates.cloud import MOST_SLIP, unknowns
from bearing_twin.calibration.candidates.passage import interference, path_curvature
from bearing_twin.calibration.measured.path import noise_floor
from bearing_twin.diagnosis.signal.acceleration import acceleration_factor
from bearing_twin.dynamics.parameters import widest
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.calibration.candidates.cloud import Situation
    from bearing_twin.calibration.candidates.posterior import Posterior
    from bearing_twin.calibration.measured.path import Resonance
    from bearing_twin.calibration.measured.summaries import Summary
    from bearing_twin.dynamics.equations.sensor_path import SensorPath


FloatArray = npt.NDArray[np.float64]

UNBOUNDED = (Kind.NO_IMPACTS, Kind.ONE_IMPACT, Kind.TOO_WIDE)
"""Refusals that leave the width of a race defect without a bound."""


def of_path(
    x: FloatArray, path: SensorPath, modes: list[Resonance], situation: Situation, unit: str
) -> dict[str, Estimate]:
    """
    Return the quantities of the sensor's path.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example('none')
    >>> from bearing_twin.dynamics.equations.sensor_path import SensorPath
    >>> path = SensorPath(sample_rate=12800.0, numerator=(2.0,), denominator=(1.0,), noise=0.0)
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> floor = of_path(noise, path, [], machine, 'g')['noise_floor']
    >>> floor.unit, floor.identifiable, round(floor.median, 3)
    ('g/sqrt(Hz)', True, 0.012)

    """
    rate = situation.sample_rate
    low, middle, high = noise_floor(x, rate)
    unit = unit or 'unit of the samples'
    quantities = {
        'gain': Estimate(
            q05=0.1 * path.gain, median=path.gain, q95=10.0 * path.gain,
            unit=f'{unit} per m/s^2', identifiable=False,
            why='only its product with the strength of the impacts is seen; a factor of 10 is '
            'assumed',
        ),
        'noise_floor': Estimate(
            q05=low, median=middle, q95=high, unit=f'{unit}/sqrt(Hz)',
            identifiable=True, why='from the quietest bands of the spectrum in eight parts',
        ),
    }  # fmt: skip
    for number, mode in enumerate(modes, start=1):
        why = (
            f'{100.0 * mode.share:.0f} % of the power rings there; whether path or rotor, or two '
            'that are close, the record does not tell'
        )
        for name, value, most, of in (
            (f'resonance_{number}_hz', mode.hz, rate / 2.0, 'Hz'),
            (f'resonance_{number}_damping', mode.damping, 1.0, ''),
        ):
            quantities[name] = Estimate(
                q05=0.0, median=value, q95=most, unit=of, identifiable=False, why=why
            )
    return quantities


def of_defect(
    left: Posterior, situation: Situation, measured: Summary, refusal: Refusal | None
) -> dict[str, Estimate]:
    """
    Return the quantities of a bearing with a race defect.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> from bearing_twin.calibration.candidates.posterior import without_spacing
    >>> from bearing_twin.calibration.measured.summaries import summarise
    >>> noise = np.random.default_rng(1).standard_normal(25600)
    >>> measured = summarise(noise, 12800.0, machine.longest_spacing)
    >>> left = without_spacing(measured, machine, candidates=32)
    >>> hidden = Refusal(Kind.HIDDEN, 'ringing hides it')
    >>> width = of_defect(left, machine, measured, hidden)['defect_width_mm']
    >>> width.identifiable, width.q05, width.why[-16:]
    (False, 0.0, 'ringing hides it')

    """
    quantities = of_candidates(left, 'its intervals held the true value too rarely in simulation')
    width = quantities['defect_width_mm']
    quantities['defect_width_mm'] = _width(width, situation, measured, refusal)
    return quantities


def of_candidates(left: Posterior, why: str) -> dict[str, Estimate]:
    """
    Return each quantity as the kept candidates have it, not identifiable because of ``why``.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> from bearing_twin.calibration.candidates.posterior import from_prior
    >>> load = of_candidates(from_prior(example('none'), 0), 'it is assumed')['load']
    >>> load.identifiable, load.unit
    (False, 'N')

    """
    quantities = {}
    for name, about in left.prior.items():
        low, median, high = (float(v) for v in left.quantiles(name))
        quantities[name] = Estimate(
            q05=low, median=median, q95=high, unit=about.unit, identifiable=False, why=why
        )
    return quantities


def _width(
    width: Estimate, situation: Situation, measured: Summary, refusal: Refusal | None
) -> Estimate:
    """Return the width of a race defect, from that of the kept candidates, with all allowances."""
    if refusal is None:
        # The model of the path over an edge may be wrong. The lower bound is therefore at most the
        # distance of the impacts themselves, less the half width of one.
        spacing, lobe = (1e3 * t * situation.speed for t in (measured.spacing, measured.lobe))
        # The upper bound is at least the width at the median of assumed loads and depths:
        # candidates in which the rotor rebounds after the exit have narrower defects.
        high = max(width.q95, spacing + 1e3 * spacing_shortfall(situation, 0.5))
        why = (
            f'from impacts {spacing:.2f} mm apart on the race and the path of a ball over the '
            'edges, which the lower bound leaves out; it holds if they are one passage, which '
            'records at another speed prove'
        )
        low = min(width.q05, spacing - lobe)
        return replace(width, q05=low, q95=high, identifiable=True, why=why)
    if refusal.kind in UNBOUNDED:
        # A defect wider than the distance of two balls always has a ball in it.
        return replace(width, q05=0.0, q95=situation.ball_spacing_mm, why=refusal.why)
    if refusal.kind is Kind.MANY_WIDTHS:
        return replace(width, why=refusal.why)
    # The spacing of any narrower defect is hidden too, whatever the prior assumes.
    longest = max(measured.longest_unresolved_spacing, refusal.longest_spacing)
    hidden = longest * situation.speed + _largest_shortfall(situation)
    high = min(max(width.q95, 1e3 * hidden), situation.ball_spacing_mm)
    return replace(width, q05=0.0, q95=high, why=f'at most {high:.2f} mm: {refusal.why}')


def of_slip(situation: Situation, measured: float) -> Estimate:
    """
    Return the estimate of the cage slip; ``measured``: by the diagnosis, NaN if it is not.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> of_slip(example(), math.nan).q95
    0.03

    """
    low, high = 0.0, SLIPPED
    if math.isnan(measured):
        why = 'no line of a fault measures it, so the twin has no slip'
    elif not 0.0 <= measured <= MOST_SLIP:
        why = (
            f'the line of the part gives {100.0 * measured:.2g} %, not 0 to '
            f'{100.0 * MOST_SLIP:g} %, so the twin has no slip'
        )
    else:
        low, high = situation.slip - SPEED_ERROR, situation.slip + SPEED_ERROR
        why = (
            'from the line of the part, which an error of the shaft speed moves too: '
            f'{100.0 * SPEED_ERROR:g} % of it are assumed'
        )
    return Estimate(q05=low, median=situation.slip, q95=high, unit='', identifiable=False, why=why)


def spacing_shortfall(situation: Situation, share: float) -> float:
    """
    Return by how much the impacts are closer than the slot is wide, m: a quantile of the prior.

    A ``share`` of the assumed loads and depths gives at most this value. The closed form is used
    because few of the candidates are shallow slots under a high load.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example()
    >>> [round(1e3 * spacing_shortfall(machine, share), 1) for share in (0.5, 0.95)]
    [0.4, 0.7]

    """
    shares = (np.arange(64) + 0.5) / 64.0
    prior = unknowns(situation)
    sinking = np.minimum.outer(
        interference(situation.bearing, 1.0) * prior['load'].place(shares) ** (2.0 / 3.0),
        1e-6 * prior['defect_depth_um'].place(shares),
    )
    curvature = path_curvature(situation.bearing, situation.place)
    return 2.0 * math.sqrt(float(np.quantile(sinking, share)) / curvature)


def _largest_shortfall(situation: Situation) -> float:
    """Return by how much the impacts are closer than the slot is wide, m, at most, at any load."""
    prior = unknowns(situation)
    sinking = min(
        interference(situation.bearing, prior['load'].high), 1e-6 * prior['defect_depth_um'].high
    )
    return 2.0 * math.sqrt(sinking / path_curvature(situation.bearing, situation.place))


def without_defect(
    x: FloatArray,
    situation: Situation,
    scale: float,
    unit: str,
    seed: int,
    refusal: Refusal | None = None,
) -> tuple[Estimate, str]:
    """
    Return the width of a defect that the record would have shown, and a statement of it.

    ``scale`` is m/s^2 per unit of the samples; with an unknown unit it brings the record to the
    level of the twin. ``refusal`` tells why the bearing may have a defect though none is fitted.

    Examples
    --------
    >>> from bearing_twin.calibration.candidates.cloud import example
    >>> machine = example('ball')
    >>> ball = Refusal(Kind.NOT_FITTED, 'the width of a ball defect is not fitted')
    >>> without_defect(np.zeros(25600), machine, 1.0, 'm/s^2', seed=0, refusal=ball)[1]
    'ball defect, at most 4.0 mm wide'

    """
    highest = 1e3 * widest(situation.bearing)
    if refusal is not None:
        width = Estimate(
            q05=0.0, median=0.5 * highest, q95=highest, unit='mm', identifiable=False,
            why=refusal.why,
        )  # fmt: skip
        if refusal.kind is Kind.NO_PART:
            return width, f'no width: {refusal.why}'
        return width, f'{situation.place} defect, at most {highest:.1f} mm wide'
    known = math.isfinite(acceleration_factor(unit))
    largest, confidence = smallest_detectable_width(
        x, situation, scale, 0.0 if known else LOUDER_DB, seed
    )
    statement = f'no defect above {largest:.2g} mm'
    if confidence < CONFIDENCES[0]:
        statement += f', with a confidence of {100.0 * confidence:.0f} %'
    why = (
        f'{statement}: of wider ones on each race, added to this record, '
        f'{100.0 * confidence:.0f} % show'
    )
    if not math.isfinite(largest):
        largest = replace(situation, place='outer').ball_spacing_mm
        statement = 'a defect of any width may not show'
        why = (
            f'{statement}: of those of {1e3 * widest(situation.bearing):.2g} mm, added to this '
            f'record, {100.0 * confidence:.0f} % show. Measure closer to the bearing, or longer, '
            'or give the load'
        )
    if not known:
        why += '; the unit is not known: give it. A machine up to 20 dB louder than the twin is '
        why += 'assumed'
    width = Estimate(q05=0.0, median=0.0, q95=largest, unit='mm', identifiable=False, why=why)
    return width, statement
