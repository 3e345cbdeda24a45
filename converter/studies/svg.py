"""Makes matplotlib's SVG small: figures of dozens of panels repeat the same styles thousands of times."""

import re

_STYLE = re.compile(r'style="([^"]*)"')
_NUMBER = re.compile(r"-?\d+\.\d{3,}")
_TAG = re.compile(r"<(?:path|use|text|g|rect)\b[^>]*>")
_HASH = re.compile(r'(?<= id=")[mp][0-9a-f]{10}(?=")')
_EMPTY = re.compile(
    r'\s+(?:id="(?:text|patch|line2d|xtick|ytick|matplotlib\.axis|axes)_\d+"|transform="rotate\(-0 [^"]*\)")'
)


def compact(svg: str) -> str:
    """The same picture: styles as classes, short names, tenths of a point, and no groups that say nothing."""
    classes: dict[str, str] = {}

    def style(match: re.Match[str]) -> str:
        return f'class="{classes.setdefault(match[1], f"s{len(classes)}")}"'

    def tag(match: re.Match[str]) -> str:
        text = _EMPTY.sub("", match[0])
        text = _STYLE.sub(style, text)
        return " ".join(_NUMBER.sub(lambda number: f"{float(number[0]):.1f}", text).split())

    head, separator, body = svg.partition("<defs>")
    body = re.sub(r"\s*\n\s*", "\n", _unwrapped(_TAG.sub(tag, body)))
    body = _renamed(body)
    rules = "".join(f".{name}{{{rule}}}" for rule, name in classes.items())
    return f"{head}<style>{rules}</style>{separator}{body}"


def _renamed(body: str) -> str:
    """With short names for markers and clips instead of hashes."""
    names: dict[str, str] = {}
    for name in _HASH.findall(body):
        names.setdefault(name, f"i{len(names)}")
    return re.sub("|".join(names), lambda match: names[match[0]], body) if names else body


def _unwrapped(body: str) -> str:
    """What is left without groups that say nothing."""
    plain: list[bool] = []

    def tag(match: re.Match[str]) -> str:
        if match[0].endswith("/>"):
            return ""
        if match[0] == "</g>":
            return "" if plain.pop() else "</g>"
        plain.append(match[0] == "<g>")
        return "" if plain[-1] else match[0]

    return re.sub(r"</?g\b[^>]*>", tag, body)
