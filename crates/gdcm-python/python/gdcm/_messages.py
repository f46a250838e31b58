"""Messages of the program about a result."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import List, Tuple


@dataclass(frozen=True)
class Message:
    """A note, a caution or an error of the program.

    `code` is stable, `text` may change. `conditions` are the ids of the conditions that the message
    concerns; empty if it concerns the whole result.
    """

    code: str
    text: str
    conditions: Tuple[int, ...] = ()

    def __str__(self) -> str:
        return f"{self.code}: {self.text}"


@dataclass(frozen=True)
class Messages:
    """All messages of a call."""

    notes: List[Message] = field(default_factory=list)
    cautions: List[Message] = field(default_factory=list)
    errors: List[Message] = field(default_factory=list)


def messages_of(text: str) -> Messages:
    """Read the messages from the object of ``gdcm --json``."""
    values = json.loads(text) or {}
    notes = zip(values.get("note_codes", []), values.get("notes", []))
    errors = zip(values.get("error_codes", []), values.get("errors", []))
    cautions = [
        Message(caution["code"], caution["text"], tuple(caution["conditions"]))
        for caution in values.get("cautions", [])
    ]
    return Messages(
        notes=[Message(code, words) for code, words in notes],
        cautions=cautions,
        errors=[Message(code, words) for code, words in errors],
    )
