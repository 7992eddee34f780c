# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Series of short snapshots of one machine, minutes or weeks apart, judged together."""
