# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Set options of Fast DDS that the nodes need, unless the user has set them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, ExitStack
import os
from pathlib import Path
from string import Template
import sys
import tempfile

from bearing_twin.errors import shown
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

PROFILES = ('FASTDDS_DEFAULT_PROFILES_FILE', 'FASTRTPS_DEFAULT_PROFILES_FILE')
TRANSPORTS = 'FASTDDS_BUILTIN_TRANSPORTS'
MODE = 'RMW_FASTRTPS_PUBLICATION_MODE'
"""Environment variables of Fast DDS: profile files, transports, publication mode."""
OLDER = not hasattr(_rclpy.Timer, 'call_timer_with_info')
"""Whether Fast DDS 2 is in use (ROS 2 Jazzy; its timers lack this method)."""
FORMER_NAMES = {
    'heartbeat_period': 'heartbeatPeriod',
    'nack_supression_duration': 'nackSupressionDuration',
}
"""Names of elements in Fast DDS 2."""


@contextmanager
def fast_dds_settings(*, fleet: bool) -> Iterator[None]:
    """
    Configure Fast DDS so that it does not block publishers, lose blocks or keep large buffers.

    By default its sockets block for seconds when the other host is gone, which would miss every
    deadline. With non-blocking sockets, data that cannot be sent is dropped, and sent again if it
    is still in the history of the writer. Heartbeats detect the loss, by default every 3 s, which
    is longer than blocks are kept. And by default each entry of a queue keeps the size of the
    largest message that it has ever held. A ``fleet`` gets more shared memory, as that of one node
    does not hold the blocks that it publishes in a row. Profiles, transports or a publication mode
    set by the user are not changed. Other middleware ignores these settings.

    Fast DDS reads them when the process makes its first node, which has to be done within.
    """
    chosen = any(name in os.environ for name in PROFILES)
    large = fleet and TRANSPORTS not in os.environ
    if not chosen:
        os.environ.setdefault(TRANSPORTS, 'DEFAULT?non_blocking=true')
    if chosen or MODE in os.environ:
        # With a profile, Fast DDS would ignore the mode set by the user.
        yield
        return
    # Fast DDS 2 knows only the older name of the variable; version 3 warns about it.
    variable = PROFILES[OLDER]
    os.environ.setdefault('RMW_FASTRTPS_USE_QOS_FROM_XML', '1')
    with ExitStack() as stack:
        try:
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix='fastdds_'))
            file = Path(folder, 'fastdds.xml')
            file.write_text(profiles(fleet=large, older=OLDER), encoding='utf-8')
            os.environ[variable] = str(file)
        except OSError as error:
            said = (
                f'Fast DDS keeps its defaults and may lose blocks ({error}); free or name a TMPDIR'
            )
            print(shown(said), file=sys.stderr)
        yield
    os.environ.pop(variable, None)


def profiles(*, fleet: bool, older: bool) -> str:
    """Return the profiles of a fleet or of another node as XML, ``older``: for Fast DDS 2."""
    begin, end = ('', '') if fleet else ('<!--', '-->')
    text = Template(Path(__file__).with_name('fastdds.xml').read_text(encoding='utf-8'))
    made = text.substitute(FLEET=begin, END=end, HEARTBEAT=700_000_000 if fleet else 500_000_000)
    for name, former in FORMER_NAMES.items() if older else ():
        made = made.replace(name, former)
    return made
