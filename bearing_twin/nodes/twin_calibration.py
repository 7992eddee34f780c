# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A running twin takes calibrations: from a file, or from the topic of the calibration node."""

from __future__ import annotations

import os
from typing import Any, TYPE_CHECKING

from bearing_twin.assets.calibration.fitted import read_fitted
from bearing_twin.errors import BearingTwinError
from bearing_twin.ros.health import Level, Status
from bearing_twin.ros.topics.qos import RESULT
from bearing_twin.ros.topics.subscribing import subscribe
from bearing_twin.streams.statefile import StateFolder
from bearing_twin_msgs.msg import Calibration

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bearing_twin.assets.calibration.fitted import Fitted
    from bearing_twin.assets.twin import Twin
    from bearing_twin.ros.health import Health
    from bearing_twin.ros.lifecycle import ManagedNode


def named(values: Mapping[str, Any]) -> Fitted | None:
    """
    Return the calibration that the parameters name; None if they name none.

    Raises
    ------
    BearingTwinError
        If the file cannot be read, or is no calibration.

    """
    if not values['calibration']:
        return None
    file = StateFolder(values['state_directory']).load(values['calibration'])
    return read_fitted(file.decode(errors='replace'))


class TwinCalibration:
    """Hand a twin its calibrations, and say how alike it and its machine are."""

    def __init__(
        self, node: ManagedNode, twin: Twin, values: Mapping[str, Any], health: Health
    ) -> None:
        self._node, self._twin, self._health = node, twin, health
        self._name, self._text, self._problem = '', '', ''
        # Whether the newest calibration came by the topic.
        self._heard = False
        self._topic = (
            subscribe(node, Calibration, 'calibration', self._on_calibration, RESULT)
            if values['follow_calibration']
            else None
        )
        self.apply(values)

    def apply(self, values: Mapping[str, Any]) -> None:
        """Take the calibration that changed parameters name."""
        if values['calibration'] or values['follow_calibration']:
            self._health.add('calibration', self.status)
        differs, fitted = self.asked(values)
        if differs:
            self._twin.take(fitted)
            self._name, self._text = values['calibration'], fitted.text if fitted else ''
            self._heard = False

    def asked(self, values: Mapping[str, Any]) -> tuple[bool, Fitted | None]:
        """
        Whether the parameters name another calibration than before, by name or content; and it.

        A file that has gone, or is out of reach, since it was read is no other one.
        """
        name = values['calibration']
        same = name == self._name
        folder = StateFolder(values['state_directory'])
        # Not Path.exists: it raises where a disk does not answer.
        if same and name and not os.path.lexists(folder.path(name)):
            return False, None
        fitted = named(values)
        return not same or (fitted is not None and fitted.text != self._text), fitted

    def _on_calibration(self, message: Calibration, _: object) -> None:
        try:
            self._twin.take(read_fitted(message.json))
        except BearingTwinError as error:
            self._problem = str(error)
            self._node.get_logger().warning(f'not taken: {error}', throttle_duration_sec=60.0)
        else:
            self._problem, self._heard = '', True

    def _published(self) -> bool:
        topic = self._topic
        return topic is not None and self._node.count_publishers(topic.topic_name) > 0

    def status(self) -> Status:
        """Status for /diagnostics: what the twin has taken, and how alike it is since then."""
        sensor = self._twin.sensor
        if self._problem:
            return Status(Level.WARN, f'calibration not taken: {self._problem}', {})
        if sensor is None:
            # A twin may follow in case the calibration node is started beside it.
            waits = self._published()
            text = 'no calibration yet' if waits else 'runs by its own parameters'
            return Status(Level.STALE if waits else Level.OK, text, {})
        fitted, alike = sensor.fitted, sensor.likeness()
        values: dict[str, object] = {
            'statement': fitted.statement,
            'machine_shaft_hz': fitted.shaft_hz,
            'machine_temperature_degc': fitted.temperature,
        }
        if self._heard and not self._published():
            text = f'nobody publishes calibrations any more; the last one: {fitted.statement}'
            return Status(Level.STALE, text, values, kind='left')
        if alike is None:
            return Status(Level.OK, f'taken: {fitted.statement}', values, kind='taken')
        values |= {'distance_db': alike.distance, 'level_over_machine_db': alike.level}
        text = (
            f'{round(alike.level, 1) + 0.0:+.1f} dB over the machine, log-spectral distance '
            f'{alike.distance:.1f} dB; {fitted.statement}'
        )
        return Status(Level.WARN if alike.far else Level.OK, text, values, kind='compared')
