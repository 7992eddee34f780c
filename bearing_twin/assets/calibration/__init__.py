# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Fit a twin to its machine while both run: records, schedule, and the fitted parameters."""
