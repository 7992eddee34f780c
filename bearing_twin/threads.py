# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
One thread for the linear algebra libraries: import before NumPy.

A node is one thread's work. The libraries' threads would spin between two verdicts, which doubles
the CPU time, and the order in which they add up changes last bits.
"""

import os

for _library in ('OPENBLAS', 'MKL', 'OMP'):
    os.environ.setdefault(f'{_library}_NUM_THREADS', '1')
