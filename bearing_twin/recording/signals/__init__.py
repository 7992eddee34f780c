# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Vibration signals out of files of any kind: text, MATLAB, numpy, WAV, Parquet, recordings."""
