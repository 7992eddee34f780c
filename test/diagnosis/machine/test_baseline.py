# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What is known of a machine before its levels have settled."""

from bearing_twin.diagnosis.machine.baseline import Memory
from bearing_twin.diagnosis.machine.dependence import Condition
import numpy as np
import pytest


@pytest.mark.parametrize(('share', 'worn', 'least', 'most'),
                         [(0.25, 0.0, 0.0, 0.02), (0.25, 15.0, 0.9, 1.0)])  # fmt: skip
def test_a_quarter_of_disturbed_levels_is_no_rise_before_there_is_a_baseline(
    share, worn, least, most
):
    """Levels 15 dB higher by chance; a machine that is 15 dB louder from the 30th on."""
    rng, now, alarms = np.random.default_rng(0), Condition.at(60.0, 25.0), 0
    for _ in range(200):
        memory, risen = Memory(), False
        disturbed = 15.0 * (rng.random(59) < share)
        for number in range(59):
            level = max(float(disturbed[number]), worn * (number >= 30))
            memory.learn(number, [level, 0.0, 0.0], now, 60, 6.0)
            risen |= memory.over([level, 0.0, 0.0], now)[0] >= 12.0
        alarms += risen
    assert least <= alarms / 200 <= most


@pytest.mark.parametrize(
    ('cycle', 'kelvin', 'settled'),
    [(10.0, 0.05, True), (10.0, 0.5, False), (1.0, 0.05, False), (3600.0, 0.05, True)],
)
def test_a_temperature_that_creeps_is_waited_for_half_an_hour(cycle, kelvin, settled):
    """Levels of a machine that warms up by some kelvin from one to the next, at a steady level."""
    rng, memory = np.random.default_rng(0), Memory()
    for number in range(300):
        now = Condition.at(60.0 + kelvin * number, 25.0)
        memory.learn(cycle * number, [0.3 * rng.standard_normal(), 0.0, 0.0], now, 60, 6.0)
    assert (memory.base is not None) == settled
