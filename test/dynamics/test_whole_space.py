# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Properties over the whole space of valid parameters, inputs and sample rates."""

import math

from bearing_twin.bearing import Bearing, catalogue, PLACES
from bearing_twin.dynamics import Defect, Simulator, TwinParameters
from bearing_twin.dynamics.parameters import MAX_DEFECTS, PROFILES
from bearing_twin.errors import BearingTwinError
from bearing_twin.quantity import quantities
from bearing_twin.thermal.friction import SERIES
from bearing_twin.thermal.gcr15 import Beta0
from bearing_twin.thermal.lubricant import Lubricant
from bearing_twin.thermal.network import ThermalNetwork
from cases import in_proofs
from hypothesis import given, HealthCheck, reject, settings
from hypothesis import strategies as st
import numpy as np
import pytest

MODES = st.sampled_from(['paper', 'physical'])


def spread(low, high):
    """Floats over a range, by magnitude where it spans decades."""
    if low > 0.0 and high > 100.0 * low:
        powers = st.floats(math.log(low), math.log(high))
        return powers.map(lambda power: min(max(math.exp(power), low), high))
    return st.floats(low, high)


def ranged(owner):
    """Values of the fields of a dataclass that have a plain range."""
    return {
        name: spread(about.low, about.high)
        for name, (_, about) in quantities(owner).items()
        if about.low is not None and about.special is None
    }


@st.composite
def bearings(draw):
    """One of the catalogue, or any that holds together, up to 45 deg."""
    if draw(st.booleans()):
        return draw(st.sampled_from([b for b in catalogue().values() if b.element == 'ball']))
    pitch, ratio = draw(spread(5e-3, 1.0)), draw(st.floats(0.05, 0.5))
    most = min(math.ceil(math.pi / math.asin(ratio)) - 1, 100)
    return Bearing(
        name='drawn',
        n_balls=draw(st.integers(3, max(most, 3))),
        d_ball=ratio * pitch,
        d_pitch=pitch,
        contact_angle=draw(st.sampled_from([0.0, 0.3, math.pi / 4])),
    )


@st.composite
def defects(draw, bearing):
    """Up to the most allowed, anywhere, of any size and shape."""
    widest = min(10e-3, 0.5 * bearing.d_ball)
    return tuple(
        Defect(
            place=draw(st.sampled_from(PLACES)),
            width=draw(st.floats(0.05e-3, max(widest, 0.05e-3))),
            depth=draw(st.floats(0.0, 0.5e-3)),
            angle=draw(st.floats(-2.0 * math.pi, 2.0 * math.pi)),
            ball=draw(st.integers(0, bearing.n_balls - 1)),
            profile=draw(st.sampled_from(PROFILES)),
        )
        for _ in range(draw(st.integers(0, MAX_DEFECTS)))
    )


beta0s = st.fixed_dictionaries(
    {name: st.booleans() for name in ('expansion', 'hardness', 'friction')}
    | {
        'alpha_unit': st.sampled_from([1e-5, 1e-6]),
        'delta_h': st.floats(0.0, 2.0),
        'delta_mu': st.floats(0.0, 0.085),
        'reference_temperature': st.floats(20.0, 110.0),
        'reference_hardness': st.floats(50.0, 80.0),
        'reference_friction': st.floats(0.01, 0.11),
    }
)
oils = st.fixed_dictionaries(
    {
        'viscosity_40': spread(1e-5, 4.9e-3),
        'viscosity_100': spread(2.1e-6, 1e-4),
        'replenishment': st.floats(0.0, 1e-6),
        'boundary_friction': st.floats(0.0, 0.5),
        'film_friction': st.floats(0.0, 0.5),
        'contamination': st.floats(0.0, 1.0),
    }
)
networks = st.fixed_dictionaries(ranged(ThermalNetwork))
others = st.fixed_dictionaries(
    ranged(TwinParameters)
    | {
        'thermal_mode': MODES,
        'hertz_stiffness': st.none() | spread(1e8, 1e12),
        'slip_model': st.sampled_from(['none', 'constant', 'mu_proportional']),
        'resonance_hz': st.just(0.0) | st.floats(500.0, 11000.0),
        'friction_series': st.none() | st.sampled_from(list(SERIES)),
        'dynamic_rating': st.none() | spread(10.0, 1e8),
        'fatigue_limit': st.none() | spread(1.0, 1e7),
    }
)


def least_damping(p):
    """Smaller damping ratio of rotor and housing on their springs."""
    return min(
        0.5 * p.inner_damping / math.sqrt(p.inner_stiffness * p.inner_mass),
        0.5 * p.outer_damping / math.sqrt(p.outer_stiffness * p.outer_mass),
    )


def same_however_cut(data, rate, temperatures, speeds, shares, seed):
    bearing = data.draw(bearings())
    fields = data.draw(others)
    try:
        parameters = TwinParameters(
            bearing=bearing,
            defects=data.draw(defects(bearing)),
            beta0=Beta0(**data.draw(beta0s)),
            lubricant=Lubricant(**data.draw(oils)),
            network=ThermalNetwork(**data.draw(networks)),
            **fields,
        )
        options = {
            'sample_rate': rate, 'seed': seed, 'temperature': temperatures[0],
            'shaft_hz': speeds[0],
        }  # fmt: skip
        whole, cut = (Simulator(parameters, **options) for _ in range(2))
    except BearingTwinError:
        reject()
    # A commanded change first, so that a thermal drift is under way; then past a thermal tick.
    n = round(0.04 * rate)
    to = temperatures[1], speeds[1]
    first = whole.advance(round(0.08 * rate), *to)
    cut.advance(round(0.08 * rate), *to)
    expected = whole.advance(n, *to)
    parts = []
    cuts = sorted({min(max(round(share * n), 1), n - 1) for share in shares})
    for begin, end in zip([0, *cuts], [*cuts, n], strict=True):
        parts.append(cut.advance(end - begin, *to))
        state = cut.save()
        cut = Simulator(parameters, sample_rate=rate)
        cut.load(state)
    for axis in ('x', 'y'):
        got = np.concatenate([getattr(part, axis) for part in parts])
        assert np.array_equal(got, getattr(expected, axis))
    assert cut.save() == whole.save()
    loud = [np.abs([block.x, block.y]).max() for block in (first, expected)]
    assert np.isfinite(loud).all()
    later = whole.advance(2 * n, *to)
    if least_damping(parameters) > 0.01:
        # Nothing that loses energy gets louder without end. Without damping the balls that pass
        # can drive a rotor up, by parametric resonance; the adaptive solver finds the same.
        assert np.abs([later.x, later.y]).max() < 20.0 * max(loud) + 10.0 * parameters.noise + 1e4
    values = later.condition._asdict()
    assert len(values['warnings']) == len(values['limits_passed'])
    for value in (value for name, value in values.items() if name != 'warnings'):
        assert not np.isinf(value).any() or value is later.condition.life_hours


@pytest.mark.parametrize('examples', [25, *in_proofs(150)])
def test_finite_bounded_and_the_same_bits_however_it_is_cut(examples):
    drawn = given(
        data=st.data(),
        rate=st.sampled_from([2000.0, 12800.0, 25600.0, 51200.0, 204800.0]),
        temperatures=st.tuples(st.floats(20.0, 110.0), st.floats(20.0, 110.0)),
        speeds=st.tuples(st.floats(0.0, 500.0), st.floats(0.0, 500.0)),
        shares=st.lists(st.floats(0.0, 1.0), max_size=4),
        seed=st.integers(0, 2**32 - 1),
    )(same_however_cut)
    settings(
        max_examples=examples,
        deadline=None,
        derandomize=True,
        suppress_health_check=[
            HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large,
        ],
    )(drawn)()  # fmt: skip
