"""A dict with the structure of a study as TOML."""
import collections.abc
import json
import math
import numbers
import os
import re

from ._chladni import InvalidInput

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def _key(key):
    if not isinstance(key, str):
        raise TypeError(f"a key of a study is text, found {key!r}")
    return key if _BARE.fullmatch(key) else _text(key, "a key")


def _text(text, where):
    try:
        text.encode()
    except UnicodeEncodeError:
        raise InvalidInput(f"{where} is {text!r}, which has half of a surrogate pair; expected text") \
            from None
    # The escapes of JSON are escapes of TOML, where no surrogate occurs.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value, where):
    if hasattr(value, "tolist"):  # of NumPy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        number = float(value)
        if math.isnan(number):
            return "nan"
        return repr(number) if math.isfinite(number) else ("inf" if number > 0 else "-inf")
    if isinstance(value, (str, os.PathLike)):
        return _text(os.fspath(value), where)
    if isinstance(value, collections.abc.Mapping):
        return "{ " + ", ".join(_members(value, where)) + " }" if value else "{}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(v, f"{where}[{i}]") for i, v in enumerate(value)) + "]"
    raise TypeError(f"{where} is {value!r}; a study has texts, numbers, truths, lists and dicts")


def _members(table, where):
    for key, value in table.items():
        yield f"{_key(key)} = {_value(value, f'{where}.{key}' if where else key)}"


def toml_text(study):
    """The TOML text: a line for each key of the study, and for each element of a list of dicts."""
    lines = []
    for key, value in study.items():
        if isinstance(value, (list, tuple)) and value and all(
                isinstance(v, collections.abc.Mapping) for v in value):
            elements = (f"  {_value(v, f'{key}[{i}]')}," for i, v in enumerate(value))
            lines += [f"{_key(key)} = [", *elements, "]"]
        else:
            lines.append(f"{_key(key)} = {_value(value, key)}")
    return "\n".join(lines) + "\n"
