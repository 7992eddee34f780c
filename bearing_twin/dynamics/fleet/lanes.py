# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Arrays of a fleet, and transfer of a bearing to and from its lane."""

from __future__ import annotations

from collections.abc import Sequence
import math
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import PLACES
from bearing_twin.dynamics.equations import coefficients, filters, layout
from bearing_twin.dynamics.fleet import layout as fl
from bearing_twin.dynamics.fleet.kinematics import first_slot
from bearing_twin.dynamics.single.condition import MOTION, put_inputs, SNAPSHOT_SIZE
from bearing_twin.dynamics.single.tables import equations_of
from bearing_twin.numerics.compiled import compiled
from bearing_twin.numerics.vector import aligned, L
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.equations.waviness import Surfaces
    from bearing_twin.dynamics.parameters import TwinParameters
    from bearing_twin.dynamics.single.kernel import Tables
    from bearing_twin.dynamics.single.objects import Equations
    from bearing_twin.dynamics.single.simulator import Simulator


FloatArray = npt.NDArray[np.float64]
Array = npt.NDArray[Any]

_PHASES = {'cage': 1.0, 'shaft': 1.0, 'spin': layout.SPIN_TURNS}
"""Period of each phase, turns."""


class Lanes:
    """
    Arrays of the kernel: groups of `vector.L` bearings, one lane per bearing.

    Idle lanes of the last group repeat the last bearing.

    Examples
    --------
    Three bearings fill three of sixteen lanes:

    >>> from bearing_twin.dynamics import preset
    >>> Lanes([preset('paper')] * 3, 25600.0).size
    16

    """

    def __init__(self, parameters: Sequence[TwinParameters], sample_rate: float) -> None:
        self._sample_rate = sample_rate
        self.oversample = filters.oversampling(sample_rate)
        self.step = 1.0 / (sample_rate * self.oversample)
        groups = -(-len(parameters) // L)
        self.size = groups * L
        self.most_balls = max(p.bearing.n_balls for p in parameters)
        # The kernel reads the directions of two slots beyond the last.
        slots = self.most_balls + 2
        self.groups = aligned((groups,), fl.GROUP)
        self.balls = aligned((groups, slots, fl.BALL_ROWS, L), np.float32)
        self.surfaces = np.zeros((self.size, 0), np.float32)
        self._tables: dict[int, Tables] = {}
        self._equations: dict[int, Equations] = {}
        self.constants = np.zeros(self.size, coefficients.CONSTANTS)
        self.values = np.zeros((self.size, coefficients.CONDITION_SIZE))
        self.drift = np.zeros((self.size, 2, coefficients.INPUTS))
        self.rings = np.full((self.size, 2), math.nan)
        self.fade = np.zeros((self.size, coefficients.INPUTS))
        self.faded = np.zeros(self.size, np.int64)
        self.marks = np.zeros((self.size, 2), np.int64)
        # Polyphase form of the decimator: one phase per internal sample of an output sample.
        taps = filters.decimator(self.oversample)
        padded = np.concatenate([np.zeros(self.oversample - 1), taps])
        self.taps = padded.reshape(-1, self.oversample).T.ravel().astype(np.float32)
        memory = (len(padded) // self.oversample - 1) * 2 * L
        self.history = aligned((groups, self.oversample, memory), np.float32)

    def room(self) -> Array:
        """Return the work array of one thread."""
        tile = layout.CHUNK * 2 * L
        return aligned((tile + self.oversample * (self.history.shape[2] + tile),), np.float32)

    def update_group_sizes(self, parameters: Sequence[TwinParameters]) -> None:
        """Set the most balls and spalls of each group, and whether it has waviness."""
        for number, group in enumerate(self.groups):
            members = parameters[number * L : (number + 1) * L]
            group['balls_in'] = max(member.bearing.n_balls for member in members)
            group['spalls_in'] = max(len(member.defects) for member in members)
            group['wavy'] = any(member.waviness for member in members)

    def motion(self, index: int, next_sample: int) -> Array:
        """Return the state of one bearing as `layout.STATE`, before its `kernel.start`."""
        state = np.zeros(1, layout.STATE)
        _take_motion(self.groups, index, next_sample % layout.CHUNK / self._sample_rate, state)
        return state

    def snapshot(self, index: int, next_sample: int, tick: int) -> FloatArray:
        """Return the numbers from which `condition` computes the state of one bearing."""
        found = np.empty(SNAPSHOT_SIZE)
        _take_snapshot(
            self.groups, index, next_sample % layout.CHUNK / self._sample_rate, self.values,
            self.fade, min(next_sample - int(self.faded[index]), 0), self.drift, self.rings,
            next_sample % tick, tick, found,
        )  # fmt: skip
        return found

    def seed(self, index: int) -> int:
        """Return the seed of one bearing."""
        number, lane = divmod(index, L)
        return int(self.groups[number]['seed'][lane])

    def fill_filters(self, index: int, simulator: Simulator) -> None:
        """Copy the states of sensor and decimator of a simulator to one lane."""
        number, lane = divmod(index, L)
        self.groups[number]['sensor'][:, lane] = simulator.state['sensor'][0]
        # In polyphase form, as the taps.
        padding = np.zeros((2, self.oversample - 1))
        internal = np.concatenate([padding, simulator.history], axis=1)
        memory = self.history[number].reshape(self.oversample, -1, 2, L)
        memory[..., lane] = internal.reshape(2, -1, self.oversample).T

    def place(self, index: int, simulator: Simulator) -> None:
        """Copy a simulator to one lane, except its filter states."""
        number, lane = divmod(index, L)
        group, tables, state = self.groups[number], simulator.tables, simulator.state[0]
        m = tables.machines[0]

        def put(record: Any, **values: Any) -> None:
            for name, value in values.items():
                record[name][..., lane] = value

        put(group, **{name: state[name] for name in 'qvaj'})
        put(group, **{name: m[name] for name in f'{layout.PRECISE} {fl.SHARED}'.split()})
        n = int(m['n_balls'])
        to_z, to_w, read = _sensor_rows(simulator.parameters, self.step)
        put(group, per_ball=1.0 / n, seed=simulator.seed, to_z=to_z, to_w=to_w, read=read)
        self.balls[number, :, :, lane] = _slots(n, self.balls.shape[1])
        since = simulator.next_sample % layout.CHUNK / simulator.sample_rate
        hz, slip = simulator.shaft_hz, simulator.inputs()[coefficients.SLIP]
        carried = hz * (1.0 - slip)
        speeds = m['ftf_order'] * carried, hz, m['spin_order'] * carried
        for (name, whole), speed in zip(_PHASES.items(), speeds, strict=True):
            put(group, **{name: (state[name] - since * speed) % whole})
        slot = first_slot(group['cage'][lane], n, float(m['load_turns']))
        ahead = 2.0 * math.pi * (state['cage'] + slot / n)
        shaft = state['shaft_cos'], state['shaft_sin']
        put(group, directions=(math.cos(ahead), math.sin(ahead), *shaft))
        for slot, record in enumerate(group['spalls']):
            put(record, **_spall(tables.defects[slot] if slot < len(tables.defects) else None, m))
        self._tables[index] = tables
        self.set_surfaces(index, tables.surfaces)
        self.constants[index] = simulator.constants[0]
        self.values[index] = simulator.values
        self.drift[index], self.rings[index] = simulator.drift, simulator.rings
        self.fade[index], self.faded[index] = simulator.fade, simulator.faded
        self.marks[index] = simulator.marks

    def set_surfaces(self, index: int, surfaces: Surfaces) -> None:
        """Copy the surfaces of one bearing to its lane."""
        number, lane = divmod(index, L)
        group, table = self.groups[number], surfaces.table
        missing = len(table) - self.surfaces.shape[1]
        if missing > 0:
            self.surfaces = np.pad(self.surfaces, ((0, 0), (0, missing)))
            self._equations.clear()
        self.surfaces[index, : len(table)] = table
        for name in ('outer', 'inner', 'ball'):
            group[name + '_nodes'][lane] = getattr(surfaces, name)
        group['highest'][lane] = surfaces.highest
        self._tables[index] = self._tables[index]._replace(surfaces=surfaces._replace(table=None))
        self._equations.pop(index, None)

    def equations(self, index: int, parameters: TwinParameters) -> Equations:
        """Return the `Equations` of one bearing, for compiled functions of a single bearing."""
        if index not in self._equations:
            tables = self._tables[index]
            tables = tables._replace(surfaces=tables.surfaces._replace(table=self.surfaces[index]))
            constants = self.constants[index : index + 1]
            self._equations[index] = equations_of(parameters, constants, tables)
        return self._equations[index]

    def state(self) -> list[Array]:
        """Return motion, phases, decimator states, inner rings, fades and checksums, as views."""
        singles, doubles = (
            self.groups.view(kind).reshape(len(self.groups), -1)[:, part]
            for kind, part in zip((np.float32, np.float64), fl.CARRIED, strict=True)
        )
        carried = [singles, doubles, self.history, self.drift, self.rings]
        return [*carried, self.fade, self.faded, self.marks]

    def set_state(self, parts: Sequence[Array]) -> None:
        """Set the arrays that :meth:`state` returns."""
        for mine, given in zip(self.state(), parts, strict=True):
            mine[...] = given


@compiled()
def _take_motion(groups: Array, index: int, since: float, state: Array) -> None:
    """Write motion and phases of one bearing ``since`` s after the last grid point of phases."""
    number, lane = index // L, index % L
    group, found = groups[number], state[0]
    for k in range(4):
        found.q[k], found.v[k] = group.q[k, lane], group.v[k, lane]
        found.a[k], found.j[k] = group.a[k, lane], group.j[k, lane]
    found.cage = (group.cage[lane] + since * group.cage_hz[lane]) % 1.0
    found.shaft = (group.shaft[lane] + since * group.shaft_hz[lane]) % 1.0
    found.spin = (group.spin[lane] + since * group.spin_hz[lane]) % layout.SPIN_TURNS
    cage, shaft = 2.0 * math.pi * found.cage, 2.0 * math.pi * found.shaft
    found.cage_cos, found.cage_sin = math.cos(cage), math.sin(cage)
    found.shaft_cos, found.shaft_sin = math.cos(shaft), math.sin(shaft)


@compiled()
def _take_snapshot(
    groups: Array,
    index: int,
    since_grid: float,
    values: FloatArray,
    fade: FloatArray,
    left: int,
    drift: FloatArray,
    rings: FloatArray,
    since_tick: int,
    tick: int,
    snapshot: FloatArray,
) -> None:
    """Fill ``snapshot`` with the data of the condition of one bearing, see `condition`."""
    _take_motion(groups, index, since_grid, snapshot[:MOTION].view(layout.STATE))
    put_inputs(
        values[index], fade[index] * left, drift[index], rings[index], since_tick, tick, snapshot
    )


def _sensor_rows(p: TwinParameters, step: float) -> tuple[FloatArray, ...]:
    """Return the coefficients of both sensor states and of its output at the end of a step."""
    # `filters.resonator` takes the jerk times the step, the kernel the jerk itself.
    scales = np.array([1.0, 1.0, 1.0, step, 1.0, step])
    to_z, to_w = scales * filters.resonator(p.resonance_hz, p.resonance_damping, step, 1)[:2]
    read = (-1.0, -2.0 * p.resonance_damping, 0.0) if p.resonance_hz else (0.0, 0.0, 1.0)
    return to_z, to_w, np.array(read)


def _slots(n_balls: int, slots: int) -> FloatArray:
    """Return directions and negative numbers of the slots of a lane, see `layout`."""
    numbers = np.array([(k + 1) // 2 if k % 2 else -(k // 2) for k in range(slots)])
    angles = 2.0 * math.pi * numbers / n_balls
    rows = np.stack([np.cos(angles), np.sin(angles), -numbers], axis=1)
    rows[n_balls:, :2] = 0.0
    return rows


def _spall(defect: Any, machine: Any) -> dict[str, float]:
    """Return the fields of one spall of a lane; ``defect`` is None if there is none."""
    unused = dict.fromkeys(fl.SPALL.names or (), 0.0)
    unused |= {'ball': -1.0, 'only': -1.0, 'half': -1.0}
    if defect is None:
        return unused
    place, n_balls = PLACES[defect['place']], machine['n_balls']
    on_ball, on_inner = place == 'ball', place == 'inner'
    radius = machine['inner_radius' if on_inner else 'outer_radius']
    metres = 0.5 * math.pi * machine['d_ball'] if on_ball else 2.0 * math.pi * radius / n_balls
    even = defect['inner_curvature' if on_ball or on_inner else 'outer_curvature']
    # The position of an outer race spall or a worn pocket depends on the cage alone.
    return unused | {
        'scale': 2.0 if on_ball else n_balls,
        'metres': metres,
        'on_race': not on_ball,
        'ball': defect['ball'] if on_ball else -1.0,
        'only': defect['ball'] if place == 'cage' else -1.0,
        'even': even,
        'odd': defect['outer_curvature'] if on_ball else even,
        'profile': defect['profile'],
        'half': defect['half'],
        'depth': defect['depth'],
        'angle': defect['angle'],
        'by_cage': not on_ball,
        'by_shaft': -1.0 if on_inner else 0.0,
        'by_spin': on_ball,
    }
