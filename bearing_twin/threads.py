# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Limit the linear algebra libraries to one thread. Import this module before NumPy.

A node needs one thread. Threads of the libraries would spin between two verdicts, which doubles
the CPU time, and their order of summation would change the last bits of results.
"""

import os

for _library in ('OPENBLAS', 'MKL', 'OMP'):
    os.environ.setdefault(f'{_library}_NUM_THREADS', '1')
