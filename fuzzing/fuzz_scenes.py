"""Looks for inputs on which reading, converting or drawing a scene fails: coverage-guided, by atheris.

`make fuzz SECONDS=60` runs it from the gallery and from tests/corpus. An input that begins like a PPM file is read as a
texture, every other one as a scene: it is refused with a `SceneError`, or converted for Mitsuba and for POV-Ray, which
may be refused as well, and drawn by the native tracer. Some are drawn by Mitsuba too, some read with an eye on memory,
and some given to the programs as files, which takes longer. Whatever else happens is a failure, and so are ten seconds
and a gigabyte; the input that led to it is left in out/fuzz. A failure that is mended becomes a file in tests/corpus.
"""

import ctypes
import importlib
import os
import random
import re
import resource
import sys
import zlib
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import atheris

ROOT = Path(__file__).parent.parent
FOUND = ROOT / "out" / "fuzz"
LONGEST = 1 << 12
"""Bytes of an input: what takes time that grows with the square of the length stays fast."""

# Atheris does not instrument what an editable installation's own finder loads: only the compiled module needs that.
importlib.import_module("native_tracer")

sys.meta_path[:] = [finder for finder in sys.meta_path if not type(finder).__module__.startswith("_editable")]
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]
with atheris.instrument_imports(include=["converter"]):
    import checks

    from converter.images import ppm
    from converter.scene.geometry import check_geometry
    from converter.scene.model import Texmap
    from converter.scene.parser import load_scene
    from converter.scene.reader import KEYWORDS
    from converter.shapes.csg_program import OPERATIONS

MEASURED, BY_MITSUBA, BY_PROGRAMS = 16, 32, 64
"""One of so many inputs has its memory measured, is drawn by Mitsuba, if it is a scene, or is given to the programs."""
MOST_MEMORY = 1 << 30
"""Bytes of address space beyond those that everything takes once it has been used."""
TEXTURE = ROOT / "scenes" / "rainbow1.ppm"
NUMBERS = (
    b"0 -0 1 -1 2 .5 1e-9 1e9 1e-38 1e38 1e-162 1e155 1e-300 1e300 5e-324 1.7e308 -1.7e308 nan inf 1e999 1e-999".split()
)
NAMES = [word.encode() for word in sorted(KEYWORDS.union(OPERATIONS))]
WORDS = [*NUMBERS, *NAMES, b"#", b"\n", b"\r\n", b"\0", b"P3", b"P6", b"65535"]


def check(data: bytes) -> None:
    """Read, convert and draw an input; anything but the errors meant for users escapes."""
    # Which inputs are looked into more closely is in their bytes, so that a failure can be repeated.
    lot = zlib.crc32(data)
    read = checks.read_texture if ppm.is_ppm(data) else checks.read_scene
    if lot % MEASURED == 0:
        checks.read_in_little_memory(read, data)
    if lot % BY_PROGRAMS == 0:
        with TemporaryDirectory() as folder:
            checks.run_programs(data, Path(folder))
    scene = read(data)
    if scene is None or check_geometry(scene):
        return
    pigments = (
        replace(pigment, file=TEXTURE) if isinstance(pigment, Texmap) else pigment for pigment in scene.pigments
    )
    scene = replace(scene, pigments=tuple(pigments))
    checks.convert(scene)
    checks.draw(scene)
    if lot % BY_MITSUBA == 0:
        checks.draw_with_mitsuba(scene)


@ctypes.CFUNCTYPE(None, ctypes.c_void_p)
def end_at_once(_: object) -> None:
    """What `exit` calls first: threads of the renderers, which it knows nothing of, abort the process later on."""
    os._exit(0)


def limit_memory() -> None:
    """Let an allocation fail, which is a failure like others, that no input of this length justifies."""
    checks.draw_with_mitsuba(load_scene(ROOT / "scenes" / "whitted.in"))
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * resource.getpagesize() + MOST_MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


def mutate(data: bytes, most: int, seed: int) -> bytes:
    """Another input: half the time atheris's own, else words put in, taken out, exchanged or repeated."""
    rng = random.Random(seed)
    if rng.random() < 0.5:
        return bytes(atheris.Mutate(data, most))
    words = re.split(rb"([ \n]+)", data)
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(words))
        end = min(len(words), at + rng.choice((1, 1, 2, 10)))
        match rng.randrange(6):
            case 0:
                words[at] = rng.choice(WORDS)
            case 1:
                words[at] = rng.choice(words)
            case 2:
                del words[at:end]
            case 3:
                words[at:at] = words[at:end] * rng.choice((1, 2, 30))
            case 4:  # the optional numbers at the end of a line: a radius, a cone, a lens, a displacement
                ends = [i for i, word in enumerate(words) if b"\n" in word] or [len(words)]
                more = rng.choice(([], [b"move"])) + rng.choices(NUMBERS, k=rng.choice((1, 2, 3)))
                end = rng.choice(ends)
                words[end:end] = [b" ", b" ".join(more)]
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
    limit_memory()
    ctypes.CDLL(None).__cxa_atexit(end_at_once, None, None)
    seeds = [kept, ROOT / "scenes", ROOT / "tests" / "corpus"]
    atheris.Setup([sys.argv[0], *options, *map(str, seeds)], check, custom_mutator=mutate)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
