"""The one exception of the package."""

from __future__ import annotations

from typing import Any


class Error(Exception):
    """What is wrong, where, and what to do about it.

    Attributes:
        what: one sentence, with the value.
        kind: ``"input"`` (a file or an argument cannot be used), ``"mismatch"`` (a log does not belong to its
            program), ``"undetermined"`` (the data cannot determine what was asked for), ``"output"`` (a result cannot
            be written) or ``"internal"`` (a fault of the library: please report it).
        argument: the argument of the call that cannot be used, or ``None``.
        file, line, column, text: the place in a file, counted from 1, and its line; each ``None`` where there is none.
        hint: what to do about it, or ``None``.
    """

    def __init__(
        self,
        what: str,
        *,
        kind: str = "input",
        argument: str | None = None,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
        text: str | None = None,
        hint: str | None = None,
    ) -> None:
        super().__init__(what)
        self.what = what
        self.kind = kind
        self.argument = argument
        self.file = file
        self.line = line
        self.column = column
        self.text = text
        self.hint = hint

    def __str__(self) -> str:
        told = self.what
        if self.file is not None:
            place = ":".join(str(part) for part in (self.file, self.line, self.column) if part is not None)
            told += f"\n  --> {place}"
            if self.text is not None:
                told += f"\n      {self.text.strip()}"
        if self.hint is not None:
            told += f"\nhint: {self.hint}"
        return told

    def __reduce__(self) -> tuple[Any, ...]:
        # Workers of a cluster send it home.
        return (_again, (self.what, dict(self.__dict__)))


def _again(what: str, attributes: dict[str, Any]) -> Error:
    error = Error(what)
    error.__dict__.update(attributes)
    return error
