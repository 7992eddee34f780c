# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Checkpoints, from which a recording can be re-run: schedule and content."""

from __future__ import annotations

import array
from collections.abc import Iterator
import contextlib
import math
from typing import Any

from bearing_twin import __version__
from bearing_twin.assets.messages import time_message
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.plainyaml import load_table
from bearing_twin_msgs.msg import Checkpoint
from std_msgs.msg import Header


class Checkpoints:
    """
    Make checkpoints of a node, one per period and others after discontinuities of its state.

    ``kind`` is ``'twin'``, ``'fleet'`` or ``'diagnosis'``, ``node`` the full name of the node, and
    ``period`` the time between checkpoints in s.
    """

    def __init__(self, kind: str, node: str, period: float) -> None:
        self._kind = kind
        self._node = node
        self._period = period
        # Sample of the newest periodic checkpoint, and samples until the next one.
        self._last, self._wait = math.inf, 0

    def ask(self) -> None:
        """Request a checkpoint before the next block, after a discontinuity of the state."""
        self._last = math.inf

    def is_due(self, first_sample: int) -> bool:
        """
        Return whether a checkpoint is due before the block that begins at ``first_sample``.

        It is where the index has gone back, too: the former one says nothing of the time since.
        """
        return not 0 <= first_sample - self._last < self._wait

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
        Return the checkpoint before a block; if it was due, the next one is one period later.

        ``first_sample``, ``stamp`` (ns) and ``sample_rate`` (Hz) belong to the first sample of
        the block. ``configuration`` holds the parameters in force (YAML), and ``state`` is the
        state before the block.
        """
        if self.is_due(first_sample):
            self._last, self._wait = first_sample, round(self._period * sample_rate)
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
    """Return the parameters in the configuration of a checkpoint, by name."""
    return load_table(str(checkpoint.configuration), 'the configuration of a checkpoint')


@contextlib.contextmanager
def parameters_of(node: str) -> Iterator[None]:
    """Report missing or incompatible parameters of a node that is built from a checkpoint."""
    try:
        yield
    except KeyError as error:
        raise BearingTwinError(
            f'the parameter {error} of the {node} is missing: a bearing_twin that did not have it '
            'yet made this; run it again with that version'
        ) from None
    except TypeError as error:
        msg = f'parameters of the {node} are of another type or version ({error})'
        raise BearingTwinError(msg) from None
