# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A healthy record: the widest defect that may be there unseen."""

from dataclasses import replace
import math

from bearing_twin.calibration import fit
from bearing_twin.calibration.answer.healthy import (
    comb,
    LOSS_DB,
    smallest_detectable_width,
    would_show,
)
from bearing_twin.calibration.candidates import cloud
from bearing_twin.calibration.candidates.cloud import unknowns, vibrations
from cases import in_proofs
from impact_trains import BEARING, RATE
import numpy as np
import pytest

NOISE = np.random.default_rng(0).standard_normal(51200)


def test_volts_are_no_known_acceleration():
    noise = np.random.default_rng(1).standard_normal(25600)
    for unit, known in (('V', False), ('g', True)):
        found = fit(noise, 12800.0, BEARING, 25.0, unit=unit, place='none', candidates=64)
        width = found.quantities['defect_width_mm']
        assert ('the unit is not known' in width.why) is not known


@pytest.mark.parametrize(('rms', 'sure'), [(0.4, 70), (100.0, None), *in_proofs((0.05, 95))])
def test_a_limit_of_a_healthy_record_says_how_sure_it_is(rms, sure):
    """The louder the record, the less; at last no defect of any width is sure to show."""
    noise = np.random.default_rng(1).standard_normal(51200)
    found = fit(rms * noise, RATE, BEARING, 25.0, unit='m/s^2', place='none')
    width = found.quantities['defect_width_mm']
    if sure is None:
        assert found.statement == 'a defect of any width may not show'
        assert width.q95 == pytest.approx(math.pi * (39.04 + 7.94) / 9, rel=1e-3)
        assert '0 % show. Measure closer' in width.why
        return
    said = f'no defect above {width.q95:.2g} mm'
    said += '' if sure == 95 else f', with a confidence of {sure} %'
    assert found.statement == said and f'{sure} % show' in width.why
    assert width.q95 < 3.0


@pytest.mark.parametrize('rms', [0.1, *in_proofs(0.5)])
def test_wider_defects_than_the_limit_of_a_healthy_record_show(rms):
    """On 80 machines whose loads, depths and losses are drawn anew, as many as it says."""
    machine = cloud.example('none')
    limit = smallest_detectable_width(rms * NOISE[:25600], machine, 1.0, 0.0, seed=1)
    outer = replace(machine, place='outer')
    rng = np.random.default_rng(7)
    drawn = {name: about.place(rng.random(80)) for name, about in unknowns(outer).items()}
    drawn['defect_width_mm'] = rng.uniform(limit.width_mm, 3.9, 80)
    losses = 10.0 ** (-LOSS_DB * rng.random(80) / 20.0)
    defects = np.concatenate(list(vibrations(outer, drawn, 2.0, 3)))
    later = rms * NOISE[25600:51200]
    seen = [
        would_show(later, loss * x, machine.sample_rate, outer.impact_rate, outer.shaft_hz)
        for loss, x in zip(losses, defects, strict=True)
    ]
    assert np.mean(seen) > limit.confidence - 2.0 * math.sqrt(0.05 / 80)


def test_orders_of_the_shaft_near_a_part_do_not_hide_its_defects():
    """Order 7 lies within 3 % of twice what the outer race of a 6205 strikes."""
    machine = cloud.example('none')
    order = 2.0 * np.pi * 7.0 * machine.shaft_hz * np.arange(25600) / machine.sample_rate
    x = 0.1 * NOISE[:25600]
    swelling = (1.0 + 0.2 * np.cos(order)) * x
    quiet, swells = (
        smallest_detectable_width(y, machine, 1.0, 0.0, seed=1) for y in (x, swelling)
    )
    assert swells.confidence == quiet.confidence
    assert swells.width_mm < 1.5 * quiet.width_mm


def test_lines_where_a_part_strikes_are_not_taken_for_what_a_defect_would_show():
    """A defect then has to be as clear as a suspect, or to be louder than all of the record."""
    machine = cloud.example('none')
    strikes = replace(machine, place='outer').impact_rate
    swelling = np.cos(2.0 * np.pi * strikes * np.arange(25600) / machine.sample_rate)
    widths = [smallest_detectable_width(0.1 * NOISE[:25600], machine, 1.0, 0.0, seed=1).width_mm]
    for depth, suspect in ((0.1, False), (0.5, True)):
        x = 0.1 * (1.0 + depth * swelling) * NOISE[:25600]
        own = comb(x, machine.sample_rate, strikes)
        assert own.over_floor > own.chance and own.suspect is suspect
        widths.append(smallest_detectable_width(x, machine, 1.0, 0.0, seed=1).width_mm)
    assert widths[0] < widths[1] < 0.5 * widths[2]
