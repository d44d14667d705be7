# SPDX-License-Identifier: AGPL-3.0-or-later
"""Names of a plan's objects under Boolean operators."""
from __future__ import annotations


class Name(str):
    """The name of a step's object, or a Boolean expression of such names.

    & (and), | (or), - (less), ^ (either) and ~ (not) make the text of an expression; nothing is computed.
    """

    def __and__(self, other: str) -> Name:
        return self._with("&", other)

    def __or__(self, other: str) -> Name:
        return self._with("|", other)

    def __sub__(self, other: str) -> Name:
        return self._with("-", other)

    def __xor__(self, other: str) -> Name:
        return self._with("^", other)

    def __invert__(self) -> Name:
        return Name(f"~{_within(self)}")

    def _with(self, sign: str, other: str) -> Name:
        return Name(f"{_within(self)} {sign} {_within(other)}")


def _within(text: str) -> str:
    """The text as an operand: in parentheses where it is no single name."""
    return text if text.isidentifier() else f"({text})"
