"""Settings from Python: what is given becomes TOML documents, which the library reads and judges."""

import json
import os
from collections.abc import Mapping


def documents(config):
    """(text, name) of each document of a path, a dictionary or a sequence of these; later ones win."""
    if config is None:
        return []
    if isinstance(config, (str, os.PathLike)):
        with open(config, encoding="utf-8") as file:
            return [(file.read(), os.fspath(config))]
    if isinstance(config, Mapping):
        return [(f"{key} = {_toml(key, value)}", "config") for key, value in _flat(config, "")]
    if isinstance(config, (list, tuple)):
        return [document for one in config for document in documents(one)]
    raise TypeError(
        f"mpmpbd: config is a {type(config).__name__}; give a path, a dictionary or a list of these"
    )


def _flat(table, prefix):
    """{"episode": {"limit": 5}} and {"episode.limit": 5} are the same."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _toml(key, value):
    if hasattr(value, "tolist"):  # numbers and arrays of NumPy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(key, one) for one in value) + "]"
    raise TypeError(
        f"mpmpbd: {key} is a {type(value).__name__}; give a number, a text, a truth value or a list"
    )
