# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Signal processing from samples to envelope spectra, shaft speed and severity."""
