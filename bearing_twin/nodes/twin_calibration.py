# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Apply calibrations to a running twin, from a file or the topic of the calibration node."""

from __future__ import annotations

from collections.abc import Mapping
import math
import os
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.calibration.fitted import read_fitted_model
from bearing_twin.errors import BearingTwinError
from bearing_twin.quantity import signed
from bearing_twin.ros.health import Level, Status
from bearing_twin.ros.topics.qos import RESULT
from bearing_twin.ros.topics.subscribing import subscribe
from bearing_twin.streams.statefile import StateFolder
from bearing_twin_msgs.msg import Calibration

if TYPE_CHECKING:
    from bearing_twin.assets.calibration.fitted import FittedModel
    from bearing_twin.assets.twin import Twin
    from bearing_twin.ros.health import Health
    from bearing_twin.ros.lifecycle import ManagedNode


def named_model(values: Mapping[str, Any]) -> FittedModel | None:
    """Return the calibration that the parameters name; None if they name none."""
    if not values['calibration']:
        return None
    file = StateFolder(values['state_directory']).load(values['calibration'])
    return read_fitted_model(file.decode(errors='replace'))


class TwinCalibration:
    """Apply calibrations to a twin, and report how similar it is to its machine."""

    def __init__(
        self, node: ManagedNode, twin: Twin, values: Mapping[str, Any], health: Health
    ) -> None:
        self._node, self._twin, self._health = node, twin, health
        self._name, self._text, self._problem = '', '', ''
        # Whether the newest calibration came from the topic.
        self._heard = False
        self._topic = (
            subscribe(node, Calibration, 'calibration', self._on_calibration, RESULT)
            if values['follow_calibration']
            else None
        )
        self.apply(values)

    def apply(self, values: Mapping[str, Any]) -> None:
        """Apply the calibration that changed parameters name."""
        if values['calibration'] or values['follow_calibration']:
            self._health.add('calibration', self.status)
        differs, fitted = self.requested_model(values)
        if differs:
            self._twin.take(fitted)
            self._name, self._text = values['calibration'], fitted.text if fitted else ''
            self._problem, self._heard = '', False

    def requested_model(self, values: Mapping[str, Any]) -> tuple[bool, FittedModel | None]:
        """
        Return whether the parameters name a new calibration, by name or content, and this one.

        A file that was removed or became unreachable after it was read is not a new calibration.
        """
        name = values['calibration']
        same = name == self._name
        folder = StateFolder(values['state_directory'])
        # Not Path.exists, which raises if a disk does not answer.
        if same and name and not os.path.lexists(folder.path(name)):
            return False, None
        fitted = named_model(values)
        return not same or (fitted is not None and fitted.text != self._text), fitted

    def _on_calibration(self, message: Calibration, _: object) -> None:
        try:
            self._twin.take(read_fitted_model(message.json))
        except BearingTwinError as error:
            self._problem = str(error)
            self._node.get_logger().warning(f'not taken: {error}', throttle_duration_sec=60.0)
        else:
            self._problem, self._heard = '', True

    def _published(self) -> bool:
        topic = self._topic
        return topic is not None and self._node.count_publishers(topic.topic_name) > 0

    def status(self) -> Status:
        """Return the status for /diagnostics: the calibration, and the similarity since then."""
        sensor = self._twin.sensor
        fitted, similarity = (sensor.fitted_model, sensor.similarity()) if sensor else (None, None)
        values: dict[str, object] = {
            'statement': fitted.statement if fitted else '',
            'machine_shaft_hz': fitted.shaft_hz if fitted else math.nan,
            'machine_temperature_degc': fitted.temperature if fitted else math.nan,
            'distance_db': similarity.distance if similarity else math.nan,
            'level_over_machine_db': similarity.level if similarity else math.nan,
        }
        if self._problem:
            return Status(Level.WARN, f'calibration not taken: {self._problem}', values)
        if fitted is None:
            # follow_calibration may be set although no calibration node is running.
            waits = self._published()
            text = 'no calibration yet' if waits else 'runs by its own parameters'
            return Status(Level.STALE if waits else Level.OK, text, values)
        if self._heard and not self._published():
            text = f'no node publishes calibrations any more; the last one: {fitted.statement}'
            return Status(Level.STALE, text, values, kind='left')
        if similarity is None:
            return Status(Level.OK, f'taken: {fitted.statement}', values, kind='taken')
        text = (
            f'{signed(similarity.level)} dB over the machine, log-spectral distance '
            f'{similarity.distance:.1f} dB; {fitted.statement}'
        )
        return Status(
            Level.WARN if similarity.dissimilar else Level.OK, text, values, kind='compared'
        )
