"""What is told of a judged picture: a sentence that names the causes, what each explains, and what is left."""

import math
from collections.abc import Sequence
from typing import Any

from converter.why.acne import ACNE
from converter.why.blank import told_rows
from converter.why.judge import Judged
from converter.why.left import Place
from converter.why.student import deviations

_FEW_ROUGH = 0.05
"""Share of a compressed picture that may be wrong with the picture still being right, for all that can be told."""


def verdict(judged: Judged) -> str:
    """The sentence that matters: the causes, or that there are none."""
    if judged.blank.all():
        return "The picture is blank: no row of it shows anything."
    if judged.blank.any():
        return f"{_causes(judged)} Nothing was drawn in {told_rows(judged.blank)}, which are left out."
    if not judged.acne:
        return _causes(judged)
    sentence = deviations()[ACNE].sentence
    speckles = "in speckles where that mistake puts them, though every program has others"
    if judged.found.causes:
        return f"{_causes(judged)} The others: {sentence}, {speckles}."
    return f"{_capital(sentence)}: {_same(judged, ~judged.found.before)}; the others lie {speckles}."


def _causes(judged: Judged) -> str:
    found = judged.found
    if not len(found.screen.places):
        return "The picture is too small for its compression with losses to leave anything that can be judged."
    wrong = float(found.before.mean())
    if found.causes:
        told = _joined([deviations()[cause].sentence for cause in found.causes])
        with_them = {1: "with it", 2: "with both"}.get(len(found.causes), "with all of them")
        return f"{_capital(told)}: {with_them}, {_same(judged, ~found.after)}."
    if found.likeness.lossy:
        if wrong <= _FEW_ROUGH:
            return "The picture is right, as far as its compression with losses lets it be told."
    elif not found.before.any():
        return f"The picture is right: {_same(judged, ~found.before)}."
    elif found.right:
        return f"The picture is right but for single pixels: {_same(judged, ~found.before)}."
    return f"No mistake that is known explains this picture: {_same(judged, ~found.before)}."


def left_sentence(places: Sequence[Place], judged: Judged) -> str:
    """`Left: 6, at silhouettes.`; empty where nothing is."""
    found = judged.found
    if not places or not found.causes:
        return ""
    count = f"{int(found.after.sum()):,}" if found.screen.whole else _percent(found.after.mean())
    by_mechanism: dict[str, float] = {}
    for place in places:
        by_mechanism[place.mechanism] = by_mechanism.get(place.mechanism, 0) + place.share
    most = sorted(by_mechanism.items(), key=lambda item: -item[1])
    if len(most) == 1:
        return f"Left: {count}: {most[0][0]}."
    return f"Left: {count}: " + ", ".join(f"{100 * share:.0f} % {name}" for name, share in most[:3]) + "."


def cause_lines(judged: Judged) -> list[str]:
    """For each cause what the picture is without it, where to look, and what would explain as much."""
    found, lines = judged.found, []
    for number, cause in enumerate(found.causes, 1):
        known = deviations()[cause]
        lines.append(f"{number}. {known.sentence}")
        lines.append(f"   explains: {_share(judged, found.without[cause] - int(found.after.sum()))}")
        lines.append(f"   look at: {known.hint}")
        lines += [f"   or: {deviations()[other].sentence}" for other in found.alternatives.get(cause, ())]
    if judged.acne:
        known = deviations()[ACNE]
        lines += [f"{len(found.causes) + 1}. {known.sentence}", f"   look at: {known.hint}"]
    return lines


def to_json(judged: Judged, places: Sequence[Place]) -> dict[str, Any]:
    """All of it as plain data."""
    found = judged.found
    return {
        "picture": str(judged.theirs.file),
        "width": judged.settings.width,
        "height": judged.settings.height,
        "verdict": verdict(judged),
        "lossy": found.likeness.lossy,
        "tolerance_levels": found.likeness.tolerance,
        "pixels": len(found.screen.places),
        "pixels_are_all": found.screen.whole,
        "wrong": int(found.before.sum()),
        "wrong_with_causes": int(found.after.sum()),
        "causes": [
            {
                "name": cause,
                "part": deviations()[cause].part,
                "sentence": deviations()[cause].sentence,
                "hint": deviations()[cause].hint,
                "wrong_without": found.without[cause],
                "alternatives": list(found.alternatives.get(cause, ())),
            }
            for cause in found.causes
        ],
        "blank_rows": int(judged.blank.sum()),
        "acne": judged.acne,
        "left": [
            {
                "object": place.object,
                "finish": place.finish,
                "mechanism": place.mechanism,
                "share": place.share,
                "pixel": list(place.pixel),
            }
            for place in places
        ],
    }


def _same(judged: Judged, same: Any) -> str:
    found = judged.found
    if found.likeness.lossy:
        return f"{100 * same.mean():.1f} % of the picture is the same but for its compression"
    if found.screen.whole:
        return f"{int(same.sum()):,} of {len(same):,} pixels are the same"
    return f"{_percent(same.mean())} of the pixels are the same, by {len(same):,} of them"


def _share(judged: Judged, count: int) -> str:
    found = judged.found
    if count <= 0:
        return "the levels of colours, by one"
    percent = _percent(count / max(len(found.screen.places), 1))
    if found.likeness.lossy or not found.screen.whole:
        return f"{percent} of the picture"
    return f"{count:,} pixels, {percent} of the picture"


def _percent(share: float) -> str:
    """A share with as many digits as tell it from nothing and from all."""
    if 0.1 <= share < 0.99:
        return f"{100 * share:.0f} %"
    nearer = min(share, 1 - share)
    if nearer == 0:
        return f"{100 * share:.0f} %"
    digits = max(1, 1 - math.floor(math.log10(100 * nearer))) if nearer < 0.01 else 1
    return f"{100 * share:.{digits}f} %"


def _capital(text: str) -> str:
    return text[0].upper() + text[1:]


def _joined(parts: Sequence[str]) -> str:
    if len(parts) < 2:
        return parts[0]
    return f"{', '.join(parts[:-1])}, and {parts[-1]}"
