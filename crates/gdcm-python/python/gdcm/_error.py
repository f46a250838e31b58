"""Exception that calls of this module raise."""

from __future__ import annotations

import json
from typing import Any, Dict, List, Optional

from ._messages import Message, messages_of


class Error(Exception):
    """Raised when a call has no result.

    Attributes
    ----------
    code : str
        Stable code of the program, such as ``"missing-file"`` or ``"wrong-option"``; the
        reference of the commands lists them. Compare codes, not texts.
    status : int
        Exit status of the command: 1 no complete result, 2 the request or a file is wrong.
    fields : dict
        Subject of the text, such as ``option``, ``path``, ``place``, ``line``.
    errors, cautions : list of Message
        Messages reported before the error: the individual faults that caused it, and cautions.
    """

    code: str
    status: int
    fields: Dict[str, Any]
    errors: List[Message]
    cautions: List[Message]

    def __init__(
        self,
        code: str,
        text: str,
        *,
        status: int = 2,
        fields: Optional[Dict[str, Any]] = None,
        errors: Optional[List[Message]] = None,
        cautions: Optional[List[Message]] = None,
    ) -> None:
        super().__init__(text)
        self.code = code
        self.status = status
        self.fields = fields or {}
        self.errors = errors or []
        self.cautions = cautions or []

    @classmethod
    def _from_call(cls, code: str, text: str, status: int, fields: str, messages: str) -> Error:
        reported = messages_of(messages)
        values = json.loads(fields)
        errors = reported.errors
        if errors:
            text = "\n  ".join([text] + [error.text for error in errors])
        return cls(
            code,
            text,
            status=status,
            fields=values,
            errors=errors,
            cautions=reported.cautions,
        )

    def __reduce__(self) -> Any:
        state = dict(self.__dict__)
        return (_rebuilt, (self.code, str(self), state))


def _rebuilt(code: str, text: str, state: Dict[str, Any]) -> Error:
    error = Error(code, text)
    error.__dict__.update(state)
    return error
