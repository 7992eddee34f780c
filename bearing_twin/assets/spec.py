# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One parameter of a node or an offline run, and what a checkpoint says of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

__all__ = ['Spec', 'Value', 'configuration']

Value = bool | int | float | str | list[str]


@dataclass(frozen=True, kw_only=True)
class Spec:
    """One parameter of a node."""

    name: str
    default: Value
    description: str
    unit: str = ''
    low: float | None = None
    high: float | None = None
    choices: tuple[str, ...] = ()
    running: bool = True
    """Whether it can be changed while the node is active; else in state 'unconfigured' only."""
    read_only: bool = False
    """Whether it can be set at start only."""
    implied: bool = False
    """Whether a configuration that does not name it means the default."""


def configuration(specs: Iterable[Spec], values: Mapping[str, Any]) -> dict[str, Any]:
    """
    Return what a checkpoint says of ``values``: all but the implied ones that have their default.

    A fleet's checkpoint holds one configuration an asset, and is written between two deadlines.
    """
    left_out = {spec.name: spec.default for spec in specs if spec.implied}
    return {n: v for n, v in values.items() if n not in left_out or v != left_out[n]}
