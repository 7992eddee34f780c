# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A quantity is declared once, beside its field, and checked by that declaration."""

from dataclasses import dataclass
import math

from bearing_twin.cli.diagnose.text import _table
from bearing_twin.diagnosis.machine.dependence import Law, Slope
from bearing_twin.errors import BearingTwinError
from bearing_twin.quantity import check_fields, quantities, quantity
import pytest


@dataclass(frozen=True, kw_only=True)
class Sensor:
    mass: float = quantity(..., 'Mass.', 'kg', 0.1, 5.0)
    resonance: float = quantity(6e3, 'Resonance.', 'Hz', 500.0, 11e3, special=(0.0, 'none'))
    axis: str = quantity('y', 'Axis.', choices=('', 'x', 'y'))
    rating: float | None = quantity(None, 'Rating.', 'N', 1.0, 9.0, special=(None, 'unknown'))
    note: str = ''

    def __post_init__(self):
        check_fields(self, 'sensor ')


@pytest.mark.parametrize(
    ('given', 'said'),
    [
        ({'mass': 0.0}, 'sensor mass=0.0 is outside 0.1..5 kg; choose a value inside'),
        ({'mass': math.nan}, 'sensor mass=nan is outside 0.1..5 kg; choose a value inside'),
        ({'mass': math.inf}, 'sensor mass=inf is outside 0.1..5 kg; choose a value inside'),
        (
            {'resonance': 100.0},
            'sensor resonance=100.0 is outside 500..11000 Hz; choose a value inside (0: none)',
        ),
        ({'axis': 'z'}, "sensor axis='z' is not one of '', x, y; choose one of these"),
        ({'axis': 'x' * 4097}, 'sensor axis: 4097 characters are too many; give 4096 at most'),
        ({'rating': 0.0}, 'sensor rating=0.0 is outside 1..9 N; choose a value inside'),
    ],
)
def test_a_value_outside_is_refused_in_one_sentence(given, said):
    with pytest.raises(BearingTwinError) as refusal:
        Sensor(**{'mass': 1.0, **given})
    assert str(refusal.value) == said


def test_limits_and_special_values_are_taken():
    for given in ({'mass': 0.1}, {'mass': 5.0}, {'resonance': 0.0}, {'axis': ''}, {'rating': 9.0}):
        made = Sensor(**{'mass': 1.0, **given})
        assert given.items() <= vars(made).items()
    with pytest.raises(TypeError, match='mass'):
        Sensor()


def test_the_declaration_can_be_read():
    assert list(quantities(Sensor)) == ['mass', 'resonance', 'axis', 'rating']
    default, about = quantities(Sensor)['resonance']
    assert (default, about.unit, about.low, about.high) == (6e3, 'Hz', 500.0, 11e3)


def test_a_difference_that_rounds_to_zero_has_no_minus():
    law = Law(Slope(mean=-1e-4, deviation=0.001, low=30.0, high=60.0, known=True))
    assert str(law).startswith('+0.000 +- 0.00')
    evidence = {
        'expected_hz': {'bpfo': 90.0, 'bpfi': 135.0, 'bsf': 60.0, 'ftf': 10.0},
        'found_hz': {'outer': 90.0 - 1e-3},
        'score': {'outer': 9.0},
        'modulation_index': {'outer': 1.0},
    }
    rows = _table({'evidence': evidence, 'shaft_hz': 25.0, 'faults': [], 'level': 'ok'})
    assert [row.split()[6] for row in rows if row.startswith('outer')] == ['+0.00%']
