# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One machine over time: its own baseline, what its level depends on, and when that rises."""
