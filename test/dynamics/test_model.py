# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The laws that the kernels share, against their closed forms."""

import math

from bearing_twin.dynamics.equations import model
from bearing_twin.dynamics.parameters import PROFILES
from bearing_twin.numerics.compiled import compiled
from bearing_twin.numerics.vector import load, store
import numpy as np
import pytest

HALF, DEPTH, CURVATURE = 0.4e-3, 12e-6, 100.0
ALONG = np.linspace(-0.5e-3, 0.5e-3, 64)
EDGE = np.maximum(HALF - np.abs(ALONG), 0.0)
PATHS = {
    'ball': np.minimum(EDGE**2 * CURVATURE, DEPTH),
    'rect': np.where(EDGE > 0.0, DEPTH, 0.0),
    'halfsine': DEPTH * np.sin(0.5 * math.pi * EDGE / HALF),
    'smooth': DEPTH * np.sin(0.5 * math.pi * np.minimum(2.0 * EDGE / HALF, 1.0)) ** 2,
}


@compiled()
def path_of_lanes(profile, along, sunk, slope):
    """Fill rows of sixteen; each lane has the profile given for it."""
    for row in range(4):
        a, kind = load(along, row), load(profile, 0)
        depth, steep = model.defect_path(
            kind, 0.0 * a + HALF, 0.0 * a + DEPTH, 0.0 * a + CURVATURE, a
        )
        store(sunk, row, depth)
        store(slope, row, steep)


def test_every_profile_has_a_code_of_its_own_and_no_other_code_is_one():
    assert tuple(model.PROFILES) == tuple(PATHS) == PROFILES
    assert [profile.code for profile in model.PROFILES.values()] == list(range(len(PROFILES)))
    unknown = float(len(PROFILES))
    ball, other = (
        model.defect_path(code, HALF, DEPTH, CURVATURE, 0.3e-3) for code in (model.BALL, unknown)
    )
    assert other == ball, 'an unknown code takes the branch of another profile'


@pytest.mark.parametrize('profile', PROFILES)
def test_path_through_a_defect_is_the_stated_one(profile):
    code = model.PROFILES[profile].code
    step = 1e-9
    for along, expected in zip(ALONG, PATHS[profile], strict=True):
        sunk, slope = model.defect_path(code, HALF, DEPTH, CURVATURE, along)
        if abs(along) < HALF:
            alone = model.PROFILES[profile].path(HALF, DEPTH, CURVATURE, abs(along))
            assert alone == pytest.approx((sunk, abs(slope)), rel=1e-12)
        assert sunk == pytest.approx(expected, rel=1e-9, abs=1e-18)
        sides = [
            model.defect_path(code, HALF, DEPTH, CURVATURE, along + d)[0] for d in (-step, step)
        ]
        assert slope == pytest.approx((sides[1] - sides[0]) / (2.0 * step), abs=1e-4)


@pytest.mark.parametrize('profiles', [*((p,) for p in PROFILES), PROFILES])
def test_path_of_lanes_is_that_of_numbers(profiles):
    codes = np.resize([model.PROFILES[p].code for p in profiles], 16).astype(np.float32)
    along = ALONG.astype(np.float32)
    sunk, slope = np.empty(64, np.float32), np.empty(64, np.float32)
    path_of_lanes(codes, along, sunk, slope)
    expected = [
        model.defect_path(float(code), HALF, DEPTH, CURVATURE, float(a))
        for code, a in zip(np.resize(codes, 64), along, strict=True)
    ]
    np.testing.assert_allclose(sunk, [e[0] for e in expected], atol=2e-6 * DEPTH)
    np.testing.assert_allclose(slope, [e[1] for e in expected], atol=1e-6)


def test_contact_law_is_that_of_hertz_and_its_derivative():
    for delta in (1e-9, 1e-6, 40e-6):
        force, slope = model.contact_law(delta, model.Contact(1.2e10, 0.0))
        assert force == pytest.approx(1.2e10 * delta**1.5, rel=1e-12)
        assert slope == pytest.approx(1.5 * force / delta, rel=1e-12)


@pytest.mark.parametrize('profile', PROFILES)
def test_a_kink_is_where_the_slope_or_its_own_slope_jumps(profile):
    code, _, kink_of = model.PROFILES[profile]
    kink = kink_of(HALF, DEPTH, CURVATURE)
    inside = np.linspace(0.0, 0.99 * HALF, 2001)[1:]
    slopes = [model.defect_path(code, HALF, DEPTH, CURVATURE, a)[1] for a in inside]
    # Where the path is smooth, each difference of slopes differs from the next one by less.
    jumps = np.abs(np.diff(slopes, 2))
    if kink < 0.0:
        assert jumps.max() < 1e-6
    else:
        assert jumps.max() > 1e-5
        assert inside[1 + jumps.argmax()] == pytest.approx(kink, abs=inside[1])
