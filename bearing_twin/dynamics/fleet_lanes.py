# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The arrays of a fleet, and one bearing put into its lane of them or taken out."""

from __future__ import annotations

import math
from typing import Any, TYPE_CHECKING

from bearing_twin.dynamics import filters, laws, layout
from bearing_twin.dynamics import fleet_layout as fl
from bearing_twin.dynamics.fleet_kernel import room_size
from bearing_twin.dynamics.fleet_turning import first_slot
from bearing_twin.dynamics.vector import aligned, L
from bearing_twin.errors import BearingTwinError
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bearing_twin.dynamics.parameters import TwinParameters
    from bearing_twin.dynamics.simulator import Simulator

__all__ = ['Lanes', 'check_defects']

FloatArray = npt.NDArray[np.float64]
Array = npt.NDArray[Any]

_MOTION = slice(fl.SENSOR)
_SENSOR = slice(fl.SENSOR, fl.C)
_CARRIED = slice(fl.STATE_ROWS)
# Phases that are carried on, and their speeds.
_TURNED = np.array([0, 1, 2, fl.PHASE_ROWS, fl.PHASE_ROWS + 1, fl.PHASE_ROWS + 2])


class Lanes:
    """
    What the kernel works on: groups of `fleet_layout.L` bearings, a lane each.

    Idle lanes of the last group repeat the last bearing.

    Parameters
    ----------
    parameters : sequence of TwinParameters
        One set a bearing.
    sample_rate
        Output rate, Hz.

    """

    def __init__(self, parameters: Sequence[TwinParameters], sample_rate: float) -> None:
        self._sample_rate = sample_rate
        self.oversample = filters.oversampling(sample_rate)
        self.step = 1.0 / (sample_rate * self.oversample)
        groups = -(-len(parameters) // L)
        self.size = groups * L
        self.most_balls = max(p.bearing.n_balls for p in parameters)
        # The kernel looks at the directions of two slots beyond the last.
        slots = self.most_balls + 2
        self.w = aligned((groups, fl.WORK_ROWS, L), np.float32)
        self.balls = aligned((groups, slots, fl.BALL_ROWS, L), np.float32)
        self.phases = np.zeros((groups, fl.PHASE_ROWS + 3, L))
        self.keys = np.zeros((groups, L), np.uint64)
        self.level = np.zeros((groups, L), np.float32)
        self.law = np.zeros((self.size, laws.LAW_SIZE))
        self.values = np.zeros((self.size, laws.CONDITION_SIZE))
        self.drift = np.zeros((self.size, 2, laws.INPUTS))
        self.rings = np.full((self.size, 2), math.nan)
        self.balls_in = np.zeros(groups, np.int64)
        self.spalls_in = np.zeros(groups, np.int64)
        self.smooth_in = np.zeros(groups, np.bool_)
        # The decimator by the place of an internal sample within an output sample.
        taps = filters.decimator(self.oversample)
        self.delay = (len(taps) - 1) / 2.0 / self.oversample / sample_rate
        padded = np.concatenate([np.zeros(self.oversample - 1), taps])
        self.taps = padded.reshape(-1, self.oversample).T.ravel().astype(np.float32)
        memory = (len(padded) // self.oversample - 1) * 2 * L
        self.history = aligned((groups, self.oversample, memory), np.float32)
        self.room = aligned((room_size(self.oversample, memory),), np.float32)

    def survey(self, parameters: Sequence[TwinParameters]) -> None:
        """Find what the kernel has to do for each group."""
        for group in range(len(self.w)):
            members = parameters[group * L : (group + 1) * L]
            self.balls_in[group] = max(member.bearing.n_balls for member in members)
            self.spalls_in[group] = max(len(member.defects) for member in members)
            self.smooth_in[group] = any(
                d.profile in ('halfsine', 'smooth') for member in members for d in member.defects
            )

    def motion(self, index: int, next_sample: int) -> Array:
        """State of one bearing as `layout.STATE`, before its `kernel.start`."""
        group, lane = divmod(index, L)
        state = np.zeros(1, layout.STATE)
        moving = self.w[group, _MOTION, lane].astype(float).reshape(4, 4)
        for name, values in zip('qvaj', moving, strict=True):
            state[name] = values
        phases = self.phases[group, :, lane]
        since = next_sample % layout.CHUNK / self._sample_rate
        turns = (phases[:3] + since * phases[fl.PHASE_ROWS : fl.PHASE_ROWS + 3]) % 1.0
        state['cage'], state['shaft'], state['spin'] = turns
        for name, turned in (('cage', turns[0]), ('shaft', turns[1])):
            state[name + '_cos'] = np.cos(2.0 * math.pi * turned)
            state[name + '_sin'] = np.sin(2.0 * math.pi * turned)
        return state

    def seed(self, index: int) -> int:
        """Seed of one bearing."""
        return int(self.keys[divmod(index, L)])

    def quieten(self, index: int) -> None:
        """Let the filters of one bearing begin anew."""
        group, lane = divmod(index, L)
        self.w[group, _SENSOR, lane] = 0.0
        self.history[group].reshape(self.oversample, -1, L)[:, :, lane] = 0.0

    def place(self, index: int, simulator: Simulator) -> None:
        """Put one bearing into its lane; the filters' memory stays."""
        p = simulator.parameters
        snapshot = simulator.snapshot()
        group, lane = divmod(index, L)
        spalls = snapshot.defects
        w, m, state = self.w[group, :, lane], snapshot.machine[0], snapshot.state[0]
        w[_MOTION] = np.concatenate([state[name] for name in 'qvaj'])
        n = p.bearing.n_balls
        w[fl.CONSTANTS : fl.CONSTANTS + fl.CONSTANT_ROWS] = (
            m['inner_light'], m['inner_stiffness'], m['inner_damping'], m['outer_light'],
            m['outer_stiffness'], m['outer_damping'], m['contact_damping'], m['unbalance'],
            *_sensor_table(p, self.step), n, 1.0 / n,
        )  # fmt: skip
        self.balls[group, :, :, lane] = _slots(n, self.balls.shape[1])
        phases = self.phases[group, :, lane]
        since = simulator.next_sample % layout.CHUNK / simulator.sample_rate
        hz, slip = simulator.shaft_hz, snapshot.values[laws.SLIP]
        carried = hz * (1.0 - slip)
        speeds = m['ftf_order'] * carried, hz, m['spin_order'] * carried
        turns = np.array([state[name] for name in ('cage', 'shaft', 'spin')])
        phases[:3] = turns - since * np.array(speeds)
        phases[:3] -= np.floor(phases[:3])
        ahead = 2.0 * math.pi * (turns[0] + first_slot(phases[fl.CAGE], n) / n)
        w[fl.C], w[fl.S] = math.cos(ahead), math.sin(ahead)
        w[fl.CS], w[fl.SS] = state['shaft_cos'], state['shaft_sin']
        phases[fl.FTF_ORDER], phases[fl.SPIN_ORDER] = m['ftf_order'], m['spin_order']
        phases[fl.JITTER], self.level[group, lane] = m['jitter'], m['noise']
        self.keys[group, lane] = snapshot.seed
        for slot in range(fl.MAX_SPALLS):
            row = spalls[slot] if slot < len(spalls) else None
            _place_spall(w, phases, slot, row, m, n)
        self.law[index], self.values[index] = snapshot.law, snapshot.values
        self.drift[index], self.rings[index] = snapshot.drift, snapshot.rings

    def state(self) -> list[Array]:
        """Motion, phases (a copy), decimators and inner rings."""
        return [
            self.w[:, _CARRIED], self.phases[:, _TURNED], self.history, self.drift, self.rings
        ]  # fmt: skip

    def set_state(self, parts: Sequence[Array]) -> None:
        """Take over what :meth:`state` returned."""
        for mine, given in zip(self.state(), parts, strict=True):
            mine[...] = given
        self.phases[:, _TURNED] = parts[1]


def check_defects(index: int, parameters: TwinParameters) -> None:
    """Refuse more defects than a lane has slots for."""
    if len(parameters.defects) > fl.MAX_SPALLS:
        msg = (
            f'bearing {index} of the fleet has {len(parameters.defects)} defects, more than '
            f'{fl.MAX_SPALLS}; merge some, or use a Simulator for it'
        )
        raise BearingTwinError(msg)


def _sensor_table(p: TwinParameters, step: float) -> FloatArray:
    """Return the coefficients of both states at the end of a step, and of what is read then."""
    table = filters.resonator(p.resonance_hz, p.resonance_damping, step, 1)[:2]
    table[:, [3, 5]] *= step  # the kernel has the jerk itself
    read = (-1.0, -2.0 * p.resonance_damping, 0.0) if p.resonance_hz else (0.0, 0.0, 1.0)
    return np.concatenate([table.ravel(), read])


def _slots(n_balls: int, slots: int) -> FloatArray:
    """Directions and negative numbers of the slots of a lane, see `fleet_layout`."""
    numbers = np.array([(k + 1) // 2 if k % 2 else -(k // 2) for k in range(slots)])
    angles = 2.0 * math.pi * numbers / n_balls
    rows = np.stack([np.cos(angles), np.sin(angles), -numbers], axis=1)
    rows[n_balls:, :2] = 0.0
    return rows


def _place_spall(
    w: npt.NDArray[np.float32],
    phases: FloatArray,
    slot: int,
    row: Any,
    machine: Any,
    n_balls: int,
) -> None:
    """Fill one spall of a lane; None for a slot that is not used."""
    at = fl.SPALLS + slot * fl.SPALL_ROWS
    w[at : at + fl.SPALL_ROWS] = 0.0
    w[at + fl.BALL] = w[at + fl.ONLY] = w[at + fl.HALF] = -1.0
    angle = fl.FIRST_ANGLE + 4 * slot
    phases[angle : angle + 4] = 0.0
    if row is None:
        return
    place = row['place']
    on_ball = place == 2.0
    radius = machine['inner_radius'] if place == 0 else machine['outer_radius']
    w[at + fl.U_SCALE] = 2.0 if on_ball else n_balls
    w[at + fl.METRES] = (
        0.5 * math.pi * machine['d_ball'] if on_ball else 2.0 * math.pi * radius / n_balls
    )
    w[at + fl.RACE] = not on_ball
    w[at + fl.BALL] = row['ball'] if on_ball else -1.0
    inner, outer = row['inner_curvature'], row['outer_curvature']
    w[at + fl.ONLY] = row['ball'] if place == 3.0 else -1.0
    w[at + fl.EVEN] = outer if place in (1.0, 3.0) else inner
    w[at + fl.ODD] = outer if on_ball else w[at + fl.EVEN]
    w[at + fl.KIND] = row['profile']
    if row['profile'] == 1.0:  # a rectangle is a path of endless curvature
        w[at + fl.EVEN] = w[at + fl.ODD] = 1e30
    w[at + fl.HALF], w[at + fl.FULL] = row['half'], row['depth']
    # Cage, shaft and spin; an outer spall and a worn pocket follow the cage alone.
    follows = {0.0: (1.0, -1.0, 0.0), 2.0: (0.0, 0.0, 1.0)}.get(place, (1.0, 0.0, 0.0))
    phases[angle : angle + 4] = row['angle'], *follows
