# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Apply a calibration to a running twin, and compare the twin with its machine afterwards."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
import json
import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.dynamics.equations.sensor_path import (
    band_levels,
    distance,
    SensorPath,
    window_length,
)
from bearing_twin.dynamics.equations.stability import steps
from bearing_twin.dynamics.parameters import Defect, DOWN, FITTED, TwinParameters
from bearing_twin.errors import BearingTwinError
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from bearing_twin.dynamics.single.simulator import Block


GEOMETRY = ('n_balls', 'd_ball', 'd_pitch', 'contact_angle')
SAME = 1e-6
"""Largest relative difference of geometries or sample rates that count as equal."""
FARTHEST, LOUDEST = 3.0, 3.0
"""Largest log-spectral distance and level difference, dB, at which a twin resembles its machine:
between the 0.3 to 0.6 dB of fits to healthy records and the 6 dB of a diagnosis alarm."""
COMPARED_S = 2.0
"""Length of the vibration that is compared with that of the machine, s."""


@dataclass(frozen=True, kw_only=True)
class FittedModel:
    """Parameters, sensor path and reference levels that a twin takes from a calibration."""

    text: str
    """JSON text that :func:`read_fitted_model` reads."""
    statement: str
    geometry: tuple[float, ...]
    defects: tuple[Defect, ...]
    machine: dict[str, float]
    """Fitted fields of `TwinParameters`."""
    path: SensorPath
    unit: str
    """Unit of the sensor of the machine, and so of the twin's vibration; '' if unknown."""
    levels: NDArray[np.float64]
    """`band_levels` of the machine, dB, shape (n,)."""
    rms: float
    """RMS of the vibration of the machine, in ``unit``."""
    shaft_hz: float
    """Shaft speed of the measurement, Hz."""
    temperature: float
    """Temperature of the measurement, degC."""

    @property
    def defect(self) -> str:
        """Defects as text of the twin parameter ``defect``."""
        texts = [
            f'{each.place}:width={each.width:.3g},depth={each.depth:.3g},angle={each.angle:.3g}'
            for each in self.defects
        ]
        return '+'.join(texts) or 'none'

    def parameters(self, own: TwinParameters) -> TwinParameters:
        """
        Return the parameters of a twin with the fitted values; others stay unchanged.

        Defects in the twin's own parameters have been injected. They replace the fitted ones.

        Raises
        ------
        BearingTwinError
            If the calibration belongs to another bearing, or a value is outside the validity of
            the model.

        """
        geometry = tuple(getattr(own.bearing, name) for name in GEOMETRY)
        if not np.allclose(geometry, self.geometry, rtol=SAME, atol=SAME):
            numbers = ', '.join(f'{value:g}' for value in self.geometry)
            raise BearingTwinError(
                f'the calibration is of another bearing than {own.bearing.name} (balls, sizes in '
                f'm, angle in rad: {numbers}); fit with the bearing of this twin'
            )
        given: dict[str, Any] = dict(self.machine)
        # A fit assumes the load along the sensor axis: turn stationary defects accordingly.
        turned = DOWN - own.load_angle
        injected = tuple(
            replace(each, angle=math.fmod(each.angle + turned, 2.0 * math.pi))
            if each.place in ('outer', 'cage')
            else each
            for each in own.defects
        )
        return replace(
            own,
            defects=injected or self.defects,
            load_angle=DOWN,
            slip_model='constant',
            resonance_hz=0.0,
            waviness=0.0,
            **given,
        )

    def check(self, own: TwinParameters, sample_rate: float) -> None:
        """Refuse a calibration that does not fit these parameters or this sample rate (Hz)."""
        steps(self.parameters(own), sample_rate)
        if abs(self.path.sample_rate / sample_rate - 1.0) > SAME:
            raise BearingTwinError(
                f'the calibration is of a sensor at {self.path.sample_rate:g} Hz, this twin runs '
                f'at {sample_rate:g} Hz; start it with sample_rate:={self.path.sample_rate!r}'
            )
        if len(self.levels) != window_length(sample_rate) // 2 + 1:
            msg = f'the calibration has {len(self.levels)} levels of the machine; fit again'
            raise BearingTwinError(msg)


def read_fitted_model(text: str) -> FittedModel:
    """Return the calibration in the output of ``bearing-twin fit --json``."""
    try:
        values = json.loads(text)
        machine, twin, spectrum = values['machine'], values['twin'], values['spectrum']
        kept = {
            'statement': str(values['statement']),
            'machine': {
                'bearing': {name: machine['bearing'][name] for name in GEOMETRY},
                **{name: machine[name] for name in ('unit', 'shaft_hz', 'temperature')},
            },
            'twin': twin,
            'spectrum': {name: spectrum[name] for name in ('machine_db', 'machine_rms')},
            'path': values['path'],
        }
        path = SensorPath.from_dict(values['path'])
        levels = np.array(spectrum['machine_db'], dtype=np.float64)
        rms, unit = float(spectrum['machine_rms']), str(machine['unit'])
        if levels.ndim != 1 or not (np.isfinite(levels).all() and 0.0 < rms < math.inf):
            raise ValueError('levels of the machine are not numbers')
        if sorted(twin) != sorted(('defects', *FITTED)):
            raise ValueError(f'it gives {", ".join(twin)} of a twin')
        # Both texts are published: refuse text that cannot be encoded as UTF-8.
        (kept['statement'] + unit).encode()
        fitted = FittedModel(
            text=json.dumps(kept),
            statement=kept['statement'],
            geometry=tuple(float(machine['bearing'][name]) for name in GEOMETRY),
            defects=tuple(Defect(**defect) for defect in twin['defects']),
            # The twin adds the noise, because its noise is a function of the sample index.
            machine={k: float(v) for k, v in twin.items() if k != 'defects'}
            | {'noise': path.noise},
            path=replace(path, noise=0.0),
            unit=unit,
            levels=levels,
            rms=rms,
            shaft_hz=float(machine['shaft_hz']),
            temperature=float(machine['temperature']),
        )
    except (
        KeyError, TypeError, ValueError, AttributeError, OverflowError, RecursionError
    ) as error:  # fmt: skip
        msg = f"this is no calibration ({error!r}); give what 'bearing-twin fit --json' wrote"
        raise BearingTwinError(msg) from None
    return fitted


class Similarity(NamedTuple):
    """Similarity of vibration and of the record of a machine."""

    distance: float
    """Log-spectral distance, dB."""
    level: float
    """Level relative to the record, dB."""

    @classmethod
    def of(
        cls,
        samples: NDArray[np.floating[Any]],
        sample_rate: float,
        *,
        levels: NDArray[np.float64],
        rms: float,
    ) -> Similarity:
        """Compare vibration, shape (n,), with the `band_levels` and the RMS of a record."""
        apart = distance(band_levels(samples, sample_rate), levels)
        return cls(apart, 20.0 * math.log10(max(float(samples.std()), 1e-300) / max(rms, 1e-300)))

    @property
    def dissimilar(self) -> bool:
        """Whether the vibration does not resemble the record."""
        return not (self.distance <= FARTHEST and abs(self.level) <= LOUDEST)


class Sensor:
    """The sensor of the machine on a twin: filters both axes with the fitted sensor path."""

    def __init__(self, fitted: FittedModel) -> None:
        self.fitted_model = fitted
        self._axes = fitted.path.filter(), fitted.path.filter()
        self._newest: deque[NDArray[np.float32]] = deque()

    def take(self, block: Block) -> Block:
        """Return a block of housing vibration as the sensor of the machine would measure it."""
        x, y = (
            axis.apply(samples).astype(np.float32)
            for axis, samples in zip(self._axes, (block.x, block.y), strict=True)
        )
        self._newest.append(y)
        most = COMPARED_S * self.fitted_model.path.sample_rate
        while sum(map(len, self._newest)) - len(self._newest[0]) >= most:
            self._newest.popleft()
        return replace(block, x=x, y=y)

    def similarity(self) -> Similarity | None:
        """Compare the newest vibration with the machine; return None until there is enough."""
        y = np.concatenate(self._newest) if self._newest else np.zeros(0)
        machine, rate = self.fitted_model, self.fitted_model.path.sample_rate
        if len(y) < COMPARED_S * rate:
            return None
        return Similarity.of(y, rate, levels=machine.levels, rms=machine.rms)

    def save(self) -> bytes:
        """Return the state of the filters."""
        return b''.join(axis.memory.astype('<f8').tobytes() for axis in self._axes)

    def load(self, data: bytes) -> None:
        """Restore the state of the filters from :meth:`save`."""
        values = np.frombuffer(data, dtype='<f8') if len(data) % 8 == 0 else np.zeros(0)
        if len(values) != 2 * len(self._axes[0].memory) or not np.isfinite(values).all():
            raise BearingTwinError('saved state of a sensor is invalid; start without it')
        for axis, memory in zip(self._axes, np.split(values, 2), strict=True):
            axis.memory[:] = memory
