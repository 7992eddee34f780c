# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What a running twin takes of a calibration, and how alike it and its machine are since then."""

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

if TYPE_CHECKING:
    from bearing_twin.dynamics.single.simulator import Block
    from numpy.typing import NDArray


GEOMETRY = ('n_balls', 'd_ball', 'd_pitch', 'contact_angle')
SAME = 1e-6
"""Greatest difference of two geometries or sample rates that are the same, over either."""
FARTHEST, LOUDEST = 3.0, 3.0
"""Log-spectral distance and level, dB, from which on a vibration does not pass for its machine's:
between the 0.3 to 0.6 dB of fits to healthy records and the 6 dB that are an alarm of the
diagnosis."""
COMPARED_S = 2.0
"""Length of the vibration that is compared with the machine's, s."""


@dataclass(frozen=True, kw_only=True)
class Fitted:
    """What a twin takes of a calibration."""

    text: str
    """From which :func:`read_fitted` makes it again."""
    statement: str
    geometry: tuple[float, ...]
    defects: tuple[Defect, ...]
    machine: dict[str, float]
    """Fields of `TwinParameters`."""
    path: SensorPath
    unit: str
    """Of the machine's sensor, and so of the twin's vibration; '' if unknown."""
    levels: NDArray[np.float64]
    """`band_levels` of the machine."""
    rms: float
    """Of the machine."""
    shaft_hz: float
    """At which it was measured, Hz."""
    temperature: float
    """At which it was measured, degC."""

    @property
    def defect(self) -> str:
        """The defects as the parameter of a twin gives them."""
        texts = [
            f'{each.place}:width={each.width:.3g},depth={each.depth:.3g},angle={each.angle:.3g}'
            for each in self.defects
        ]
        return '+'.join(texts) or 'none'

    def parameters(self, own: TwinParameters) -> TwinParameters:
        """
        Return a twin's parameters with what the calibration tells; the others stay.

        Defects that the twin's own parameters name have been injected: they take the place of the
        fitted ones.

        Raises
        ------
        BearingTwinError
            If the calibration is of another bearing, or a value leaves the model's validity.

        """
        geometry = tuple(getattr(own.bearing, name) for name in GEOMETRY)
        if not np.allclose(geometry, self.geometry, rtol=SAME, atol=SAME):
            numbers = ', '.join(f'{value:g}' for value in self.geometry)
            msg = (
                f'the calibration is of another bearing than {own.bearing.name} (balls, sizes in '
                f'm, angle in rad: {numbers}); fit with the bearing of this twin'
            )
            raise BearingTwinError(msg)
        given: dict[str, Any] = dict(self.machine)
        # A fit takes the load along the sensor's axis, so defects that stand still turn with it.
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
        """Refuse a calibration that a twin of these parameters and this rate cannot take."""
        steps(self.parameters(own), sample_rate)
        if abs(self.path.sample_rate / sample_rate - 1.0) > SAME:
            msg = (
                f'the calibration is of a sensor at {self.path.sample_rate:g} Hz, this twin runs '
                f'at {sample_rate:g} Hz; start it with sample_rate:={self.path.sample_rate!r}'
            )
            raise BearingTwinError(msg)
        if len(self.levels) != window_length(sample_rate) // 2 + 1:
            msg = f'the calibration has {len(self.levels)} levels of the machine; fit again'
            raise BearingTwinError(msg)


def read_fitted(text: str) -> Fitted:
    """Read what a twin takes of a calibration from what ``bearing-twin fit --json`` writes."""
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
            msg = 'levels of the machine are not numbers'
            raise ValueError(msg)
        if sorted(twin) != sorted(('defects', *FITTED)):
            msg = f'it gives {", ".join(twin)} of a twin'
            raise ValueError(msg)
        # Both are published, so what cannot be encoded is refused here.
        (kept['statement'] + unit).encode()
        fitted = Fitted(
            text=json.dumps(kept),
            statement=kept['statement'],
            geometry=tuple(float(machine['bearing'][name]) for name in GEOMETRY),
            defects=tuple(Defect(**defect) for defect in twin['defects']),
            # The twin makes the noise itself: there each sample follows from its index.
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


class Likeness(NamedTuple):
    """How alike the vibration of a twin and that of its machine are."""

    distance: float
    """Log-spectral distance, dB."""
    level: float
    """Level of the twin over the machine's, dB."""

    @property
    def far(self) -> bool:
        """Whether the one does not pass for the other."""
        return not (self.distance <= FARTHEST and abs(self.level) <= LOUDEST)


class Sensor:
    """The machine's sensor at a twin: both axes pass the path of a calibration."""

    def __init__(self, fitted: Fitted) -> None:
        self.fitted = fitted
        self._axes = fitted.path.filter(), fitted.path.filter()
        self._newest: deque[NDArray[np.float32]] = deque()

    def take(self, block: Block) -> Block:
        """Return a block of the housing as the machine's sensor would give it."""
        x, y = (
            axis.apply(samples).astype(np.float32)
            for axis, samples in zip(self._axes, (block.x, block.y), strict=True)
        )
        self._newest.append(y)
        most = COMPARED_S * self.fitted.path.sample_rate
        while sum(map(len, self._newest)) - len(self._newest[0]) >= most:
            self._newest.popleft()
        return replace(block, x=x, y=y)

    def likeness(self) -> Likeness | None:
        """Compare the newest vibration with the machine's; None until there is enough."""
        y = np.concatenate(self._newest) if self._newest else np.zeros(0)
        if len(y) < COMPARED_S * self.fitted.path.sample_rate:
            return None
        apart = distance(band_levels(y, self.fitted.path.sample_rate), self.fitted.levels)
        level = 20.0 * math.log10(max(float(y.std()), 1e-300) / max(self.fitted.rms, 1e-300))
        return Likeness(apart, level)

    def save(self) -> bytes:
        """Return what the filters remember."""
        return b''.join(axis.memory.astype('<f8').tobytes() for axis in self._axes)

    def load(self, data: bytes) -> None:
        """Let the filters go on from what :meth:`save` returned."""
        values = np.frombuffer(data, dtype='<f8') if len(data) % 8 == 0 else np.zeros(0)
        if len(values) != 2 * len(self._axes[0].memory) or not np.isfinite(values).all():
            msg = 'saved state of a sensor is invalid; start without it'
            raise BearingTwinError(msg)
        for axis, memory in zip(self._axes, np.split(values, 2), strict=True):
            axis.memory[:] = memory
