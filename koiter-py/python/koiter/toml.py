"""Scenes as the text of a scene file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np


def _key(name: str) -> str:
    plain = name and all(c.isascii() and (c.isalnum() or c in "_-") for c in name)
    return name if plain else json.dumps(name, ensure_ascii=False)


def value(item: Any) -> str:
    """An item as a TOML value: text, numbers, truth, sequences, mappings (as inline tables) and NumPy arrays.

    Raises ``TypeError`` for anything else.
    """
    if isinstance(item, (bool, np.bool_)):
        return "true" if item else "false"
    if isinstance(item, (int, np.integer)):
        return str(int(item))
    if isinstance(item, (float, np.floating)):
        return _number(float(item))
    if isinstance(item, str):
        return json.dumps(item, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(item, np.ndarray):
        return value(item.tolist())
    if isinstance(item, Mapping):
        entries = (f"{_key(str(key))} = {value(entry)}" for key, entry in item.items())
        return "{ " + ", ".join(entries) + " }"
    if isinstance(item, Sequence):
        return "[" + ", ".join(value(entry) for entry in item) + "]"
    raise TypeError(f"a scene has text, numbers, lists and tables, but not {type(item).__name__}: {item!r}")


def _number(number: float) -> str:
    if math.isnan(number):
        return "nan"
    if math.isinf(number):
        return "inf" if number > 0 else "-inf"
    text = repr(number)
    return text if any(c in text for c in ".e") else text + ".0"


def document(keys: Mapping[str, Any], lists: Mapping[str, Sequence[Mapping[str, Any]]]) -> str:
    """The text of a scene: its top-level keys, then its lists of tables, such as ``[[shell]]``."""
    lines = [f"{_key(key)} = {value(item)}" for key, item in keys.items()]
    for name, tables in lists.items():
        for table in tables:
            lines.append(f"\n[[{_key(name)}]]")
            lines.extend(f"{_key(key)} = {value(item)}" for key, item in table.items())
    return "\n".join(lines) + "\n"
