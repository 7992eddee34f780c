# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Many bearings in one call, each with its own parameters, temperature, speed and seed."""

from __future__ import annotations

from dataclasses import dataclass
import math
import struct
from typing import Any, TYPE_CHECKING
import zlib

from bearing_twin.dynamics import filters, laws, layout
from bearing_twin.dynamics import fleet_kernel as fk
from bearing_twin.dynamics.compiled import compiled
from bearing_twin.dynamics.condition import Condition, condition
from bearing_twin.dynamics.simulator import check_speed, identity, Simulator
from bearing_twin.dynamics.tables import ball_table, constants, defect_table
from bearing_twin.errors import BearingTwinError
from bearing_twin.thermal.gcr15 import check_temperature
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from bearing_twin.dynamics.parameters import TwinParameters

__all__ = ['Fleet', 'FleetBlock']

FloatArray = npt.NDArray[np.float64]
Array = npt.NDArray[Any]

_MAGIC = b'BFleet\x00\x04'
_FIELDS = struct.Struct('<dQIII')


@dataclass(frozen=True, kw_only=True)
class FleetBlock:
    """Housing accelerations of all bearings."""

    first_sample: int
    """Running index of the first sample."""
    x: npt.NDArray[np.float32]
    """Horizontal, m/s^2, shape (bearings, n)."""
    y: npt.NDArray[np.float32]
    """Vertical, m/s^2, shape (bearings, n)."""


class Fleet:
    """
    Advances many bearings in step, in single precision, with the physics of `Simulator`.

    With the same parameters and seed a bearing of a fleet and a `Simulator` agree within single
    precision: the random numbers are the same too. Splitting a block or saving and loading in
    between changes no bit while the inputs are held.

    Parameters
    ----------
    parameters : sequence of TwinParameters
        One set a bearing. At most 4 defects each.
    sample_rate
        Output rate of all bearings, Hz, 2000 to 204800.
    seeds
        One seed a bearing; None: 0, 1, 2, ...
    temperatures, shaft_hz
        Values at the start, one a bearing or one for all, degC and Hz.

    """

    def __init__(
        self,
        parameters: Sequence[TwinParameters],
        *,
        sample_rate: float = 25600.0,
        seeds: Sequence[int] | None = None,
        temperatures: npt.ArrayLike = 20.0,
        shaft_hz: npt.ArrayLike = 25.4,
    ) -> None:
        size = len(parameters)
        if not size:
            msg = 'a fleet needs at least one bearing'
            raise BearingTwinError(msg)
        for index, each in enumerate(parameters):
            _check_defects(index, each)
        self._parameters = list(parameters)
        self._temperatures = self._checked('temperatures', temperatures, check_temperature)
        self._shaft_hz = self._checked('shaft_hz', shaft_hz, check_speed)
        seeds = list(range(size)) if seeds is None else list(seeds)
        if len(seeds) != size:
            msg = f'{len(seeds)} seeds for {size} bearings; give one a bearing'
            raise BearingTwinError(msg)
        self.next_sample = 0
        self.sample_rate = float(sample_rate)
        self._oversample = filters.oversampling(sample_rate)
        groups = -(-size // fk.L)
        n_balls = _even(max(p.bearing.n_balls for p in parameters))
        self._w = np.zeros((groups, fk.WORK_ROWS, fk.L), np.float32)
        self._balls = np.zeros((groups, n_balls, fk.BALL_ROWS, fk.L), np.float32)
        self._phases = np.zeros((groups, fk.PHASE_ROWS + 3, fk.L))
        self._keys = np.zeros((groups, fk.L), np.uint64)
        self._level = np.zeros((groups, fk.L), np.float32)
        self._law = np.zeros((groups * fk.L, laws.LAW_SIZE))
        self._values = np.zeros((groups * fk.L, laws.CONDITION_SIZE))
        self._drift = np.zeros((groups * fk.L, 2, laws.INPUTS))
        self._rings = np.full((groups * fk.L, 2), math.nan)
        self._balls_in = np.zeros(groups, np.int64)
        self._spalls_in = np.zeros(groups, np.int64)
        self._smooth_in = np.zeros(groups, np.bool_)
        for index in range(groups * fk.L):
            # Idle lanes of the last group repeat the last bearing.
            source = min(index, size - 1)
            simulator = Simulator(
                parameters[source],
                sample_rate=sample_rate,
                seed=seeds[source],
                temperature=float(self._temperatures[source]),
                shaft_hz=float(self._shaft_hz[source]),
            )
            self._place(index, simulator)
        taps = filters.decimator(self._oversample)
        self._delay = (len(taps) - 1) / 2.0 / self._oversample / self.sample_rate
        padded = np.concatenate([np.zeros(self._oversample - 1), taps])
        self._taps = padded.reshape(-1, self._oversample).T.ravel().astype(np.float32)
        self._tick = simulator.tick
        memory = (len(padded) // self._oversample - 1) * 2 * fk.L
        self._history = np.zeros((groups, self._oversample, memory), np.float32)

    def __len__(self) -> int:
        return len(self._parameters)

    @property
    def parameters(self) -> tuple[TwinParameters, ...]:
        """Parameters in force, one set a bearing."""
        return tuple(self._parameters)

    @property
    def delay(self) -> float:
        """Delay of the published signals against the conditions, s."""
        return self._delay

    def advance(self, n: int, temperatures: npt.ArrayLike, shaft_hz: npt.ArrayLike) -> FleetBlock:
        """
        Advance all by ``n`` samples while temperatures and speeds go to the values given.

        Parameters
        ----------
        n
            Samples, 1 to 2^20.
        temperatures, shaft_hz
            Values at the end of the block, one a bearing or one for all, degC and Hz.

        """
        if not 1 <= n <= 1 << 20:
            msg = f'block of {n} samples is outside 1..{1 << 20}'
            raise BearingTwinError(msg)
        outer = self._checked('temperatures', temperatures, check_temperature)
        speed = self._checked('shaft_hz', shaft_hz, check_speed)
        was_outer, was_speed = self._temperatures, self._shaft_hz
        begin, end = self._values, self._values.copy()
        _evaluate_changed(self._law, was_outer, was_speed, outer, speed, end)
        start = begin[:, : laws.INPUTS]
        growth = end[:, : laws.INPUTS] - start
        out = np.empty((2, len(self._law), n), np.float32)
        first, done = self.next_sample, 0
        physical = self._law[:, laws.PHYSICAL] != 0.0
        ticking = bool(physical.any())
        while done < n:
            count = n - done
            if ticking:
                count = min(count, self._tick - self.next_sample % self._tick)
            at = np.array([done, done + count]) / n
            ramp = start + growth * at[:, None, None]
            _advance_all(
                self._w, self._balls, self._balls_in, self._phases, self._history, self._keys,
                self._level, ramp, self._drift, self._taps, self._spalls_in, self._smooth_in,
                self.next_sample, self.next_sample % self._tick, self._oversample,
                1.0 / (self.sample_rate * self._oversample), out[:, :, done : done + count],
            )  # fmt: skip
            done += count
            self.next_sample += count
            if ticking and self.next_sample % self._tick == 0:
                share = done / n
                _tick_all(
                    self._law, was_outer + (outer - was_outer) * share,
                    was_speed + (speed - was_speed) * share, self._rings, self._drift, self._tick,
                    self._tick / self.sample_rate,
                )  # fmt: skip
        self._temperatures, self._shaft_hz, self._values = outer, speed, end
        size = len(self)
        return FleetBlock(first_sample=first, x=out[0, :size], y=out[1, :size])

    def condition(self, index: int) -> Condition:
        """State of one bearing at the next sample."""
        self._check_index(index)
        p = self._parameters[index]
        share = self.next_sample % self._tick / self._tick
        inner = self._rings[index, 0] + (self._rings[index, 1] - self._rings[index, 0]) * share
        values = np.empty(laws.CONDITION_SIZE)
        laws.evaluate(
            self._law[index], self._temperatures[index], inner, self._shaft_hz[index], values
        )
        return condition(
            p, values, self._motion(index), constants(p, self.sample_rate, self._oversample),
            defect_table(p), ball_table(p),
        )  # fmt: skip

    def reconfigure(self, index: int, parameters: TwinParameters) -> None:
        """
        Change the parameters of one bearing while running; its state is carried on.

        The inner ring's temperature is carried on as well if the mode stays physical. Parameters
        that are refused change nothing.
        """
        self._check_index(index)
        if parameters.bearing.n_balls > self._balls.shape[1]:
            msg = (
                f'{parameters.bearing.name} has {parameters.bearing.n_balls} balls, more than the '
                f'{self._balls.shape[1]} of this fleet; start a new fleet with it'
            )
            raise BearingTwinError(msg)
        _check_defects(index, parameters)
        simulator = self._simulator(index, parameters)
        self._parameters[index] = parameters
        group, lane = divmod(index, fk.L)
        sensor = self._w[group, 16:20, lane].copy()
        self._place(index, simulator)
        self._w[group, 16:20, lane] = sensor

    def extract(self, index: int) -> Simulator:
        """
        Return one bearing as a simulator: its motion, phases, temperatures and sample index.

        The filters' memory, some ms, is not carried over.
        """
        self._check_index(index)
        return self._simulator(index, self._parameters[index])

    def place(self, index: int, simulator: Simulator) -> None:
        """
        Let one bearing go on from where a simulator is; the fleet's sample index runs on.

        Raises
        ------
        BearingTwinError
            If its parameters or sample rate are not those of this bearing.

        """
        self._check_index(index)
        theirs, ours = simulator.parameters, self._parameters[index]
        if (theirs, simulator.sample_rate) != (ours, self.sample_rate):
            msg = f'a simulator of other parameters or rate cannot become bearing {index}'
            raise BearingTwinError(msg)
        inner = simulator.condition().inner_ring_temperature
        self._temperatures[index] = simulator.temperature
        self._shaft_hz[index] = simulator.shaft_hz
        moved = self._fresh(index, ours, seed=simulator.snapshot().seed)
        rings = (inner, inner) if ours.thermal_mode == 'physical' else None
        moved.adopt(simulator.snapshot().state, self.next_sample, rings)
        self._place(index, moved)
        group, lane = divmod(index, fk.L)
        self._w[group, 16:20, lane] = 0.0
        self._history[group].reshape(self._oversample, -1, fk.L)[:, :, lane] = 0.0

    def _simulator(self, index: int, parameters: TwinParameters) -> Simulator:
        """Return one bearing with these parameters; the rings' temperatures go with the mode."""
        carried = parameters.thermal_mode == 'physical' and not math.isnan(self._rings[index, 0])
        rings = (float(self._rings[index, 0]), float(self._rings[index, 1]))
        simulator = self._fresh(index, parameters, int(self._keys[divmod(index, fk.L)]))
        simulator.adopt(self._motion(index), self.next_sample, rings if carried else None)
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
        """Return the complete state of all bearings; it belongs to their parameters."""
        body = b''.join(
            part.astype(part.dtype.newbyteorder('<')).tobytes() for part in self._state()
        )
        fields = _FIELDS.pack(
            self.sample_rate, self.next_sample, len(self), self._balls.shape[1],
            identity(self._parameters),
        )  # fmt: skip
        return _MAGIC + struct.pack('<I', zlib.crc32(body, zlib.crc32(fields))) + fields + body

    def load(self, data: bytes) -> None:
        """
        Continue from a state that :meth:`save` returned.

        Raises
        ------
        BearingTwinError
            If ``data`` is damaged, of another version or of another fleet; the state is then
            unchanged.

        """
        data = bytes(data)
        head = len(_MAGIC) + 4
        if data[: len(_MAGIC)] != _MAGIC:
            msg = 'saved state is not that of a fleet of this version of bearing_twin'
            raise BearingTwinError(msg)
        if len(data) < head + _FIELDS.size or zlib.crc32(data[head:]) != int.from_bytes(
            data[len(_MAGIC) : head], 'little'
        ):
            msg = f'saved state of {len(data)} bytes is truncated or damaged; start without it'
            raise BearingTwinError(msg)
        rate, next_sample, size, n_balls, whose = _FIELDS.unpack_from(data, head)
        parts = self._state()
        body = data[head + _FIELDS.size :]
        own = (self.sample_rate, len(self), self._balls.shape[1], identity(self._parameters))
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
        motion = np.concatenate([part.ravel() for part in loaded[:4]])
        beyond = any((part > 1e20).any() for part in numbers)
        if next_sample >= 2**62 or beyond or not np.isfinite(motion).all():
            msg = 'saved state holds values that no simulation reaches; start without it'
            raise BearingTwinError(msg)
        for part, values in zip(parts, loaded, strict=True):
            part[...] = values
        self._w[:, _CARRIED] = loaded[0]
        self._phases[:, _TURNED] = loaded[1]
        self.next_sample = next_sample
        for index in range(len(self._law)):
            laws.evaluate(
                self._law[index], self._temperatures[index], self._temperatures[index],
                self._shaft_hz[index], self._values[index],
            )  # fmt: skip

    def _state(self) -> list[npt.NDArray[np.generic]]:
        """Arrays that a saved state consists of; the first two are copies."""
        return [
            self._w[:, _CARRIED], self._phases[:, _TURNED], self._history, self._drift,
            self._rings, self._temperatures, self._shaft_hz, self._keys,
        ]  # fmt: skip

    def _checked(
        self, name: str, given: npt.ArrayLike, check: Callable[[float], float]
    ) -> FloatArray:
        """One value a bearing, checked; idle lanes repeat the last one."""
        values = np.asarray(given, dtype=float)
        size = len(self._parameters)
        if values.ndim and values.shape != (size,):
            msg = f'{name} has shape {values.shape}; give one value, or one for each of {size}'
            raise BearingTwinError(msg)
        padded = np.empty(-(-size // fk.L) * fk.L)
        padded[:size] = values
        padded[size:] = padded[size - 1]
        for extreme in (padded.min(), padded.max()):  # NaN is both
            check(float(extreme))
        return padded

    def _check_index(self, index: int) -> None:
        if not 0 <= index < len(self):
            msg = f'no bearing {index} in a fleet of {len(self)}'
            raise BearingTwinError(msg)

    def _motion(self, index: int) -> FloatArray:
        """State of one bearing in the layout of `kernel`."""
        group, lane = divmod(index, fk.L)
        state = np.zeros(layout.STATE_SIZE)
        w, phases = self._w[group, :, lane], self._phases[group, :, lane]
        state[:16] = w[:16]
        since = self.next_sample % layout.CHUNK / self.sample_rate
        state[layout.CAGE : layout.SPIN + 1] = (
            phases[:3] + since * phases[fk.PHASE_ROWS : fk.PHASE_ROWS + 3]
        ) % 1.0
        angles = 2.0 * math.pi * state[[layout.CAGE, layout.SHAFT]]
        state[[layout.CAGE_COS, layout.SHAFT_COS]] = np.cos(angles)
        state[[layout.CAGE_SIN, layout.SHAFT_SIN]] = np.sin(angles)
        return state

    def _place(self, index: int, simulator: Simulator) -> None:
        """Put one bearing into its lane."""
        p = simulator.parameters
        snapshot = simulator.snapshot()
        group, lane = divmod(index, fk.L)
        spalls = snapshot.defects
        w, const, state = self._w[group, :, lane], snapshot.const, snapshot.state
        w[:16] = state[:16]
        step = 1.0 / (self.sample_rate * self._oversample)
        table = filters.resonator(p.resonance_hz, p.resonance_damping, step, 1)
        w[fk.CONSTANTS : fk.CONSTANTS + fk.CONSTANT_ROWS] = (
            1.0 / const[layout.MI], const[layout.KI], const[layout.CI], 1.0 / const[layout.MO],
            const[layout.KO], const[layout.CO], const[layout.CB], const[layout.UNBALANCE],
            *table.ravel(), p.bearing.n_balls,
        )  # fmt: skip
        w[fk.C], w[fk.S] = state[layout.CAGE_COS], state[layout.CAGE_SIN]
        w[fk.CS], w[fk.SS] = state[layout.SHAFT_COS], state[layout.SHAFT_SIN]
        n = p.bearing.n_balls
        balls = self._balls[group, :, :, lane]
        balls[:] = (0.0, 0.0, 1.0)
        balls[:n] = snapshot.balls[:3, :n].T
        phases = self._phases[group, :, lane]
        since = simulator.next_sample % layout.CHUNK / simulator.sample_rate
        hz, slip = simulator.shaft_hz, snapshot.values[laws.SLIP]
        carried = hz * (1.0 - slip)
        speeds = const[layout.FTF_ORDER] * carried, hz, const[layout.SPIN_ORDER] * carried
        phases[:3] = state[layout.CAGE : layout.SPIN + 1] - since * np.array(speeds)
        phases[fk.FTF_ORDER], phases[fk.SPIN_ORDER] = (
            const[layout.FTF_ORDER],
            const[layout.SPIN_ORDER],
        )
        phases[fk.JITTER] = const[layout.JITTER]
        self._level[group, lane] = const[layout.NOISE_STD]
        self._keys[group, lane] = snapshot.seed
        for slot in range(fk.MAX_SPALLS):
            row = spalls[slot] if slot < len(spalls) else None
            _place_spall(w, phases, slot, row, const, n)
        self._law[index], self._values[index] = snapshot.law, snapshot.values
        self._drift[index], self._rings[index] = snapshot.drift, snapshot.rings
        members = [self._parameters[min(group * fk.L + i, len(self) - 1)] for i in range(fk.L)]
        cut = [member.defects for member in members]
        self._balls_in[group] = _even(max(member.bearing.n_balls for member in members))
        self._spalls_in[group] = max(len(defects) for defects in cut)
        self._smooth_in[group] = any(
            d.profile in ('halfsine', 'smooth') for defects in cut for d in defects
        )


# Rows of the work array that are carried on: motion and sensor, and the rotated sines.
_CARRIED = np.array([*range(fk.STATE_ROWS), fk.C, fk.S, fk.CS, fk.SS])
_TURNED = np.array([0, 1, 2, fk.PHASE_ROWS, fk.PHASE_ROWS + 1, fk.PHASE_ROWS + 2])


def _check_defects(index: int, parameters: TwinParameters) -> None:
    if len(parameters.defects) > fk.MAX_SPALLS:
        msg = (
            f'bearing {index} of the fleet has {len(parameters.defects)} defects, more than '
            f'{fk.MAX_SPALLS}; merge some, or use a Simulator for it'
        )
        raise BearingTwinError(msg)


def _even(n_balls: int) -> int:
    """Balls come in twos; one that is too many is too small to touch."""
    return n_balls + n_balls % 2


def _place_spall(
    w: npt.NDArray[np.float32],
    phases: FloatArray,
    slot: int,
    row: FloatArray | None,
    const: FloatArray,
    n_balls: int,
) -> None:
    """Fill one spall of a lane; None for a slot that is not used."""
    at = fk.SPALLS + slot * fk.SPALL_ROWS
    w[at : at + fk.SPALL_ROWS] = 0.0
    w[at + fk.BALL] = -1.0
    w[at + fk.HALF] = -1.0
    w[at + fk.FIXED] = w[at + fk.ONLY] = -1.0
    angle = fk.FIRST_ANGLE + 4 * slot
    phases[angle : angle + 4] = 0.0
    if row is None:
        return
    place = row[layout.PLACE]
    on_ball = place == 2.0
    radius = const[layout.R_INNER] if place == 0.0 else const[layout.R_OUTER]
    w[at + fk.U_SCALE] = 2.0 if on_ball else n_balls
    w[at + fk.METRES] = (
        0.5 * math.pi * const[layout.D_BALL] if on_ball else 2.0 * math.pi * radius / n_balls
    )
    w[at + fk.FIXED] = row[layout.BALL] if on_ball else -1.0
    inner, outer = row[layout.PATH_INNER], row[layout.PATH_OUTER]
    w[at + fk.ONLY] = row[layout.BALL] if place == 3.0 else -1.0
    w[at + fk.EVEN] = outer if place in (1.0, 3.0) else inner
    w[at + fk.ODD] = outer
    w[at + fk.KIND] = row[layout.PROFILE]
    if row[layout.PROFILE] == 1.0:  # a rectangle is a path of endless curvature
        w[at + fk.EVEN] = w[at + fk.ODD] = 1e30
    w[at + fk.HALF], w[at + fk.FULL] = row[layout.HALF], row[layout.FULL_DEPTH]
    # Cage, shaft and spin; an outer spall and a worn pocket follow the cage alone.
    follows = {0.0: (1.0, -1.0, 0.0), 2.0: (0.0, 0.0, 1.0)}.get(place, (1.0, 0.0, 0.0))
    phases[angle : angle + 4] = row[layout.ANGLE], *follows


@compiled()
def _evaluate_changed(
    law: FloatArray,
    was_outer: FloatArray,
    was_speed: FloatArray,
    outer: FloatArray,
    speed: FloatArray,
    values: FloatArray,
) -> None:
    """Evaluate the laws where temperature or speed changed."""
    for i in range(law.shape[0]):
        if outer[i] != was_outer[i] or speed[i] != was_speed[i]:
            laws.evaluate(law[i], outer[i], outer[i], speed[i], values[i])


@compiled()
def _tick_all(
    law: Array,
    outer: Array,
    speed: Array,
    inner: Array,
    drift: Array,
    tick: int,
    seconds: float,
) -> None:
    """One thermal tick of every bearing in the physical mode; see `Simulator`."""
    apart, alike = np.empty(laws.CONDITION_SIZE), np.empty(laws.CONDITION_SIZE)
    for i in range(law.shape[0]):
        if law[i, laws.PHYSICAL] == 0.0:
            continue
        reached = laws.inner_temperature(law[i], outer[i], inner[i, 1], speed[i], seconds)
        inner[i, 0], inner[i, 1] = inner[i, 1], reached
        laws.evaluate(law[i], outer[i], reached, speed[i], apart)
        laws.evaluate(law[i], outer[i], outer[i], speed[i], alike)
        for q in range(laws.INPUTS):
            drift[i, 0, q] += drift[i, 1, q] * tick
            drift[i, 1, q] = (apart[q] - alike[q] - drift[i, 0, q]) / tick


@compiled()
def _advance_all(
    w: Array,
    balls: Array,
    balls_in: Array,
    phases: Array,
    history: Array,
    keys: Array,
    level: Array,
    ramp: Array,
    drift: Array,
    taps: Array,
    spalls_in: Array,
    smooth_in: Array,
    first: int,
    since_tick: int,
    oversample: int,
    h: float,
    out: Array,
) -> None:
    """Advance every group; arrays as in `fleet_kernel.advance_group` with the group first."""
    lanes = w.shape[2]
    inputs, drifts = np.empty((2, 6, lanes)), np.empty((2, 6, lanes))
    for g in range(w.shape[0]):
        for i in range(lanes):
            for q in range(6):
                for part in range(2):
                    inputs[part, q, i] = ramp[part, g * lanes + i, q]
                    drifts[part, q, i] = drift[g * lanes + i, part, q]
        fk.advance_group(
            w[g].reshape(-1), balls[g].reshape(-1), balls_in[g], phases[g], history[g], keys[g],
            level[g], inputs, drifts, taps, spalls_in[g], smooth_in[g], first,
            since_tick, oversample, h, out[:, g * lanes : (g + 1) * lanes],
        )  # fmt: skip
