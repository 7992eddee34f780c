# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The twin of one bearing: its state is carried from block to block, never reset."""

from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from bearing_twin.bearing import fault_frequencies, fault_orders
from bearing_twin.dynamics import filters, kernel
from bearing_twin.dynamics.conditions import Material, material
from bearing_twin.dynamics.parameters import PLACES, PROFILES, TwinParameters
from bearing_twin.dynamics.statics import equilibrium
from bearing_twin.errors import BearingTwinError
from bearing_twin.thermal.gcr15 import check_temperature

__all__ = ['Block', 'Condition', 'Simulator', 'warm_up']

FloatArray = npt.NDArray[np.float64]

_MAX_SHAFT_HZ = 500.0
_MAX_BLOCK = 1 << 24
_HEADER = struct.Struct('<8sIdQqddH')
_MAGIC = b'BTwin\x00\x01\x00'
_TWO_PI = 2.0 * math.pi


@dataclass(frozen=True, kw_only=True)
class Condition(Material):
    """State of the twin at the end of a block; NaN where the thermal mode has no such value."""

    c_d: float
    """Greatest defect depth in use, the paper's C_d, m; 0 without a defect."""
    shaft_hz: float
    """Shaft speed, Hz."""
    bpfo: float
    """Expected ball pass frequency, outer race, slip included, Hz."""
    bpfi: float
    """Expected ball pass frequency, inner race, slip included, Hz."""
    bsf: float
    """Expected ball spin frequency, slip included, Hz."""
    ftf: float
    """Expected cage frequency, slip included, Hz."""
    shaft_angle: float
    """rad, 0 to 2 pi, from +x."""
    cage_angle: float
    """rad, 0 to 2 pi, position of ball 0 from +x."""
    ball_angle: float
    """rad, 0 to 2 pi, spin of the balls."""
    inner_x: float
    """Displacement of the inner ring against the outer ring, m."""
    inner_y: float
    """m."""
    ball_force: npt.NDArray[np.float32]
    """Contact force of each ball, N."""


@dataclass(frozen=True, kw_only=True)
class Block:
    """Housing acceleration as an accelerometer sees it."""

    first_sample: int
    """Running index of ``x[0]``."""
    x: npt.NDArray[np.float32]
    """Horizontal, m/s^2."""
    y: npt.NDArray[np.float32]
    """Vertical, m/s^2; the load acts along -y."""
    condition: Condition
    """State at the end of the block."""


class Simulator:
    """Advances the equations of motion of one bearing and carries their state.

    The equations run at 51.2 kHz or above with the classical Runge-Kutta method of order 4; the
    sensor's resonance is applied there, then the signal is decimated. The decimator delays the
    signal by `delay` against the condition.

    Inputs are ramped linearly over the block in which they are commanded, so that stiffness and
    defect depth follow the temperature without a step. With held inputs, splitting a block or
    saving and loading in between changes no bit.

    Parameters
    ----------
    parameters
        The bearing, its faults and its surroundings.
    sample_rate
        Output rate, Hz, 2000 to 204800.
    seed
        Seed of jitter and noise, 0 to 2^32 - 1.
    temperature
        Temperature at the start, degC, 20 to 110.
    shaft_hz
        Shaft speed at the start, Hz, 0 to 500.
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
        if not 2000.0 <= sample_rate <= 204800.0:
            msg = f'sample_rate={sample_rate} is outside 2000..204800 Hz'
            raise BearingTwinError(msg)
        self.sample_rate = float(sample_rate)
        self._oversample = filters.oversampling(sample_rate)
        self._taps = filters.decimator(self._oversample)
        self._start = (check_temperature(float(temperature)), _check_speed(shaft_hz))
        self._configure(parameters)
        self.reset(seed)

    @property
    def parameters(self) -> TwinParameters:
        """Parameters in force."""
        return self._parameters

    @property
    def delay(self) -> float:
        """Delay of the published signal against the condition, s."""
        return (len(self._taps) - 1) / 2.0 / self._oversample / self.sample_rate

    def reset(self, seed: int | None = None) -> None:
        """Start again at sample 0, at rest in static equilibrium; keep the seed if None."""
        if seed is not None:
            if not 0 <= seed < 2**32:
                msg = f'seed={seed} is outside 0..4294967295'
                raise BearingTwinError(msg)
            self._seed = int(seed)
        self.next_sample = 0
        self._temperature, self._shaft_hz = self._start
        self._material = material(self._parameters, self._temperature)
        self._history = np.zeros((2, len(self._taps) - self._oversample))
        self._state = np.zeros(kernel.STATE_SIZE)
        p, m = self._parameters, self._material
        angle = p.start_angle
        self._state[kernel.CAGE] = self._state[kernel.SHAFT] = angle / _TWO_PI % 1.0
        compliance = 1.0 / p.inner_stiffness + 1.0 / p.outer_stiffness
        _, _, fx, fy = equilibrium(
            angle, m.spring_position, m.k_b, m.radial_clearance, compliance,
            p.bearing.n_balls, 0.0, m.spring_position,
        )  # fmt: skip
        self._state[kernel.Q : kernel.Q + 4] = (
            -fx / p.inner_stiffness,
            m.spring_position - fy / p.inner_stiffness,
            fx / p.outer_stiffness,
            fy / p.outer_stiffness,
        )

    def reconfigure(self, parameters: TwinParameters) -> None:
        """Change defects, preset or thermal mode while running; the state is carried on.

        The new parameters act from the next sample on: stiffness, clearance and slip are not
        ramped, since a fault that is injected is there at once.
        """
        self._configure(parameters)
        self._material = material(parameters, self._temperature)

    def advance(self, n: int, temperature: float, shaft_hz: float) -> Block:
        """Advance by ``n`` samples while temperature and speed go to the values given.

        Parameters
        ----------
        n
            Samples, 1 to 2^24.
        temperature
            Temperature at the end of the block, degC, 20 to 110.
        shaft_hz
            Shaft speed at the end of the block, Hz, 0 to 500.

        Raises
        ------
        BearingTwinError
            If a value is out of its range; the state is then unchanged.
        """
        if not 1 <= n <= _MAX_BLOCK:
            msg = f'block of {n} samples is outside 1..{_MAX_BLOCK}'
            raise BearingTwinError(msg)
        temperature = check_temperature(float(temperature))
        shaft_hz = _check_speed(shaft_hz)
        target = self._material
        if temperature != self._temperature:
            target = material(self._parameters, temperature)
        ramp = np.array(
            [_inputs(self._material, self._shaft_hz), _inputs(target, shaft_hz)], dtype=float
        )
        out = np.empty((2, n), dtype=np.float32)
        kernel.advance(
            self._state, self._history, self._const, self._defects, self._balls, ramp,
            self._resonator, self._taps, self._parameters.bearing.n_balls, self._seed,
            self.next_sample, self._oversample, out,
        )  # fmt: skip
        first = self.next_sample
        self.next_sample += n
        self._temperature, self._shaft_hz, self._material = temperature, shaft_hz, target
        return Block(first_sample=first, x=out[0], y=out[1], condition=self.condition())

    def condition(self) -> Condition:
        """State at the next sample."""
        p, m, s = self._parameters, self._material, self._state
        frequencies = fault_frequencies(p.bearing, self._shaft_hz, m.slip)
        forces = kernel.ball_forces(
            s, self._const, self._defects, self._balls,
            np.array(_inputs(m, self._shaft_hz)), p.bearing.n_balls,
        )  # fmt: skip
        return Condition(
            **vars(m),
            c_d=m.beta0 * max((defect.depth for defect in p.defects), default=0.0),
            shaft_hz=self._shaft_hz,
            **frequencies._asdict(),
            shaft_angle=float(s[kernel.SHAFT] * _TWO_PI),
            cage_angle=float(s[kernel.CAGE] * _TWO_PI),
            ball_angle=float(s[kernel.SPIN] * _TWO_PI),
            inner_x=float(s[0] - s[2]),
            inner_y=float(s[1] - s[3]),
            ball_force=forces,
        )

    def save(self) -> bytes:
        """Return the complete state: motion, phases, filters, sample index, seed and inputs.

        It belongs to the parameters and the sample rate in force, which it does not hold.
        """
        body = np.concatenate([self._state, self._history.ravel()]).astype('<f8').tobytes()
        head = _HEADER.pack(
            _MAGIC, zlib.crc32(body), self.sample_rate, self._seed, self.next_sample,
            self._temperature, self._shaft_hz, self._parameters.bearing.n_balls,
        )  # fmt: skip
        return head + body

    def load(self, data: bytes) -> None:
        """Continue from a state that :meth:`save` returned.

        Raises
        ------
        BearingTwinError
            If ``data`` is damaged, of another version, or of another sample rate or number of
            balls; the state is then unchanged.
        """
        size = _HEADER.size + 8 * (self._state.size + self._history.size)
        if data[: len(_MAGIC)] != _MAGIC:
            msg = 'saved state is not of this version of bearing_twin; start without it'
            raise BearingTwinError(msg)
        if len(data) < _HEADER.size:
            msg = f'saved state has {len(data)} bytes, fewer than its header; it is truncated'
            raise BearingTwinError(msg)
        _, crc, rate, seed, next_sample, temperature, shaft_hz, n_balls = _HEADER.unpack_from(data)
        own = (self.sample_rate, self._parameters.bearing.n_balls)
        if (rate, n_balls) != own:
            msg = (
                f'saved state is for {n_balls} balls at {rate} Hz, the simulator for {own[1]} at '
                f'{own[0]} Hz; load it with its own configuration'
            )
            raise BearingTwinError(msg)
        body = data[_HEADER.size :]
        if len(data) != size or zlib.crc32(body) != crc:
            msg = f'saved state of {len(data)} bytes is damaged (expected {size} and its checksum)'
            raise BearingTwinError(msg)
        values = np.frombuffer(body, dtype='<f8').astype(float)
        phases = values[kernel.CAGE : kernel.SPIN + 1]
        bounded = np.isfinite(values).all() and np.abs(values).max() < 1e9
        if not (bounded and (phases >= 0.0).all() and (phases <= 1.0).all()):
            msg = 'saved state holds values that no simulation reaches; start without it'
            raise BearingTwinError(msg)
        if not (0 <= next_sample < 2**62 and seed < 2**32):
            msg = f'saved state holds sample index {next_sample}, seed {seed}: out of range'
            raise BearingTwinError(msg)
        target = material(self._parameters, check_temperature(temperature))
        self._shaft_hz = _check_speed(shaft_hz)
        self._temperature, self._material = temperature, target
        self._seed, self.next_sample = seed, next_sample
        self._state = values[: self._state.size].copy()
        self._history = values[self._state.size :].reshape(self._history.shape).copy()

    def _configure(self, parameters: TwinParameters) -> None:
        p = parameters
        step = 1.0 / (self.sample_rate * self._oversample)
        self._parameters = p
        self._resonator = filters.resonator(p.resonance_hz, p.resonance_damping, step)
        self._const = _constants(p, step, self.sample_rate)
        self._defects = _defect_table(p)
        self._balls = _ball_table(p)


def warm_up() -> None:
    """Compile, or load from the cache, everything that a running simulator calls."""
    from bearing_twin.dynamics.presets import preset

    Simulator(preset('incipient')).advance(16, 20.0, 25.4)


def _check_speed(shaft_hz: float) -> float:
    if not 0.0 <= shaft_hz <= _MAX_SHAFT_HZ:
        msg = f'shaft_hz={shaft_hz} is outside 0..{_MAX_SHAFT_HZ:g} Hz'
        raise BearingTwinError(msg)
    return float(shaft_hz)


def _inputs(m: Material, shaft_hz: float) -> tuple[float, ...]:
    return (m.k_b, m.beta0, m.radial_clearance, shaft_hz, m.slip, m.spring_position)


def _constants(p: TwinParameters, step: float, sample_rate: float) -> FloatArray:
    orders = fault_orders(p.bearing)
    jitter = (
        p.jitter / p.bearing.n_balls * math.sqrt(orders.bpfi * sample_rate / kernel.WALK_EVERY)
    )
    const = np.zeros(kernel.CONST_SIZE)
    const[kernel.MI], const[kernel.KI] = p.inner_mass, p.inner_stiffness
    const[kernel.CI], const[kernel.MO] = p.inner_damping, p.outer_mass
    const[kernel.KO], const[kernel.CO] = p.outer_stiffness, p.outer_damping
    const[kernel.CB], const[kernel.UNBALANCE] = p.contact_damping, p.unbalance
    const[kernel.FTF_ORDER], const[kernel.SPIN_ORDER] = orders.ftf, orders.bsf
    const[kernel.JITTER], const[kernel.NOISE_STD] = jitter, p.noise
    const[kernel.STEP], const[kernel.D_BALL] = step, p.bearing.d_ball
    const[kernel.R_INNER] = 0.5 * (p.bearing.d_pitch - p.bearing.d_ball)
    const[kernel.R_OUTER] = 0.5 * (p.bearing.d_pitch + p.bearing.d_ball)
    return const


def _defect_table(p: TwinParameters) -> FloatArray:
    d, pitch = p.bearing.d_ball, p.bearing.d_pitch
    table = np.zeros((len(p.defects), kernel.DEFECT_SIZE))
    for row, defect in zip(table, p.defects, strict=True):
        row[kernel.PLACE] = PLACES.index(defect.place)
        row[kernel.PROFILE] = PROFILES.index(defect.profile)
        row[kernel.HALF], row[kernel.FULL_DEPTH] = 0.5 * defect.width, defect.depth
        row[kernel.ANGLE], row[kernel.BALL] = defect.angle / _TWO_PI, defect.ball
        row[kernel.PATH_INNER] = 1.0 / d + 1.0 / (pitch - d)
        row[kernel.PATH_OUTER] = 1.0 / d - 1.0 / (pitch + d)
    return table


def _ball_table(p: TwinParameters) -> FloatArray:
    """Rows: cos and sin of each ball in the cage, its undersize (m), its displacement (turns)."""
    n = p.bearing.n_balls
    table = np.zeros((4, -(-n // kernel.LANES) * kernel.LANES))
    table[2, n:] = 1.0  # a gap of one metre: the padding never touches
    table[3, :n] = np.arange(n) / n
    shift = np.zeros(n)
    for defect in p.defects:
        if defect.place == 'cage':
            table[2, defect.ball] += defect.depth
            shift[defect.ball] += defect.width / (math.pi * p.bearing.d_pitch)
    angle = _TWO_PI * (table[3, :n] + shift)
    table[0, :n], table[1, :n] = np.cos(angle), np.sin(angle)
    table[3, :n] = shift
    return table
