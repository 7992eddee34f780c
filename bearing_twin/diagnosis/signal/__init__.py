# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""From samples to envelope spectra: what is measured in a signal before anything is looked for."""
