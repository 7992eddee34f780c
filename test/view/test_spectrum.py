# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What every picture of a spectrum shows: combs at the fault frequencies, peaks kept."""

import math

from bearing_twin.bearing import fault_frequencies
from bearing_twin.bearing.catalogue import find_bearing
from bearing_twin.view.spectrum import combs, ENVELOPE, highest, SpectrumPicture
from drawn import message
import numpy as np
import pytest

SHAFT = 25.4


def spectrum(slip=0.0, **fields):
    """Return an envelope spectrum of 0.125 to 800 Hz with one strong line at 126 Hz."""
    values = np.full(6400, 1e-4)
    values[1007] = 0.25
    expected = fault_frequencies(find_bearing('6307'), SHAFT, slip)
    given = {
        'kind': ENVELOPE,
        'unit': '1',
        'start_hz': 0.125,
        'bin_hz': 0.125,
        'band_low': 1600.0,
        'band_high': 4800.0,
        'shaft_hz': SHAFT,
        'values': values,
        'floor': np.full(6400, 1e-4),
    }
    return message('Spectrum', **(given | expected._asdict() | fields)), expected


@pytest.mark.parametrize('slip', [0.0, 0.01])
def test_nominal_combs_stand_at_the_fault_frequencies(slip):
    made, expected = spectrum(slip)
    found = {comb.family: comb for comb in combs(made)}
    assert not any(comb.found for comb in found.values())
    order = np.arange(1, 5)
    strike = 2.0 * expected.bsf
    for family, hertz in (('inner', expected.bpfi), ('outer', expected.bpfo), ('ball', strike)):
        assert found[family].harmonics() == pytest.approx(hertz * order)
    assert found['cage'].harmonics() == pytest.approx(expected.ftf * order)
    assert found['shaft'].harmonics(top=260.0) == pytest.approx(SHAFT * np.arange(1, 11))
    assert found['outer'].sidebands().size == 0
    assert sorted(found['inner'].sidebands()) == pytest.approx(
        sorted(k * expected.bpfi + side for k in order for side in (-SHAFT, SHAFT))
    )
    assert sorted(found['ball'].sidebands()) == pytest.approx(
        sorted(k * strike + side for k in order for side in (-expected.ftf, expected.ftf))
    )


def test_a_bearing_without_speed_has_no_combs():
    assert combs(message('Spectrum', bpfo=0.0, ftf=0.0)) == []


def test_the_comb_found_is_that_of_the_same_window():
    made, _ = spectrum()
    verdict = message('Diagnosis', fault_hz=126.0, faults=['inner'])
    found = SpectrumPicture.of(made, verdict).found
    assert (found.family, found.fundamental) == ('inner', 126.0)
    assert found.label == 'BPFI found 126.00 Hz'
    verdict.first_sample = 1024
    assert SpectrumPicture.of(made, verdict).found is None


def test_a_line_is_as_high_as_its_modulation_index():
    # 1 + m cos has, relative to the power of its mean, lines of (m / 2)^2.
    picture = SpectrumPicture.of(spectrum()[0])
    assert picture.values[1007] == pytest.approx(1.0)
    assert picture.floor[0] == pytest.approx(0.02)
    # Noise of mean power f passes -ln(p) f with probability p.
    assert picture.threshold[0] == pytest.approx(0.02 * math.sqrt(math.log(1000.0)))
    assert '1.6 to 4.8 kHz' in picture.title


def test_parts_keep_their_frequencies():
    verdict = message('Diagnosis', fault_hz=126.0, faults=['inner'])
    picture = SpectrumPicture.of(spectrum()[0], verdict)
    near = picture.zoom()
    assert near.frequencies[near.values.argmax()] == 126.0
    assert near.start >= 120.0
    assert near.end <= 132.0
    deciding = picture.deciding()
    assert deciding.frequencies[deciding.values.argmax()] == 126.0
    assert deciding.end >= 4.0 * 126.3


def test_an_empty_spectrum_has_no_picture():
    assert SpectrumPicture.of(spectrum(values=[])[0]) is None
    assert SpectrumPicture.of(spectrum(bin_hz=0.0)[0]) is None


def test_pooling_keeps_every_peak_at_its_place():
    values = np.random.default_rng(1).random(51201)
    values[12345] = 9.0
    indices, group = highest(values, 300)
    assert len(indices) <= 300
    assert indices[values[indices].argmax()] == 12345
    assert len(indices) * group >= 51201
