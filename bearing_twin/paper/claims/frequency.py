# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Claims about the fault frequencies: formulas, and spectral lines of each defect."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import fault_frequencies, find_bearing
from bearing_twin.paper import equations, settings
from bearing_twin.paper.claims.claim import Claim, within
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.paper.study import FrequencyPoint, Study


LOWEST = 5.0
"""Lowest frequency at which envelope lines are searched, Hz."""
BIN = 1.0 / settings.DURATION
"""Resolution of a spectrum of the paper's 0.7 s record, Hz."""
COLD = 20.0


def frequency_claims(study: Study) -> list[Claim]:
    """Judge section 2 on frequencies."""
    return [*_formula_claims(), *_place_claims(study)]


def _formula_claims() -> list[Claim]:
    bearing, shaft = settings.BEARING, settings.SHAFT_HZ
    f_in = equations.inner_frequency(bearing, shaft)
    f_out = equations.outer_frequency(bearing, shaft)
    needed = {f'{f:g} Hz': shaft * f / f_in for f in settings.F_IN.values()}
    literal = 0.5 * shaft * bearing.n_balls * (1.0 + settings.BORE / settings.OUTSIDE)
    quoted = settings.F_IN['fig4']
    real = find_bearing('6307-catalogue')
    real_f = equations.inner_frequency(real, shaft)
    return [
        Claim(
            id='f-in-formula',
            where='section 2, equation 9, figure 4',
            claim='f_r = 25.4 r/s, N_b = 8, d = 14 mm, D = 57.5 mm give f_in = 126.463 Hz',
            paper_value=quoted,
            our_value=f_in,
            verdict=within(quoted, f_in, BIN),
            why=(
                f'Rule: within one bin of the 0.7 s record, {BIN:.2f} Hz, as every frequency that '
                f'the paper reads off a spectrum. Equation 9 gives {f_in:.3f} Hz; the '
                'printed decimals mean nothing. The quoted frequencies need f_r = '
                + ', '.join(f'{f:.3f} ({name})' for name, f in needed.items())
                + f' r/s. f_in + f_out = {f_in + f_out:.3f} Hz = N_b f_r as it must be.'
            ),
        ),
        Claim(
            id='f-in-quoted-twice',
            where='section 2, figure 4; section 3.4, figure 30',
            claim='f_in of the model without temperature',
            paper_value=list(settings.F_IN_PRINTED_AT_20),
            our_value=settings.F_IN_PRINTED_AT_20[1] - settings.F_IN_PRINTED_AT_20[0],
            verdict=within(*settings.F_IN_PRINTED_AT_20, BIN),
            why=(
                f'Rule: within one bin, {BIN:.2f} Hz, as every frequency read off a spectrum. The '
                'printed digits differ by 10 % of the shift attributed to temperature.'
            ),
        ),
        Claim(
            id='symbols-d-and-D',
            where='equation 1; equations 9 to 12',
            claim="'d is the diameter of the inner ring, D the diameter of the outer ring'",
            paper_value=quoted,
            our_value={'as printed': literal, 'ball and pitch': f_in},
            as_printed={
                'd, D = bore and outside diameter, 35 and 80 mm': abs(literal - quoted) < BIN
            },
            as_read={'d, D = ball and pitch diameter, 14 and 57.5 mm': abs(f_in - quoted) < BIN},
            why=(
                f'Rule: f_in within one bin ({BIN:.2f} Hz) of the quoted value. Reading taken: d '
                'is the ball, D the pitch diameter, in equation 1 too.'
            ),
        ),
        Claim(
            id='geometry-6307',
            where='section 2',
            claim='d = 14 mm and D = 57.5 mm describe a 6307',
            paper_value={'d_mm': 14.0, 'D_mm': 57.5},
            our_value={'d_mm': real.d_ball * 1e3, 'D_mm': real.d_pitch * 1e3, 'f_in_hz': real_f},
            verdict=within(f_in, real_f, BIN),
            why=(
                'Rule: the geometry commonly published for a 6307, itself inferred, has the same '
                f'f_in within one bin. It gives {real_f:.3f} Hz. 57.5 mm is the mean of bore and '
                'outside diameter, (35 + 80)/2.'
            ),
        ),
    ]


def _place_claims(study: Study) -> list[Claim]:
    bearing, shaft = settings.BEARING, settings.SHAFT_HZ
    bpfo, bpfi, bsf, ftf = fault_frequencies(bearing, shaft)
    formula = {
        'f_in': equations.inner_frequency(bearing, shaft),
        'f_out': equations.outer_frequency(bearing, shaft),
        'f_b': equations.ball_frequency(bearing, shaft),
        'f_c': equations.cage_frequency(bearing, shaft),
    }
    kinematic = {'f_in': bpfi, 'f_out': bpfo, 'f_b': bsf, 'f_c': ftf}
    own = {'inner': 'f_in', 'outer': 'f_out', 'ball': 'f_b', 'cage': 'f_c'}
    strongest = {
        place: max(formula, key=lambda name: contrasts[name])
        for place, contrasts in study.faults.items()
    }
    ball = study.faults['ball']
    point = study.frequencies['incipient', 'none', COLD]
    tallest, height = _tallest(point)
    return [
        Claim(
            id='frequency-formulas',
            where='equations 9 to 12',
            claim='the four fault frequencies of a bearing with a fixed outer ring',
            paper_value=None,
            our_value=formula,
            as_printed={name: math.isclose(formula[name], kinematic[name]) for name in formula},
            why=(
                'Rule: equal to the kinematics that the simulator uses. Equation 11 needs the '
                'parenthesis 1 - (d cos(alpha)/D)^2. The paper evaluates only f_in.'
            ),
        ),
        Claim(
            id='frequencies-locate-the-fault',
            where='section 2',
            claim='the fault frequencies tell where in the bearing the fault is',
            paper_value=own,
            our_value=strongest,
            as_printed={place: strongest[place] == own[place] for place in own},
            why=(
                'Rule: with a defect in each place, the line of that place is the strongest of '
                'the four in the envelope spectrum (height over its median). A damaged ball is '
                'strongest at f_c, at which it passes the load.'
            ),
        ),
        Claim(
            id='f-b-is-the-ball-fault',
            where='equation 11',
            claim="f_b is the 'rolling element rotation failure frequency'",
            paper_value=formula['f_b'],
            our_value={'f_b': ball['f_b'], '2 f_b': ball['2 f_b']},
            as_printed={'f_b is the spin of a ball': math.isclose(formula['f_b'], bsf)},
            why=(
                'Rule: equal to the rotation of a ball in the kinematics. A ball fault shows at '
                f'2 f_b = {2 * formula["f_b"]:.2f} Hz, because a defect meets a race twice a turn '
                '(heights over the median of the envelope spectrum given).'
            ),
        ),
        Claim(
            id='envelope-shows-f-in',
            where='section 2 (5), figure 4',
            claim='Hilbert envelope demodulation of the inner-ring fault shows f_in',
            paper_value=settings.F_IN['fig4'],
            our_value={
                'line_hz': point.line,
                'height_over_median': point.contrast,
                'tallest_line_hz': tallest,
            },
            as_printed={
                'line within one bin': abs(point.line - settings.F_IN['fig4']) < BIN,
                'ten times the median': point.contrast > 10.0,
            },
            why=(
                f'Rule: line within one bin of 0.7 s ({BIN:.2f} Hz) and 10 times the median. The '
                f'tallest line of the envelope spectrum from {LOWEST:g} to 500 Hz is '
                f'{_line_name(tallest)} at {tallest:.2f} Hz, {height:.2f} times as high as f_in.'
            ),
        ),
    ]


def _tallest(point: FrequencyPoint) -> tuple[float, float]:
    """Frequency of the tallest line of the envelope, Hz, and its height over that at f_in."""
    frequency, values = point.envelope
    here = frequency >= LOWEST
    frequency, values = frequency[here], values[here]
    own = values[np.abs(frequency - point.prescribed) <= 1.5 * (frequency[1] - frequency[0])]
    top = int(values.argmax())
    return float(frequency[top]), float(values[top] / own.max())


def _line_name(line: float) -> str:
    """Name of the nearest of the shaft harmonics, f_in, its harmonics and its sidebands."""
    shaft = settings.SHAFT_HZ
    f_in = equations.inner_frequency(settings.BEARING, shaft)
    names = {}
    for order in range(4):
        base = f'{order} f_in' if order > 1 else 'f_in' * order
        for side in range(-5, 6):
            turns = f'{abs(side)} f_r' if abs(side) > 1 else 'f_r'
            sign = '-' if side < 0 else '+'
            text = base if side == 0 else f'{base} {sign} {turns}' if order else turns
            names[text] = order * f_in + side * shaft
    return min((name for name in names if name), key=lambda name: abs(names[name] - line))
