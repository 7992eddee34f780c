# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Lines of one bearing in envelope spectra: combs of harmonics, their sidebands and scores."""
