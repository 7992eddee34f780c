# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One vocabulary: every word has a code, a title and a constant in the messages."""

from bearing_twin.bearing import FAULT_CODES, FaultFrequencies, LEVELS, PLACES, RESULTS, TITLES
from bearing_twin_msgs.msg import Diagnosis


def test_every_answer_has_a_code_and_a_title_of_its_own():
    assert tuple(FAULT_CODES) == tuple(TITLES) == RESULTS
    assert all(result.upper() in FAULT_CODES[result] for result in RESULTS if result != 'healthy')
    assert len(set(FAULT_CODES.values())) == len(set(TITLES.values())) == len(RESULTS)


def test_answers_and_levels_are_the_constants_of_the_message():
    assert [getattr(Diagnosis, word.upper()) for word in RESULTS] == list(range(len(RESULTS)))
    numbers = {getattr(Diagnosis, f'LEVEL_{word.upper()}') for word in LEVELS}
    assert numbers == set(range(len(LEVELS)))


def test_a_ball_strikes_twice_a_spin_and_every_place_has_a_frequency():
    frequencies = FaultFrequencies(bpfo=3.0, bpfi=5.0, bsf=2.0, ftf=0.4)
    assert [frequencies.impacts(place) for place in PLACES] == [5.0, 3.0, 4.0, 0.4]
