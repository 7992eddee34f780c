# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Benchmarks behind 'bearing-twin bench'; `cli.bench.FIGURES` explains what each measures."""
