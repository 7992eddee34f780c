# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The smallest fault that a window would have shown: told of a twin, never of a sensor."""

from bearing_twin.bearing import find_bearing
from bearing_twin.diagnosis import diagnose_record, DiagnosisSettings
from bearing_twin.diagnosis.chain import Excerpt
from bearing_twin.diagnosis.detection_power import smallest_detectable
import numpy as np

RATE = 25_600.0
SHAFT_HZ = 25.4


SEED = 8


def _of_twin(x, shaft_hz):
    """Diagnosis of samples that a twin makes."""
    known = RATE, find_bearing('6307'), DiagnosisSettings()
    excerpt = Excerpt.of(x, shaft_hz, *known, unit='m/s^2', sensor='acc y simulated')
    return excerpt.analyse().alone


def test_too_short_a_window_says_what_it_could_have_shown(rng):
    x = rng.standard_normal(int(1.2 * RATE))
    said = _of_twin(x, SHAFT_HZ)
    assert said.result == 'insufficient'
    assert f'{said.smallest_detectable:.2g} mm wide' in said.reasons[-1]


def test_window_of_too_few_turns_says_what_is_missing(rng):
    x = rng.standard_normal(2560)
    said = _of_twin(x, 25.0)
    assert said.result == 'insufficient'
    assert np.isnan(said.smallest_detectable)
    # 20 turns for any statement, 50 for a healthy one.
    assert '0.7 s more' in said.reasons[0]


def test_no_size_is_claimed_for_a_real_sensor(rng):
    """Real faults of 0.18 to 0.53 mm were missed where the twin would have shown 0.12 mm."""
    x = rng.standard_normal(int(1.2 * RATE))
    said = diagnose_record(x, RATE, find_bearing('6307'), SHAFT_HZ, unit='m/s^2')
    assert np.isnan(said.smallest_detectable)
    assert not any('smallest' in reason for reason in said.reasons)


def test_no_size_is_claimed_where_none_was_simulated():
    at = {'temperature': 20.0, 'rms': 1.0, 'unit': 'm/s^2', 'd_ball': 0.0135}
    assert smallest_detectable(4.0, 25.0, **at) > 0.0
    # Turns count, not only seconds; and slow shafts were not simulated.
    assert np.isnan(smallest_detectable(1.0, 12.5, **at))
    assert np.isnan(smallest_detectable(2.0, 7.0, **at))
    assert np.isnan(smallest_detectable(60.0, 3.0, **at))
