# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The demo and the benchmarks stay out of domains in which somebody is."""

import pytest


@pytest.mark.ros
def test_an_inhabited_domain_is_seen_and_passed_over(probe, ros_domain):
    from bearing_twin.ros.processes.domain import inhabitants, own_domain

    assert '/probe' in inhabitants(ros_domain, listen=60.0)
    with own_domain(ros_domain - 1) as other:
        assert other != ros_domain


@pytest.mark.ros
def test_two_callers_at_once_have_a_domain_each():
    from bearing_twin.ros.processes.domain import own_domain

    with own_domain(7, listen=0.0) as first, own_domain(first - 1, listen=0.0) as second:
        assert first != second
