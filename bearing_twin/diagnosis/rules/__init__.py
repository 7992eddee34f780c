# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""From combs to an answer: the evidence, the ordered table of rules, and how sure an answer is."""
