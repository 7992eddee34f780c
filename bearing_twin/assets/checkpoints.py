# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Checkpoints, from which a recording can be re-run: when they are due, and what they hold."""

from __future__ import annotations

import array
import contextlib
import math
from typing import Any, TYPE_CHECKING

from bearing_twin import __version__
from bearing_twin.assets.messages import time_message
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.plainyaml import load_plain
from bearing_twin_msgs.msg import Checkpoint
from std_msgs.msg import Header

if TYPE_CHECKING:
    from collections.abc import Iterator


class Checkpoints:
    """
    Make a checkpoint of a node each period, and after each step that breaks the sequence.

    ``kind``: ``'twin'``, ``'fleet'`` or ``'diagnosis'``; ``node``: its full name; ``period``: s.
    """

    def __init__(self, kind: str, node: str, period: float) -> None:
        self._kind = kind
        self._node = node
        self._period = period
        self._due = -math.inf

    def ask(self) -> None:
        """Let a checkpoint precede the next block: its state does not follow from before."""
        self._due = -math.inf

    def is_due(self, first_sample: int) -> bool:
        """Whether a checkpoint is to precede the block that begins at ``first_sample``."""
        return first_sample >= self._due

    def make(
        self,
        first_sample: int,
        *,
        stamp: int,
        sample_rate: float,
        configuration: str,
        state: bytes,
    ) -> Checkpoint:
        """
        Return the checkpoint before a block; the next one is due a period later.

        Index, stamp (ns) and rate are of its first sample, ``configuration`` the parameters in
        force (YAML), ``state`` that before it.
        """
        self._due = first_sample + round(self._period * sample_rate)
        return Checkpoint(
            header=Header(stamp=time_message(stamp)),
            first_sample=first_sample,
            node=self._node,
            kind=self._kind,
            version=__version__,
            configuration=configuration,
            state=array.array('B', state),
        )


def configuration_values(checkpoint: Any) -> dict[str, Any]:
    """Read the configuration of a checkpoint."""
    values = load_plain(str(checkpoint.configuration), 'the configuration of a checkpoint')
    if not isinstance(values, dict):
        msg = 'the configuration of a checkpoint is no table of parameters'
        raise BearingTwinError(msg)
    return values


@contextlib.contextmanager
def parameters_of(node: str) -> Iterator[None]:
    """Report missing or incompatible parameters of a node that is built from a checkpoint."""
    try:
        yield
    except KeyError as error:
        msg = (
            f'the parameter {error} of the {node} is missing: a bearing_twin that did not have it '
            'yet made this; run it again with that version'
        )
        raise BearingTwinError(msg) from None
    except TypeError as error:
        msg = f'parameters of the {node} are of another type or version ({error})'
        raise BearingTwinError(msg) from None
