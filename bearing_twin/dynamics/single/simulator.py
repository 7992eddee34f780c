# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulator of one bearing: the twin, whose state continues from block to block."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
import functools
import math
import struct
from typing import Any, TYPE_CHECKING
import zlib

from bearing_twin.dynamics.equations import coefficients, filters, inner_ring
from bearing_twin.dynamics.equations.layout import CHUNK, STATE
from bearing_twin.dynamics.equations.stability import steps
from bearing_twin.dynamics.equations.waviness import surfaces
from bearing_twin.dynamics.parameters import check_speed, TwinParameters
from bearing_twin.dynamics.saved import identity, StateFormat
from bearing_twin.dynamics.single import kernel, objects
from bearing_twin.dynamics.single.condition import (
    Condition,
    condition,
    MOTION,
    put_inputs,
    SNAPSHOT_SIZE,
)
from bearing_twin.dynamics.single.tables import ball_table, defect_table, equations_of, machine
from bearing_twin.errors import BearingTwinError
from bearing_twin.given import check_kind, one_axis
from bearing_twin.numerics.compiled import compiled
from bearing_twin.quantity import check_range, check_whole
from bearing_twin.thermal.gcr15 import check_temperature
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.equations.layout import Records


FloatArray = npt.NDArray[np.float64]

RUN_IN = 0.04
"""Time that a bearing runs before sample 0, s, until the vibration of its start has decayed."""
_FADE = 0.16
"""Duration of a change of load, its direction or clearance, s, for any block length. It is many
periods of the slowest mode of the rings, so that the change causes no impact."""
_MAX_BLOCK = 1 << 24
_MOST_TURNS = 1e3
"""Limit of the phases in a saved state, turns. Phases are wrapped at grid points only; between
them they go beyond a turn, and at very low speed jitter can move them backwards."""
_LARGEST = 2.0**53
"""Limit of all numbers in a state. The largest is the integer whose bits are the loaded balls."""
_SAVED = StateFormat(b'BTwin\x00\x06\x00', struct.Struct('<dIQddIQII'), 'one bearing')


@dataclass(frozen=True, kw_only=True)
class Block:
    """
    Acceleration of the housing, as measured by an accelerometer.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> block = Simulator(preset('paper')).advance(256, temperature=60.0, shaft_hz=25.0)
    >>> block.first_sample, block.y.shape, round(block.condition.beta0, 3)
    (0, (256,), 1.011)

    """

    first_sample: int
    """Running index of ``x[0]``. The signal lags the condition by `Simulator.delay`."""
    x: npt.NDArray[np.float32]
    """Horizontal, m/s^2."""
    y: npt.NDArray[np.float32]
    """Vertical, m/s^2, upwards."""
    describe: Callable[[], Condition] = field(repr=False, compare=False)
    """Function that computes the condition."""

    @functools.cached_property
    def condition(self) -> Condition:
        """State at the end of the block, computed on first access."""
        return self.describe()


class Simulator:
    """
    Integrate the equations of motion of one bearing and keep their state.

    The equations are solved with the fourth-order Hermite scheme. A step is one output sample or
    1/25600 s, whichever is shorter, and a third of that above 27 Hz and for stiff rings. Steps are
    smaller where contact or the path through a defect is not smooth. The sensor resonance is part
    of the steps; then the signal is decimated. The decimator delays the signal by `delay` relative
    to the condition: `Block.x` [k] shows an event `delay` seconds after it happened.

    Inputs are ramped linearly over the block of an `advance`, so that stiffness and defect depth
    follow the temperature without a step. With constant inputs, splitting a block or saving and
    loading in between changes no bit. A state that is loaded under other parameters changes over
    to them as in `reconfigure`.

    Parameters
    ----------
    parameters : TwinParameters
        Bearing, defects and machine.
    sample_rate
        Output rate, Hz, 2000 to 204800.
    seed
        Seed of jitter, noise and surface profiles, 0 to 2^32 - 1.
    temperature
        Temperature at the start, degC, 20 to 110.
    shaft_hz
        Shaft speed at the start, Hz, 0 to 500.

    Examples
    --------
    A tenth of a second while the outer ring warms from 20 to 30 degC:

    >>> from bearing_twin.dynamics import preset
    >>> simulator = Simulator(preset('paper'))
    >>> block = simulator.advance(2560, temperature=30.0, shaft_hz=25.4)
    >>> block.y.shape, round(block.condition.bpfi, 1), round(block.condition.beta0, 3)
    ((2560,), 126.4, 1.004)

    """

    def __init__(
        self,
        parameters: TwinParameters,
        *,
        sample_rate: float = 25600.0,
        seed: int = 0,
        temperature: float = 20.0,
        shaft_hz: float = 25.4,
    ) -> None:
        self.sample_rate = filters.check_rate(sample_rate)
        self._oversample = filters.oversampling(sample_rate)
        self._taps = filters.decimator(self._oversample)
        self.start = (check_temperature(temperature), check_speed(shaft_hz))
        """Temperature and speed that :meth:`reset` restores, degC and Hz."""
        self.tick = inner_ring.tick_length(sample_rate)
        # State and tables, records of `layout` and rows of `coefficients`: read by `fleet.lanes`.
        self.drift = np.zeros((2, coefficients.INPUTS))
        self.fade, self.faded = np.zeros(coefficients.INPUTS), 0
        self.rings = np.full(2, math.nan)
        self.values = np.zeros(coefficients.CONDITION_SIZE)
        self.history = np.zeros((2, len(self._taps) - self._oversample))
        self.state = np.zeros(1, STATE)
        self.seed = _checked(seed)
        self._configure(parameters)
        self.reset()

    @property
    def parameters(self) -> TwinParameters:
        """Parameters in use."""
        return self._parameters

    @property
    def temperature(self) -> float:
        """Temperature of the outer ring at the next sample, degC."""
        return self._temperature

    @property
    def shaft_hz(self) -> float:
        """Shaft speed at the next sample, Hz."""
        return self._shaft_hz

    @property
    def delay(self) -> float:
        """Delay of the output signal relative to the condition, s."""
        return filters.delay(self.sample_rate)

    def reset(self) -> None:
        """
        Start again at sample 0.

        Before that, the bearing runs for `RUN_IN` seconds from a static equilibrium that includes
        the defects under the balls, so that the start causes no impact.
        """
        self.next_sample = 0
        self._temperature, self._shaft_hz = self.start
        self.history[:] = 0.0
        self.state[:] = np.zeros(1, STATE)
        self._come_from(None)
        self._settle_ring()
        self._run_in()

    def reconfigure(self, parameters: TwinParameters) -> None:
        """
        Change defects, preset or thermal mode while running; the state continues.

        A new defect acts from the next sample on. Load, its direction, clearance, contact
        stiffness and slip reach their new values within 0.16 s, for any block length. If the
        stiffness of shaft or housing changes, the foot of the spring must jump, and all values
        change at once.
        """
        was, marks, inputs = self._parameters, self.marks, self.inputs()
        self._configure(parameters)
        if was.thermal_mode == parameters.thermal_mode == 'physical':
            self._carry_rings()
        else:
            self._settle_ring()
        self._come_from(inputs if marks[1] == self.marks[1] else None)
        self._start_motion()

    def settle(self, temperature: float) -> None:
        """
        Set the inner ring to its steady state for an outer ring at ``temperature``, degC.

        Clearance, stiffness and slip reach their new values within 0.16 s. The mode paper has no
        inner ring temperature, and nothing changes.
        """
        if self._parameters.thermal_mode == 'physical':
            inputs = self.inputs()
            self._temperature = check_temperature(temperature)
            self._settle_ring()
            self._come_from(inputs)

    def advance(self, n: int, temperature: float, shaft_hz: float) -> Block:
        """
        Advance by ``n`` samples while temperature and speed change linearly to the values given.

        ``n`` is 1 to 2^24. ``temperature`` of the outer ring, 20 to 110 degC, and ``shaft_hz``,
        0 to 500 Hz, hold at the end of the block.

        Raises
        ------
        BearingTwinError
            If a value is out of its range; the state is then unchanged.

        """
        outer, hz = check_temperature(temperature), check_speed(shaft_hz)
        return self._blocks(n, np.array([outer]), np.array([hz]))[0]

    def advance_all(
        self, n: int, temperatures: Sequence[float], speeds: Sequence[float]
    ) -> list[Block]:
        """
        Advance by blocks of ``n`` samples, one after the other, in one call.

        The result equals calls of :meth:`advance` with each temperature, degC, and speed, Hz, but
        other Python threads can run meanwhile.

        Examples
        --------
        >>> from bearing_twin.dynamics import preset
        >>> one, other = Simulator(preset('paper')), Simulator(preset('paper'))
        >>> blocks = one.advance_all(256, [20.0, 30.0], [25.0, 25.0])
        >>> again = [other.advance(256, each, 25.0) for each in (20.0, 30.0)]
        >>> [bool((a.y == b.y).all()) for a, b in zip(blocks, again)]
        [True, True]

        """
        outer = np.array(
            [check_temperature(each) for each in one_axis(temperatures, 'temperatures')]
        )
        hz = np.array([check_speed(each) for each in one_axis(speeds, 'speeds')])
        if len(outer) != len(hz):
            msg = f'{len(outer)} temperatures and {len(hz)} speeds; give one of each for a block'
            raise BearingTwinError(msg)
        return self._blocks(n, outer, hz)

    def _blocks(self, n: int, outer: FloatArray, hz: FloatArray) -> list[Block]:
        check_whole('n', n)
        check_range('n', n, 1, _MAX_BLOCK, 'samples')
        count, first = len(outer), self.next_sample
        out = np.empty((count, 2, n), dtype=np.float32)
        snapshots = np.empty((count, SNAPSHOT_SIZE))
        _advance_all(
            self._motion, self._temperature, self._shaft_hz, outer, hz, self.faded, self.seed,
            first, self.tick, self.tick / self.sample_rate, out, snapshots,
        )  # fmt: skip
        self.next_sample += count * n
        if count:
            self._temperature, self._shaft_hz = float(outer[-1]), float(hz[-1])
        return [
            Block(
                first_sample=first + i * n, x=x, y=y,
                describe=functools.partial(condition, self._equations, snapshot),
            )
            for i, ((x, y), snapshot) in enumerate(zip(out, snapshots, strict=True))
        ]  # fmt: skip

    def condition(self) -> Condition:
        """State at the next sample."""
        snapshot = np.empty(SNAPSHOT_SIZE)
        _take_snapshot(self._motion, self.faded, self.next_sample, self.tick, snapshot)
        return condition(self._equations, snapshot)

    def save(self) -> bytes:
        """
        Return the complete state: motion, phases, filters, sample index, seed and inputs.

        It does not contain the parameters. It can be loaded only with the same bearing geometry,
        thermal mode and sample rate.
        """
        body = np.concatenate(
            [
                self.state.view(float), self.history.ravel(), self.drift.ravel(),
                self.fade, self.inputs(), np.nan_to_num(self.rings),
            ]
        )  # fmt: skip
        fields = (
            self.sample_rate, self.seed, self.next_sample, self._temperature, self._shaft_hz,
            identity([self._parameters]), self.faded, *self.marks,
        )  # fmt: skip
        return _SAVED.pack(fields, body.astype('<f8').tobytes())

    def load(self, data: bytes) -> None:
        """
        Continue from a state that :meth:`save` returned.

        Raises
        ------
        BearingTwinError
            If ``data`` is damaged, of another version, or of another sample rate, bearing
            geometry or thermal mode; the state is then unchanged.

        """
        fields, body = _SAVED.unpack(data)
        rate, seed, next_sample, temperature, shaft_hz, whose, faded, *of = fields
        own = (self.sample_rate, identity([self._parameters]))
        sizes = [STATE.itemsize // 8, self.history.size, self.drift.size]
        sizes += [coefficients.INPUTS, coefficients.INPUTS, 2]
        if (rate, whose) != own or len(body) != 8 * sum(sizes):
            msg = (
                f'saved state at {rate:g} Hz belongs to another sample rate, bearing geometry or '
                f'thermal mode than this {self._parameters.bearing.name} at {own[0]:g} Hz in the '
                f'{self._parameters.thermal_mode} mode; load it with its own configuration'
            )
            raise BearingTwinError(msg)
        values = np.frombuffer(body, dtype='<f8').astype(float)
        state, history, drift, fade, inputs, rings = np.split(values, np.cumsum(sizes)[:-1])
        state = state.view(STATE)
        bounded = np.isfinite(values).all() and np.abs(values).max() < _LARGEST
        bounded = bounded and np.abs(state['q']).max() < 1.0 and np.abs(rings).max() < 300.0
        bounded = bounded and state['next_step'][0] in (0.0, *self.tables.machines['step'])
        if not (
            bounded and all(abs(state[name]) < _MOST_TURNS for name in ('cage', 'shaft', 'spin'))
        ):
            msg = 'saved state holds values that no simulation reaches; start without it'
            raise BearingTwinError(msg)
        if not 0 <= max(next_sample, faded) < 2**62:
            msg = f'saved state holds sample index {max(next_sample, faded)}, outside 0..2^62'
            raise BearingTwinError(msg)
        self._temperature, self._shaft_hz = check_temperature(temperature), check_speed(shaft_hz)
        self._evaluate()
        if seed != self.seed:
            self.seed = seed
            self._take(self.tables._replace(surfaces=surfaces(self._parameters, seed)))
        self.next_sample = next_sample
        self.state[:] = state
        self.history[:] = history.reshape(self.history.shape)
        self.fade[:], self.faded = fade, faded
        physical = self._parameters.thermal_mode == 'physical'
        self.rings[:] = rings if physical else math.nan
        self.drift[:] = drift.reshape(self.drift.shape) if physical else 0.0
        if tuple(of) != self.marks:
            self._come_from(inputs if of[1] == self.marks[1] else None)
            self._start_motion()

    def continue_from(
        self,
        state: Records,
        next_sample: int,
        rings: FloatArray | None = None,
        inputs: FloatArray | None = None,
    ) -> None:
        """
        Continue from phases, positions and velocities of a record `layout.STATE`.

        ``rings`` are the inner ring temperatures as in `inner_ring`. ``inputs`` are the inputs of
        the equations from which the next block starts; None: those of the parameters in use.
        """
        self.next_sample = next_sample
        if rings is not None:
            self.rings[:] = rings
            self._carry_rings()
        self._come_from(inputs)
        self.state[:] = state
        self._start_motion()

    def _configure(self, parameters: TwinParameters) -> None:
        check_kind('parameters', parameters, TwinParameters, 'preset returns some')
        p = parameters
        # Long steps, and short steps with one sensor sample each.
        long = filters.least_steps(self.sample_rate)
        stiff = steps(p, self.sample_rate) > long
        kinds = long, self._oversample
        machines = np.concatenate(
            [machine(p, self.sample_rate, each, stiff=stiff) for each in kinds]
        )
        reads = self._oversample // long
        self._resonators = np.zeros((2, 2 + reads, 6))
        for table, each in zip(self._resonators, kinds, strict=True):
            count = self._oversample // each
            step = 1.0 / (self.sample_rate * each)
            table[: 2 + count] = filters.resonator(
                p.resonance_hz, p.resonance_damping, step, count
            )
        self._parameters = p
        self.constants = coefficients.constants_of(p)
        found = surfaces(p, self.seed)
        self._take(kernel.Tables(machines, defect_table(p), ball_table(p), found))
        springs = np.array([p.inner_stiffness, *p.housing_stiffness])
        tables = machines, self.constants, self.tables.defects, np.array([p.waviness])
        whole = zlib.crc32(b''.join(table.tobytes() for table in tables))
        self.marks = whole, zlib.crc32(springs.tobytes())
        """Checksums of all constants of the equations, and of the springs: if these change, the
        foot of the shaft spring jumps."""

    def _take(self, tables: kernel.Tables) -> None:
        """Use ``tables``, which belong to the parameters in use."""
        self.tables = tables
        self._equations = equations_of(self._parameters, self.constants, tables)
        self._motion = objects.motion(
            self._equations, self._resonators, self._taps, self.state, self.history, self.values,
            self.rings, self.drift, self.fade,
        )  # fmt: skip

    def _evaluate(self) -> None:
        """Compute the values at the present speed, with both rings at the temperature."""
        outer = self._temperature
        coefficients.evaluate(self.constants, outer, outer, self._shaft_hz, self.values)

    def _run_in(self) -> None:
        """Run from equilibrium to the phases of sample 0, without jitter and noise."""
        values, machines, state = self.inputs(), self.tables.machines.copy(), self.state
        machines['jitter'] = machines['noise'] = 0.0
        turns = self._parameters.start_angle / (2.0 * math.pi) % 1.0
        hz, carried = self._shaft_hz, self._shaft_hz * (1.0 - values[coefficients.SLIP])
        machine = machines[0]
        n = CHUNK * math.ceil(RUN_IN * self.sample_rate / CHUNK) if hz else 0
        seconds = n / self.sample_rate
        state['cage'] = turns - seconds * machine['ftf_order'] * carried
        state['shaft'] = turns - seconds * hz
        state['spin'] = -seconds * machine['spin_order'] * carried
        tables = self.tables._replace(machines=machines)
        kernel.settle(state, tables, values)
        kernel.start(state, tables, values)
        if n:
            # A part of an array, as from `_advance`: numba compiles it again for a whole one.
            out = np.empty((2, n + 1), np.float32)[:, :n]
            kernel.advance(
                state, self.history, tables, self._resonators, self._taps,
                np.array([values, values]), np.zeros((2, coefficients.INPUTS)), self.fade, 0, 0,
                -n, 0, out,
            )  # fmt: skip
        state['cage'], state['shaft'], state['spin'] = turns, turns, 0.0
        self._start_motion()

    def inputs(self) -> FloatArray:
        """Return the inputs of the equations at the next sample, ordered as in `coefficients`."""
        behind = self.fade * min(self.next_sample - self.faded, 0)
        return inner_ring.inputs(self.values, behind, self.drift, self.next_sample % self.tick)

    def _come_from(self, inputs: FloatArray | None) -> None:
        """Fade from ``inputs`` of the equations to the present ones; None: switch at once."""
        self.fade[:], self.faded = 0.0, 0
        if inputs is not None:
            behind = inputs - self.inputs()
            end = self.next_sample + _FADE * self.sample_rate
            self.faded = CHUNK * math.ceil(end / CHUNK)
            self.fade[:] = behind / (self.next_sample - self.faded)

    def _start_motion(self) -> None:
        """Compute accelerations and jerks from positions, velocities and parameters."""
        kernel.start(self.state, self.tables, self.inputs())

    def _settle_ring(self) -> None:
        """Set the inner ring to its steady state."""
        self._evaluate()
        outer, hz = self._temperature, self._shaft_hz
        inner_ring.settle(self.constants, self.values, outer, hz, self.rings, self.drift)

    def _carry_rings(self) -> None:
        """Continue from the inner ring temperatures with the parameters in use."""
        self._evaluate()
        outer, hz = self._temperature, self._shaft_hz
        inner_ring.carry(self.constants, self.values, outer, hz, self.rings, self.drift, self.tick)


# The first arguments are objects of numba, whose fields mypy does not know.
@compiled()
def _take_snapshot(motion: Any, faded: int, at: int, tick: int, snapshot: FloatArray) -> None:
    """Fill ``snapshot`` with the data of the condition at sample ``at``, see `condition`."""
    since, behind = at % tick, motion.fade * min(at - faded, 0)
    snapshot[:MOTION].view(STATE)[0] = motion.states[0]
    put_inputs(motion.values, behind, motion.drift, motion.rings, since, tick, snapshot)


@compiled()
def _advance(
    motion: Any,
    was_temperature: float,
    was_hz: float,
    temperature: float,
    shaft_hz: float,
    faded: int,
    seed: int,
    first: int,
    tick: int,
    seconds: float,
    out: npt.NDArray[np.float32],
    snapshot: FloatArray,
) -> None:
    """
    Advance a bearing and its inner ring through a block, from tick to tick.

    A tick lasts ``seconds``; other arguments as in `kernel.advance` and `_take_snapshot`.
    """
    was, to, constants = (
        (was_temperature, was_hz),
        (temperature, shaft_hz),
        motion.equations.constants,
    )
    begin, end = motion.values, motion.values
    if to != was:
        end = np.empty(coefficients.CONDITION_SIZE)
        coefficients.evaluate(constants, temperature, temperature, shaft_hz, end)
    n, done, physical = out.shape[1], 0, constants[0].physical != 0.0
    ramp = np.empty((2, coefficients.INPUTS))
    while done < n:
        since = (first + done) % tick
        count = min(n - done, tick - since) if physical else n - done
        for i in range(coefficients.INPUTS):
            growth = end[i] - begin[i]
            ramp[0, i] = begin[i] + growth * (done / n)
            ramp[1, i] = begin[i] + growth * ((done + count) / n)
        kernel.advance(
            motion.states, motion.history, motion.equations.tables, motion.resonators, motion.taps,
            ramp, motion.drift, motion.fade, faded, seed, first + done, since,
            out[:, done : done + count],
        )  # fmt: skip
        done += count
        if physical and (first + done) % tick == 0:
            share = done / n
            now = was[0] + (to[0] - was[0]) * share, was[1] + (to[1] - was[1]) * share
            inner_ring.tick_one(
                constants, begin, was, now, motion.rings, motion.drift, tick, seconds
            )
    motion.values[:] = end
    _take_snapshot(motion, faded, first + n, tick, snapshot)


@compiled()
def _advance_all(
    motion: Any,
    was_temperature: float,
    was_hz: float,
    temperatures: FloatArray,
    speeds: FloatArray,
    faded: int,
    seed: int,
    first: int,
    tick: int,
    seconds: float,
    out: npt.NDArray[np.float32],
    snapshots: FloatArray,
) -> None:
    """Call `_advance` for consecutive blocks; the first array axis is the block."""
    for i in range(out.shape[0]):
        _advance(
            motion, was_temperature, was_hz, temperatures[i], speeds[i], faded, seed,
            first + i * out.shape[2], tick, seconds, out[i], snapshots[i],
        )  # fmt: skip
        was_temperature, was_hz = temperatures[i], speeds[i]


def _checked(seed: int) -> int:
    check_whole('seed', seed)
    if not 0 <= seed < 2**32:
        msg = f'seed={seed} is outside 0..4294967295'
        raise BearingTwinError(msg)
    return int(seed)
