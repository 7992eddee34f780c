# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Messages shown as text: parameters of a node, its log, strings."""

from __future__ import annotations

from typing import Any

from bearing_twin.recording.plainyaml import load_table
from bearing_twin.view.rerun.pictures.picture import Picture
from bearing_twin.view.source import bearing_in_words, fleet_tables
import rerun as rr

LOG_LEVELS = {10: 'DEBUG', 20: 'INFO', 30: 'WARN', 40: 'ERROR', 50: 'CRITICAL'}


class CheckpointPicture(Picture):
    """Show the parameters of a node, those of a fleet asset by asset."""

    kind = 'checkpoint'

    def draw(self, message: Any, time: int) -> bool:
        """Draw a checkpoint at ``time`` in ns."""
        node, kind = str(message.node), str(message.kind)
        values = load_table(str(message.configuration), f'the configuration of {node}')
        self.asset.source.parameters(node, kind, values)
        for namespace, table in fleet_tables(node, kind, values).items():
            self.asset.sources[namespace].parameters(node, 'twin', table)
        lines = [f'### {node}: {kind}, bearing_twin {message.version}', '']
        for name, table in parameter_tables(values).items():
            lines += [f'#### {name}', ''] if name else []
            if bearing := str(table.get('bearing') or ''):
                lines.append(f'Bearing {bearing_in_words(bearing, orders=True)}.')
            cells = [f'| {k} | {v} ' for k, v in table.items() if v not in ('', None)] + ['| | ']
            lines += ['', '| parameter | value | parameter | value |', '|---|---|---|---|']
            lines += [f'{a}{b}|' for a, b in zip(cells[::2], cells[1::2], strict=False)] + ['']
        self.canvas.put(
            'parameters', time, rr.TextDocument('\n'.join(lines), media_type=rr.MediaType.MARKDOWN)
        )
        return True


def parameter_tables(values: dict[str, Any], prefix: str = '') -> dict[str, dict[str, Any]]:
    """
    Return flat tables of parameters by asset.

    A node has one table, called ''. A fleet has one for each of its assets.
    """
    own = {str(key): value for key, value in values.items() if not isinstance(value, dict)}
    tables = {prefix: own} if own else {}
    for key, value in values.items():
        if isinstance(value, dict):
            tables |= parameter_tables(value, f'{prefix}/{key}' if prefix else str(key))
    return tables


class LogPicture(Picture):
    """Show the log of the nodes."""

    kind = 'log'

    def draw(self, message: Any, time: int) -> bool:
        """Draw a log message at ``time`` in ns."""
        level = LOG_LEVELS.get(int(message.level), 'INFO')
        text = f'{message.name}: {message.msg}'
        self.canvas.put(entity(message.name), time, rr.TextLog(text, level=level))
        return True


class TextPicture(Picture):
    """Show texts."""

    kind = 'text'

    def draw(self, message: Any, time: int) -> bool:
        """Draw a text at ``time`` in ns."""
        self.canvas.put('text', time, rr.TextLog(str(message.data)))
        return True


def entity(text: str) -> str:
    """Return a text as a valid part of an entity path."""
    kept = ''.join(c if c.isalnum() or c in '-_.' else '_' for c in text.strip())
    return '_'.join(filter(None, kept.split('_'))) or 'unnamed'
