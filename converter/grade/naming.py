"""One name for a mistake in all pictures of a program.

In one scene a picture that is upside down may be one with other corners of pixels, for all that can be told. A program
makes the same mistakes everywhere: so of those that look the same in a scene the one is named that is found in most.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

from converter.grade.judge import Verdict, mistakes

Found = tuple[str, str]
"""A scene, and a mistake that is named for it."""


def consistent(verdicts: Mapping[str, Verdict | None]) -> dict[str, Verdict | None]:
    """The verdicts on one program's pictures, with as few mistakes as tell all of them."""
    chosen = _chosen(
        {
            (scene, cause): {cause, *verdict.alternatives.get(cause, ())}
            for scene, verdict in verdicts.items()
            if verdict is not None
            for cause in verdict.causes
        }
    )
    return {scene: _renamed(scene, verdict, chosen) if verdict else None for scene, verdict in verdicts.items()}


def _chosen(possible: Mapping[Found, set[str]]) -> dict[Found, str]:
    """For each mistake that was named the one that it is: greedily those that are possible most often."""
    order = {name: k for k, name in enumerate(mistakes())}
    named = Counter(cause for _, cause in possible)
    left, chosen = dict(possible), {}
    while left:
        count = Counter(name for names in left.values() for name in names)
        best = max(count, key=lambda name: (count[name], named[name], -order[name]))
        here: set[str] = set()
        with_it = [found for found, names in left.items() if best in names]
        for found in sorted(with_it, key=lambda found: found[1] != best):
            if found[0] not in here:  # one of a scene's mistakes has that name
                here.add(found[0])
                chosen[found] = best
                del left[found]
        for found, names in left.items():
            if best in names:
                left[found] = names - {best} or {found[1]}
    return chosen


def _renamed(scene: str, verdict: Verdict, chosen: Mapping[Found, str]) -> Verdict:
    known = mistakes()
    causes, alternatives, spoiled, sentence = [], {}, {}, verdict.sentence
    for old in verdict.causes:
        new = chosen[scene, old]
        causes.append(new)
        spoiled[new] = verdict.spoiled.get(old, 0.0)
        others = {old, *verdict.alternatives.get(old, ())} - {new}
        alternatives[new] = tuple(name for name in known if name in others)
        for one, other in ((known[old].sentence, known[new].sentence), (_capital(old), _capital(new))):
            sentence = sentence.replace(one, other)
    renamed = replace(verdict, causes=tuple(causes), spoiled=spoiled, alternatives=alternatives)
    return replace(renamed, sentence=sentence)


def _capital(name: str) -> str:
    sentence = mistakes()[name].sentence
    return sentence[0].upper() + sentence[1:]
