# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One bearing as it is drawn: the topics of one namespace."""

from __future__ import annotations

import math
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing.catalogue import find_bearing
from bearing_twin.bearing.geometry import fault_orders
from bearing_twin.errors import BearingTwinError
from bearing_twin.stamps import NANO, samples_ns
from bearing_twin.view.rerun.canvas import Canvas
from bearing_twin.view.rerun.generic import draw_anything
from bearing_twin.view.rerun.lanes import Lane
from bearing_twin.view.rerun.spectra import SpectrumBars
from bearing_twin.view.rerun.temperature import TemperaturePicture
from bearing_twin.view.rerun.twinstate import TwinPicture
from bearing_twin.view.rerun.verdict import VerdictPicture
from bearing_twin.view.rerun.waveform import Waveform
from bearing_twin.view.style import LANE_LEVELS
import rerun as rr

if TYPE_CHECKING:
    from collections.abc import Callable

    from bearing_twin.bearing.geometry import Bearing
    from bearing_twin.view.rerun.canvas import Emit
    from bearing_twin.view.timebase import Timebase

__all__ = ['KINDS', 'Scene', 'namespace_of']

KINDS = {
    'bearing_twin_msgs/msg/Vibration': 'vibration',
    'bearing_twin_msgs/msg/TwinState': 'twin_state',
    'bearing_twin_msgs/msg/Diagnosis': 'diagnosis',
    'bearing_twin_msgs/msg/Spectrum': 'spectrum',
    'bearing_twin_msgs/msg/Checkpoint': 'checkpoint',
    'sensor_msgs/msg/Temperature': 'temperature',
    'diagnostic_msgs/msg/DiagnosticArray': 'diagnostics',
    'rcl_interfaces/msg/Log': 'log',
    'std_msgs/msg/String': 'text',
}
"""Kind of picture by message type; every other type is drawn as numbers and arrays."""

SILENT = frozenset(
    {
        'rcl_interfaces/msg/ParameterEvent',
        'lifecycle_msgs/msg/TransitionEvent',
        'rosgraph_msgs/msg/Clock',
        'tf2_msgs/msg/TFMessage',
    }
)
"""Types that say nothing to the eye."""

ENVELOPE = 'squared_envelope_spectrum'

LOG_LEVELS = {10: 'DEBUG', 20: 'INFO', 30: 'WARN', 40: 'ERROR', 50: 'CRITICAL'}


def namespace_of(topic: str) -> tuple[str, str]:
    """Split a topic into the namespace ('' at the top) and its name."""
    namespace, _, name = topic.rstrip('/').rpartition('/')
    return namespace.rstrip('/'), name or 'topic'


class Scene:
    """Draw the topics of one namespace."""

    def __init__(
        self,
        emit: Emit,
        root: str,
        timebase: Timebase,
        *,
        bearing: Bearing | None,
        full: bool,
    ) -> None:
        self.root = root
        self.contents: dict[str, str] = {}
        """Kind of picture by the name of its topic; grows as topics appear."""
        self._canvas = Canvas(emit, root, timebase)
        self._timebase = timebase
        self._bearing = bearing
        self._full = full
        self._pictures: dict[str, Any] = {}
        self._lanes: dict[str, Lane] = {}
        self._temperature = math.nan

    def draw(self, name: str, type_name: str, message: Any, received: int) -> None:
        """Draw a message of a topic; ``received`` in ns."""
        if type_name in SILENT:
            return
        kind = KINDS.get(type_name, 'numbers')
        time = self._timebase.of(message, received)
        drawn = getattr(self, f'_draw_{kind}')(name, message, time)
        if drawn != '':
            self.contents.setdefault(name, drawn or kind)

    def flush(self, complain: Callable[[str, Exception], None], *, slow: bool) -> None:
        """
        Send what is held; never raises.

        Parameters
        ----------
        complain
            Called with a topic and the reason where something cannot be drawn.
        slow
            Whether to send the slow lines too.

        """
        for name, picture in self._pictures.items():
            if isinstance(picture, (TemperaturePicture, TwinPicture, Waveform)):
                try:
                    picture.flush(slow=slow)
                except Exception as error:
                    complain(f'{self.root}/{name}', error)
        try:
            self._canvas.flush(slow=slow)
        except Exception as error:
            complain(self.root, error)

    def _draw_vibration(self, name: str, message: Any, time: int) -> None:
        picture = self._pictures.get(name)
        if picture is None:
            picture = self._pictures[name] = Waveform(self._canvas, name, full=self._full)
        picture.temperature = self._temperature
        picture.draw(message, time)

    def _draw_twin_state(self, name: str, message: Any, time: int) -> None:
        picture = self._pictures.get(name)
        if picture is None:
            picture = self._pictures[name] = TwinPicture(self._canvas, name, self._bearing)
        self._temperature = float(message.temperature_used)
        picture.draw(message, time)

    def _draw_diagnosis(self, name: str, message: Any, time: int) -> None:
        picture = self._pictures.get(name)
        if picture is None:
            picture = self._pictures[name] = VerdictPicture(self._canvas, name)
        # The stamp is that of the window's first sample; what it says is known at its end.
        if message.sample_rate > 0.0:
            time += samples_ns(message.sample_count, message.sample_rate)
        picture.draw(message, time)

    def _draw_spectrum(self, name: str, message: Any, time: int) -> str:
        picture = self._pictures.get(name)
        if picture is None:
            picture = self._pictures[name] = SpectrumBars(self._canvas, name)
        if message.bin_hz > 0.0:
            time += round(NANO / message.bin_hz)
        picture.draw(message, time)
        return 'envelope_spectrum' if message.kind == ENVELOPE else 'spectrum'

    def _draw_temperature(self, name: str, message: Any, time: int) -> str:
        value = float(message.temperature)
        if not math.isfinite(value):
            return ''
        if not any(isinstance(p, TwinPicture) for p in self._pictures.values()):
            self._temperature = value
        picture = self._pictures.get(name)
        if picture is None:
            picture = self._pictures[name] = TemperaturePicture(self._canvas, name)
        picture.draw(value, float(message.variance), time)
        return 'temperature'

    def _draw_checkpoint(self, name: str, message: Any, time: int) -> None:
        lines = [f'### {message.node}: {message.kind}, bearing_twin {message.version}', '']
        rows = [row.partition(':') for row in str(message.configuration).splitlines()]
        values = {key.strip(): value.strip().strip("'") for key, _, value in rows}
        lines += _bearing_lines(values.get('bearing', ''))
        cells = [f'| {key} | {value} ' for key, value in values.items() if value] + ['| | ']
        lines += ['', '| parameter | value | parameter | value |', '|---|---|---|---|']
        lines += [f'{a}{b}|' for a, b in zip(cells[::2], cells[1::2], strict=False)]
        self._canvas.put(
            f'{name}/parameters',
            time,
            rr.TextDocument('\n'.join(lines), media_type=rr.MediaType.MARKDOWN),
        )

    def _draw_diagnostics(self, name: str, message: Any, time: int) -> None:
        for status in message.status:
            key = f'{name}/{_entity(status.name)}'
            lane = self._lanes.get(key)
            if lane is None:
                lane = self._lanes[key] = Lane(self._canvas, key, LANE_LEVELS)
            level = status.level
            lane.set(level[0] if isinstance(level, bytes) else int(level), time)

    def _draw_log(self, name: str, message: Any, time: int) -> None:
        self._canvas.put(
            f'{name}/{_entity(message.name)}',
            time,
            rr.TextLog(str(message.msg), level=LOG_LEVELS.get(int(message.level), 'INFO')),
        )

    def _draw_text(self, name: str, message: Any, time: int) -> None:
        self._canvas.put(f'{name}/text', time, rr.TextLog(str(message.data)))

    def _draw_numbers(self, name: str, message: Any, time: int) -> str:
        return draw_anything(self._canvas, name, message, time)


def _entity(text: str) -> str:
    """Return a part of an entity path that stands for any text."""
    kept = ''.join(c if c.isalnum() or c in '-_.' else '_' for c in text.strip())
    return '_'.join(filter(None, kept.split('_'))) or 'unnamed'


def _bearing_lines(name: str) -> list[str]:
    """Return what is known about a bearing of the catalogue, Markdown."""
    try:
        bearing = find_bearing(name)
    except BearingTwinError:
        return []
    orders = fault_orders(bearing)
    return [
        f'Bearing **{bearing.name}**: {bearing.n_balls} balls of {1e3 * bearing.d_ball:g} mm on '
        f'{1e3 * bearing.d_pitch:g} mm, contact angle {math.degrees(bearing.contact_angle):g}°. '
        f'Orders without slip: BPFO {orders.bpfo:.3f}, BPFI {orders.bpfi:.3f}, '
        f'BSF {orders.bsf:.3f}, FTF {orders.ftf:.4f}.'
    ]
