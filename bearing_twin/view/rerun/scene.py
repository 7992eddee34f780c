# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Scene of one bearing: the topics of one namespace, each with a picture."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TYPE_CHECKING

from bearing_twin.recording import topics
from bearing_twin.view.rerun.canvas import Canvas
from bearing_twin.view.rerun.pictures.calibration import CalibrationPicture
from bearing_twin.view.rerun.pictures.generic import AnyPicture
from bearing_twin.view.rerun.pictures.lanes import HealthPicture
from bearing_twin.view.rerun.pictures.spectra import SpectrumBars
from bearing_twin.view.rerun.pictures.temperature import TemperaturePicture
from bearing_twin.view.rerun.pictures.texts import CheckpointPicture, LogPicture, TextPicture
from bearing_twin.view.rerun.pictures.twinstate import TwinPicture
from bearing_twin.view.rerun.pictures.verdict import VerdictPicture
from bearing_twin.view.rerun.pictures.waveform import Waveform

if TYPE_CHECKING:
    from bearing_twin.view.rerun.canvas import Emit
    from bearing_twin.view.rerun.pictures.picture import Asset, Picture
    from bearing_twin.view.rerun.timebase import Timebase


PICTURES: dict[str, type[Picture]] = {
    topics.VIBRATION: Waveform,
    topics.TWIN_STATE: TwinPicture,
    topics.DIAGNOSIS: VerdictPicture,
    topics.SPECTRUM: SpectrumBars,
    topics.CALIBRATION: CalibrationPicture,
    topics.CHECKPOINT: CheckpointPicture,
    topics.TEMPERATURE: TemperaturePicture,
    topics.DIAGNOSTICS: HealthPicture,
    topics.LOG: LogPicture,
    topics.TEXT: TextPicture,
}
"""Picture by message type; every other type is drawn as numbers and arrays."""

SILENT = frozenset(
    {
        'rcl_interfaces/msg/ParameterEvent',
        'lifecycle_msgs/msg/TransitionEvent',
        'rosgraph_msgs/msg/Clock',
        'tf2_msgs/msg/TFMessage',
    }
)
"""Message types that are not drawn."""


def namespace_of(topic: str) -> tuple[str, str]:
    """Split a topic into the namespace ('' at the top) and its name."""
    namespace, _, name = topic.rstrip('/').rpartition('/')
    return namespace.rstrip('/'), name or 'topic'


class Scene:
    """Draw the topics of one namespace."""

    def __init__(self, emit: Emit, root: str, timebase: Timebase, asset: Asset) -> None:
        self.root = root
        self.contents: dict[str, str] = {}
        """Kind of picture by the name of its topic; grows as topics appear."""
        self._emit = emit
        self._timebase = timebase
        self.asset = asset
        self._pictures: dict[tuple[str, str], Picture] = {}
        self._sensor: Waveform | None = None

    def draw(self, name: str, type_name: str, message: Any, received: int) -> None:
        """Draw a message of a topic; ``received`` in ns."""
        picture = self._pictures.get((name, type_name))
        if picture is None:
            canvas = Canvas(self._emit, f'{self.root}/{name}', self._timebase)
            picture = PICTURES.get(type_name, AnyPicture)(canvas, self.asset)
            self._pictures[name, type_name] = picture
            if isinstance(picture, Waveform):
                self._tell_apart(picture, name)
        self.asset.received = received
        if picture.draw(message, self._timebase.of(message, received)):
            self.contents.setdefault(name, picture.kind)

    def _tell_apart(self, sensor: Waveform, name: str) -> None:
        """
        Keep the data of a second vibration sensor apart from the verdict.

        The verdict is about the topic ``vibration``, or else the first one, and not about a twin
        beside it.
        """
        if self._sensor is None:
            self._sensor = sensor
        elif name == 'vibration':
            self._sensor.detach_from_verdict()
            self.asset.source.forget_vibration()
            self.asset.over_temperature.forget()
            self._sensor = sensor
        else:
            sensor.detach_from_verdict()

    def flush(
        self, complain: Callable[[str, Exception], None], *, slow: bool, last: bool = False
    ) -> None:
        """
        Send what is held, with ``slow`` the slow lines too; never raise.

        ``complain`` is called with the topic and the error if something cannot be drawn. ``last``:
        the recording ends.
        """
        for (name, _), picture in self._pictures.items():
            try:
                picture.flush(slow=slow)
                if last:
                    picture.finish()
                    picture.canvas.flush(slow=True)
            except Exception as error:
                complain(f'{self.root}/{name}', error)
