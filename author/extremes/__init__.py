# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`palpate extremes`: what happens at the ends of every axis, case by case (case.py says what the outcomes mean)."""
