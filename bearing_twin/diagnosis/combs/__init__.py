# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Combs of the fault orders in envelope spectra: their scores, harmonics and sidebands."""
