# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Fleet: simulation of many bearings, each with its own parameters, temperature, speed, seed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
import functools
from itertools import pairwise
import math
import struct
from typing import Any, TYPE_CHECKING

from bearing_twin.dynamics.equations import coefficients, filters, inner_ring
from bearing_twin.dynamics.equations.waviness import surfaces
from bearing_twin.dynamics.fleet.kernel import advance_all
from bearing_twin.dynamics.fleet.lanes import Lanes
from bearing_twin.dynamics.parameters import check_speed
from bearing_twin.dynamics.saved import identity, StateFormat
from bearing_twin.dynamics.single.condition import Condition, condition
from bearing_twin.dynamics.single.simulator import Block, Simulator
from bearing_twin.errors import BearingTwinError
from bearing_twin.given import real_numbers
from bearing_twin.numerics.compiled import compiled
from bearing_twin.numerics.vector import L
from bearing_twin.quantity import check_range, check_whole
from bearing_twin.thermal.gcr15 import check_temperature
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.equations.layout import Records
    from bearing_twin.dynamics.parameters import TwinParameters

FloatArray = npt.NDArray[np.float64]
Array = npt.NDArray[Any]

_SAVED = StateFormat(b'BFleet\x00\x07', struct.Struct('<dQIII'), 'a fleet')


@dataclass(frozen=True, kw_only=True)
class FleetBlock:
    """
    Block of housing accelerations of all bearings.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> block = Fleet([preset('paper')] * 3).advance(256, temperatures=60.0, shaft_hz=25.0)
    >>> block.first_sample, block.x.shape
    (0, (3, 256))

    """

    first_sample: int
    """Running index of the first sample."""
    x: npt.NDArray[np.float32]
    """Horizontal acceleration, m/s^2, shape (bearings, n)."""
    y: npt.NDArray[np.float32]
    """Vertical acceleration, m/s^2, shape (bearings, n)."""


class Fleet:
    """
    Simulate many bearings together, in single precision, with the physics of `Simulator`.

    With the same parameters and seed a bearing of a fleet and a `Simulator` agree to some 0.1 % at
    usual speeds; at the highest speeds they differ by up to a third, because a fleet does not
    split steps at kinks (see docs/realtime.md). The random numbers are the same. With constant
    inputs, splitting a block or saving and loading in between changes no bit.

    Parameters
    ----------
    parameters : sequence of TwinParameters
        One set per bearing.
    sample_rate
        Output rate of all bearings, Hz, 2000 to 204800.
    seeds
        One seed per bearing; None: 0, 1, 2, ...
    temperatures, shaft_hz
        Initial values, degC and Hz, one per bearing or one for all.
    threads
        Number of threads that share the bearings, in groups of sixteen. Results do not depend on
        it.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> fleet = Fleet([preset('paper'), preset('incipient')])
    >>> block = fleet.advance(256, temperatures=[40.0, 60.0], shaft_hz=25.0)
    >>> block.y.shape
    (2, 256)
    >>> round(fleet.condition(1).beta0, 3)
    1.011

    """

    def __init__(
        self,
        parameters: Sequence[TwinParameters],
        *,
        sample_rate: float = 25600.0,
        seeds: Sequence[int] | None = None,
        temperatures: npt.ArrayLike = 20.0,
        shaft_hz: npt.ArrayLike = 25.4,
        threads: int = 1,
    ) -> None:
        size = len(parameters)
        if not size:
            msg = 'a fleet needs at least one bearing'
            raise BearingTwinError(msg)
        self._parameters = list(parameters)
        self._temperatures = self._checked('temperatures', temperatures, check_temperature)
        self._shaft_hz = self._checked('shaft_hz', shaft_hz, check_speed)
        seeds = list(range(size)) if seeds is None else list(seeds)
        if len(seeds) != size:
            msg = f'{len(seeds)} seeds for {size} bearings; give one a bearing'
            raise BearingTwinError(msg)
        self.next_sample = 0
        self.sample_rate = filters.check_rate(sample_rate)
        self._lanes = lanes = Lanes(parameters, self.sample_rate)
        self._tick = inner_ring.tick_length(self.sample_rate)
        for index in range(lanes.size):
            if index < size:
                simulator = self._fresh(index, parameters[index], seeds[index])
            lanes.place(index, simulator)
            lanes.fill_filters(index, simulator)
        lanes.update_group_sizes(self._parameters)
        groups = len(lanes.groups)
        edges = np.linspace(0, groups, min(max(threads, 1), groups) + 1).astype(int).tolist()
        self._shares = list(pairwise(edges))
        self._rooms = [lanes.room() for _ in self._shares]
        self._pool = ThreadPoolExecutor(len(self._shares)) if len(self._shares) > 1 else None
        self._tick_all(self._temperatures[:0], self._shaft_hz[:0])  # compile before the first use

    def __len__(self) -> int:
        return len(self._parameters)

    @property
    def parameters(self) -> tuple[TwinParameters, ...]:
        """Parameters in use, one set per bearing."""
        return tuple(self._parameters)

    def advance(self, n: int, temperatures: npt.ArrayLike, shaft_hz: npt.ArrayLike) -> FleetBlock:
        """
        Advance all by ``n`` samples while temperatures and speeds change to the values given.

        ``n`` is 1 to 2^20. Temperatures, degC, and speeds, Hz, hold at the end of the block, one
        per bearing or one for all.
        """
        check_whole('n', n)
        check_range('n', n, 1, 1 << 20, 'samples')
        outer = self._checked('temperatures', temperatures, check_temperature)
        speed = self._checked('shaft_hz', shaft_hz, check_speed)
        was_outer, was_speed = self._temperatures, self._shaft_hz
        lanes = self._lanes
        begin, end = lanes.values, lanes.values.copy()
        _evaluate_changed(lanes.constants, was_outer, was_speed, outer, speed, end)
        start = begin[:, : coefficients.INPUTS]
        growth = end[:, : coefficients.INPUTS] - start
        outs = [np.empty((2, (end - first) * L, n), np.float32) for first, end in self._shares]
        first, done = self.next_sample, 0
        ticking = bool((lanes.constants['physical'] != 0.0).any())
        while done < n:
            count = n - done
            if ticking:
                count = min(count, self._tick - self.next_sample % self._tick)
            at = np.array([done, done + count]) / n
            ramp = start + growth * at[:, None, None]
            self._advance_shares(ramp, outs, done, count)
            done += count
            self.next_sample += count
            if ticking and self.next_sample % self._tick == 0:
                share = done / n
                self._tick_all(
                    was_outer + (outer - was_outer) * share,
                    was_speed + (speed - was_speed) * share,
                )
        self._temperatures, self._shaft_hz, lanes.values = outer, speed, end
        size, out = len(self), np.concatenate(outs, axis=1) if len(outs) > 1 else outs[0]
        return FleetBlock(first_sample=first, x=out[0, :size], y=out[1, :size])

    def _advance_shares(self, ramp: FloatArray, outs: list[Array], begin: int, count: int) -> None:
        """Advance all groups, distributed over the threads; kernels release the GIL."""
        lanes = self._lanes

        def advance(share: tuple[int, int], room: Array, out: Array) -> None:
            part, lane = slice(*share), slice(share[0] * L, share[1] * L)
            advance_all(
                lanes.groups[part], lanes.balls[part], lanes.surfaces[lane], lanes.history[part],
                np.ascontiguousarray(ramp[:, lane]), lanes.drift[lane], lanes.fade[lane],
                lanes.faded[lane], lanes.taps, self.next_sample, self.next_sample % self._tick,
                lanes.oversample, lanes.step, room, out, begin, count,
            )  # fmt: skip

        spread = map if self._pool is None else self._pool.map
        list(spread(advance, self._shares, self._rooms, outs))

    def of_bearing(self, block: FleetBlock, index: int) -> Block:
        """Return one bearing of the latest block; read its condition before the next `advance`."""
        return Block(
            first_sample=block.first_sample,
            x=block.x[index],
            y=block.y[index],
            describe=functools.partial(self.condition, index),
        )

    def condition(self, index: int) -> Condition:
        """State of one bearing at the next sample."""
        self._check_index(index)
        snapshot = self._lanes.snapshot(index, self.next_sample, self._tick)
        return condition(self._lanes.equations(index, self._parameters[index]), snapshot)

    def _inputs(self, index: int | slice) -> FloatArray:
        """Return the inputs of the equations at the next sample, of one or several bearings."""
        lanes = self._lanes
        left = np.minimum(self.next_sample - lanes.faded[index], 0)
        behind = lanes.fade[index] * left[..., None]
        return inner_ring.inputs(
            lanes.values[index], behind, lanes.drift[index], self.next_sample % self._tick
        )

    def reconfigure(self, index: int, parameters: TwinParameters) -> None:
        """
        Change the parameters of one bearing while running; its state continues.

        Changes take effect as in `Simulator.reconfigure`. The inner ring temperature continues if
        the mode remains physical. If the parameters are refused, nothing changes.
        """
        self._check_index(index)
        if parameters.bearing.n_balls > self._lanes.most_balls:
            msg = (
                f'{parameters.bearing.name} has {parameters.bearing.n_balls} balls, more than the '
                f'{self._lanes.most_balls} of this fleet; start a new fleet with it'
            )
            raise BearingTwinError(msg)
        simulator = self._simulator(index, parameters, self._inputs(index))
        self._parameters[index] = parameters
        self._lanes.place(index, simulator)
        self._lanes.update_group_sizes(self._parameters)

    def settle(self, index: int, temperature: float) -> None:
        """Set an inner ring to its steady state at ``temperature``; see `Simulator.settle`."""
        simulator = self.extract(index)
        simulator.settle(temperature)
        self._temperatures[index] = simulator.temperature
        self._lanes.place(index, simulator)

    def extract(self, index: int) -> Simulator:
        """
        Return one bearing as a simulator with its motion, phases, temperatures and sample index.

        The filter states, some ms of signal, are not included.
        """
        self._check_index(index)
        return self._simulator(index, self._parameters[index], self._inputs(index))

    def place(self, index: int, simulator: Simulator) -> None:
        """
        Let one bearing continue from the state of a simulator; the fleet's sample index stays.

        Raises
        ------
        BearingTwinError
            If parameters or sample rate of the simulator differ from those of this bearing.

        """
        self._check_index(index)
        theirs, ours = simulator.parameters, self._parameters[index]
        if (theirs, simulator.sample_rate) != (ours, self.sample_rate):
            msg = f'a simulator of other parameters or rate cannot become bearing {index}'
            raise BearingTwinError(msg)
        inner = simulator.condition().inner_ring_temperature
        self._temperatures[index] = simulator.temperature
        self._shaft_hz[index] = simulator.shaft_hz
        moved = self._fresh(index, ours, seed=simulator.seed)
        rings = np.array([inner, inner]) if ours.thermal_mode == 'physical' else None
        moved.continue_from(simulator.state, self.next_sample, rings, simulator.inputs())
        self._lanes.place(index, moved)
        self._lanes.fill_filters(index, simulator)

    def _simulator(self, index: int, parameters: TwinParameters, inputs: FloatArray) -> Simulator:
        """Return one bearing with these parameters; ring temperatures continue if physical."""
        lanes = self._lanes
        carried = parameters.thermal_mode == 'physical' and not math.isnan(lanes.rings[index, 0])
        simulator = self._fresh(index, parameters, lanes.seed(index))
        simulator.continue_from(
            lanes.motion(index, self.next_sample), self.next_sample,
            lanes.rings[index] if carried else None,
            inputs if simulator.marks[1] == lanes.marks[index, 1] else None,
        )  # fmt: skip
        return simulator

    def _fresh(self, index: int, parameters: TwinParameters, seed: int) -> Simulator:
        return Simulator(
            parameters,
            sample_rate=self.sample_rate,
            seed=seed,
            temperature=float(self._temperatures[index]),
            shaft_hz=float(self._shaft_hz[index]),
        )

    def save(self) -> bytes:
        """Return the complete state of all bearings, without their parameters."""
        body = b''.join(
            part.astype(part.dtype.newbyteorder('<')).tobytes() for part in self._state()
        )
        fields = (
            self.sample_rate, self.next_sample, len(self), self._lanes.most_balls,
            identity(self._parameters),
        )  # fmt: skip
        return _SAVED.pack(fields, body)

    def load(self, data: bytes) -> None:
        """
        Continue from a state that :meth:`save` returned.

        Raises
        ------
        BearingTwinError
            If ``data`` is damaged, of another version or of another fleet; the state is then
            unchanged.

        """
        fields, body = _SAVED.unpack(data)
        rate, next_sample, size, n_balls, whose = fields
        parts = self._state()
        own = (self.sample_rate, len(self), self._lanes.most_balls, identity(self._parameters))
        if (rate, size, n_balls, whose) != own or len(body) != sum(part.nbytes for part in parts):
            msg = (
                f'saved state is for {size} bearings at {rate} Hz, this fleet has {own[1]} at '
                f'{own[0]} Hz, or their geometries or thermal modes differ; load it with its own '
                'configuration'
            )
            raise BearingTwinError(msg)
        loaded, at = [], 0
        for part in parts:
            values = np.frombuffer(body, part.dtype.newbyteorder('<'), part.size, at)
            at += part.nbytes
            loaded.append(values.astype(part.dtype).reshape(part.shape))
        numbers = [np.abs(values[~np.isnan(values)]) for values in (*loaded[:-3], loaded[-1])]
        temperatures, speeds = loaded[-3], loaded[-2]
        for temperature, speed in zip(temperatures, speeds, strict=True):
            check_temperature(float(temperature))
            check_speed(float(speed))
        motion = np.concatenate([part.ravel() for part in (*loaded[:5], loaded[6])])
        beyond = any((part > 1e20).any() for part in numbers)
        if next_sample >= 2**62 or beyond or not np.isfinite(motion).all():
            msg = 'saved state holds values that no simulation reaches; start without it'
            raise BearingTwinError(msg)
        inputs, *lanes, self._temperatures, self._shaft_hz, keys = loaded
        ours = self._lanes.marks.copy()
        self._lanes.set_state(lanes)
        self._lanes.groups['seed'] = keys
        self.next_sample = next_sample
        for index in range(self._lanes.size):
            p = self._parameters[min(index, len(self) - 1)]
            self._lanes.set_surfaces(index, surfaces(p, self._lanes.seed(index)))
            outer, hz = self._temperatures[index], self._shaft_hz[index]
            constants = self._lanes.constants[index : index + 1]
            coefficients.evaluate(constants, outer, outer, hz, self._lanes.values[index])
        for index in np.flatnonzero((self._lanes.marks != ours).any(axis=1)).tolist():
            p = self._parameters[min(index, len(self) - 1)]
            self._lanes.place(index, self._simulator(index, p, inputs[index]))

    def _state(self) -> list[Array]:
        """Return the arrays of a saved state."""
        lanes = self._lanes
        carried = [*lanes.state(), self._temperatures, self._shaft_hz, lanes.groups['seed']]
        return [self._inputs(slice(None)), *carried]

    def _tick_all(self, outer: FloatArray, hz: FloatArray) -> None:
        """Advance the inner rings by a thermal tick."""
        lanes, seconds = self._lanes, self._tick / self.sample_rate
        inner_ring.tick_all(
            lanes.constants, lanes.values, (self._temperatures, self._shaft_hz), (outer, hz),
            lanes.rings, lanes.drift, self._tick, seconds,
        )  # fmt: skip

    def _checked(
        self, name: str, given: npt.ArrayLike, check: Callable[[float], float]
    ) -> FloatArray:
        """Return one validated value per lane; idle lanes repeat the last bearing."""
        values = real_numbers(name, given)
        size = len(self._parameters)
        if values.ndim and values.shape != (size,):
            msg = f'{name} has shape {values.shape}; give one value, or one for each of {size}'
            raise BearingTwinError(msg)
        padded = np.empty(-(-size // L) * L)
        padded[:size] = values
        padded[size:] = padded[size - 1]
        index = 0
        try:
            for index in (int(padded.argmin()), int(padded.argmax())):  # both find a NaN
                check(float(padded[index]))
        except BearingTwinError as error:
            which = f'bearing {min(index, size - 1)}: ' if values.ndim else ''
            raise BearingTwinError(f'{which}{error}') from None
        return padded

    def _check_index(self, index: int) -> None:
        check_whole('index', index)
        if not 0 <= index < len(self):
            msg = f'no bearing {index} in a fleet of {len(self)}'
            raise BearingTwinError(msg)


@compiled()
def _evaluate_changed(
    constants: Records,
    was_outer: FloatArray,
    was_speed: FloatArray,
    outer: FloatArray,
    speed: FloatArray,
    values: FloatArray,
) -> None:
    """Evaluate the coefficients of bearings whose temperature or speed has changed."""
    for i in range(constants.shape[0]):
        if outer[i] != was_outer[i] or speed[i] != was_speed[i]:
            coefficients.evaluate(constants[i : i + 1], outer[i], outer[i], speed[i], values[i])
