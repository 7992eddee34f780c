# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A simulator with new parameters that continues from the phases of another one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bearing_twin.dynamics.single.simulator import Simulator

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters
    from bearing_twin.dynamics.single.simulator import Block


SETTLE_S = 0.1
"""Time that the successor runs before, s, until the vibration of its own start has decayed."""
_PHASES = ('shaft', 'cage', 'spin')


def successor(simulator: Simulator, parameters: TwinParameters) -> tuple[Simulator, Block]:
    """
    Return a settled simulator with the phases of another one, and its block before that sample.

    `Simulator.reconfigure` applies new parameters to the present motion, as for an injected fault.
    Here the motion is that of the new parameters from the first sample on, for a cross-fade from
    one signal to the other.

    ``simulator`` gives phases, sample index, seed, temperature and speed, and is not changed.
    ``parameters`` must have the same bearing.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> old = Simulator(preset('incipient'))
    >>> _ = old.advance(1024, 20.0, 25.4)
    >>> new, before = successor(old, preset('incipient', load=900.0))
    >>> new.next_sample, len(before.y), new.parameters.load
    (1024, 2560, 900.0)
    >>> new.condition().shaft_angle == old.condition().shaft_angle
    True

    """
    rate = simulator.sample_rate
    temperature, shaft_hz = simulator.temperature, simulator.shaft_hz
    new = Simulator(
        parameters,
        sample_rate=rate,
        seed=simulator.seed,
        temperature=temperature,
        shaft_hz=shaft_hz,
    )
    new.start = simulator.start
    physical = {parameters.thermal_mode, simulator.parameters.thermal_mode} == {'physical'}
    rings = simulator.rings if physical else None
    n = int(SETTLE_S * rate)
    now, state = new.condition(), new.state.copy()
    for name, hz in zip(_PHASES, (shaft_hz, now.ftf, now.bsf), strict=True):
        state[name] = simulator.state[name] - n / rate * hz
    new.continue_from(state, simulator.next_sample, rings)
    before = new.advance(n, temperature, shaft_hz)
    state = new.state.copy()
    for name in _PHASES:
        state[name] = simulator.state[name]
    new.continue_from(state, simulator.next_sample, rings)
    return new, before
