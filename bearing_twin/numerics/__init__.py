# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Compilation of kernels and its cache, vector registers, counter-based random numbers."""
