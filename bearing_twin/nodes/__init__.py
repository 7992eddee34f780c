# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""ROS 2 nodes: thin adapters around the core."""

import os

# A node is one thread's work. The threads of the linear algebra libraries would spin between two
# verdicts, which doubles the CPU time, and the order in which they add up changes last bits.
for _library in ('OPENBLAS', 'MKL', 'OMP'):
    os.environ.setdefault(f'{_library}_NUM_THREADS', '1')
