# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read vibration signals from text, MATLAB, NumPy, WAV and Parquet files, and recordings."""
