"""Looks for inputs on which reading, converting or drawing a scene fails: coverage-guided, by atheris.

`make fuzz SECONDS=60` runs it from the gallery and from tests/corpus. An input that begins like a PPM file is read as a
texture, every other one as a scene: it is refused with a `SceneError`, or converted for Mitsuba and for POV-Ray, which
may be refused as well, and drawn by the native tracer. Whatever else happens is a failure, and the input that led to it
is left in out/fuzz. A failure that is mended becomes a file in tests/corpus.
"""

import importlib
import io
import random
import re
import sys
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import atheris

ROOT = Path(__file__).parent.parent
FOUND = ROOT / "out" / "fuzz"
LONGEST = 1 << 12
"""Bytes of an input: what takes time that grows with the square of the length stays fast."""

# Atheris does not instrument what an editable installation's own finder loads: only the compiled module needs that.
importlib.import_module("native_tracer")

sys.meta_path[:] = [finder for finder in sys.meta_path if not type(finder).__module__.startswith("_editable")]
sys.path.insert(0, str(ROOT))
with atheris.instrument_imports(include=["converter"]):
    from converter.images import ppm
    from converter.renderers.native import NativeRenderer
    from converter.scene.cutoff import cutoff_bound
    from converter.scene.entries import KEYWORDS
    from converter.scene.errors import SceneError
    from converter.scene.geometry import check_geometry
    from converter.scene.model import Scene, Texmap
    from converter.scene.needs import scene_needs
    from converter.scene.notices import scene_notices
    from converter.scene.parser import parse_scene
    from converter.scene.settings import Settings
    from converter.to_mitsuba.export import ExportError
    from converter.to_mitsuba.polyhedra import PolyhedronError
    from converter.to_mitsuba.scene import scene_description
    from converter.to_povray.scene import povray_scene

SETTINGS = Settings(width=4, height=3, max_depth=4, threads=1)
TEXTURE = ROOT / "scenes" / "rainbow1.ppm"
NUMBERS = (
    b"0 -0 1 -1 2 .5 1e-9 1e9 1e-38 1e38 1e-162 1e155 1e-300 1e300 5e-324 1.7e308 -1.7e308 nan inf 1e999 1e-999".split()
)
WORDS = [*NUMBERS, *(word.encode() for word in sorted(KEYWORDS)), b"#", b"\n", b"\r\n", b"\0", b"P3", b"P6", b"65535"]


def check(data: bytes) -> None:
    """Read, convert and draw an input; anything but the errors meant for users escapes."""
    if ppm.is_ppm(data):
        with suppress(ValueError):
            header = ppm.read_header(data[: ppm.HEADER_BYTES], len(data))
            assert len(ppm.read_samples(io.BytesIO(data), header)) == header.samples
        return
    try:
        scene = parse_scene(data)
    except SceneError as error:
        assert error.problems
        assert len(str(error)) < 1 << 14
        return
    if check_geometry(scene):
        return
    pigments = (
        replace(pigment, file=TEXTURE) if isinstance(pigment, Texmap) else pigment for pigment in scene.pigments
    )
    use(replace(scene, pigments=tuple(pigments)))


def use(scene: Scene) -> None:
    """Do with a good scene all that there is to do."""
    scene_needs(scene, SETTINGS)
    scene_notices(scene, SETTINGS)
    cutoff_bound(scene, SETTINGS)
    scene_description(scene, SETTINGS, with_shapes=False)
    with suppress(PolyhedronError):
        scene_description(scene, SETTINGS)
    with suppress(ExportError):
        povray_scene(scene, SETTINGS)
    for search in ("brute", "bvh"):
        NativeRenderer(search=search).render(scene, SETTINGS)


def mutate(data: bytes, most: int, seed: int) -> bytes:
    """Another input: half the time atheris's own, else words put in, taken out, exchanged or repeated."""
    rng = random.Random(seed)
    if rng.random() < 0.5:
        return bytes(atheris.Mutate(data, most))
    words = re.split(rb"([ \n]+)", data)
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(words))
        end = min(len(words), at + rng.choice((1, 1, 2, 10)))
        match rng.randrange(5):
            case 0:
                words[at] = rng.choice(WORDS)
            case 1:
                words[at] = rng.choice(words)
            case 2:
                del words[at:end]
            case 3:
                words[at:at] = words[at:end] * rng.choice((1, 2, 30))
            case _:
                start = rng.randrange(len(words))
                words[at:at] = words[start : start + end - at]
        words = words or [b""]
    return b"".join(words)[:most]


def main() -> None:
    """Run for as long as `sys.argv` says, or until something fails; further arguments are libFuzzer's."""
    seconds, *more = sys.argv[1:] or ["60"]
    kept = FOUND / "inputs"
    kept.mkdir(parents=True, exist_ok=True)
    words = FOUND / "words.txt"
    words.write_text("".join('"' + "".join(map(r"\x{:02x}".format, word)) + '"\n' for word in WORDS))
    options = [f"-max_total_time={seconds}", f"-max_len={LONGEST}", f"-dict={words}", f"-artifact_prefix={FOUND}/"]
    options += ["-timeout=10", "-rss_limit_mb=2048", "-print_final_stats=1", *more]
    seeds = [kept, ROOT / "scenes", ROOT / "tests" / "corpus"]
    atheris.Setup([sys.argv[0], *options, *map(str, seeds)], check, custom_mutator=mutate)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
