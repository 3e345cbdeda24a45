"""Loads scene files.

Most files hold nothing unusual, and the native tracer's scanner reads them ten times as fast as `parser`. Whatever it
does not know, be it wrong or only rare, the parser reads from the beginning, and says what there is to say. Both give
the same scene.
"""

from pathlib import Path

from converter.scene import model
from converter.scene.errors import place
from converter.scene.geometry import check_geometry
from converter.scene.model import Scene, Texmap
from converter.uncollected import uncollected

LONGEST = 1 << 28
"""Bytes of a file that is scanned."""


def load_scene(path: str | Path) -> Scene:
    """The scene in the file `path`, with textures that can be opened and half-spaces that meet.

    Raises:
        SceneError: the file cannot be read, or is no such scene; says everything that is wrong with it.
    """
    file = Path(path)
    with uncollected():
        scene = _scanned(file)
    if scene is not None:
        return scene
    from converter.scene import parser  # late: most scenes need none of it

    return parser.load_scene(file)


def _scanned(file: Path) -> Scene | None:
    """The scene, if there is nothing to be told of it; a pipe, which is read only once, is not looked at."""
    try:
        if not file.is_file() or file.stat().st_size > LONGEST:
            return None
        scene = scan_text(file.read_bytes(), file)
    except (ImportError, OSError):  # the tracer is not built; the file cannot be read
        return None
    if scene is None or not _textures_open(scene) or check_geometry(scene):
        return None
    return scene


def scan_text(text: bytes, file: Path | None = None) -> Scene | None:
    """What `parser.parse_scene` makes of a text, if that holds nothing unusual.

    Raises:
        ImportError: the native tracer is not built.
    """
    from native_tracer import scan_scene

    found = scan_scene(text, model)
    if found is None:
        return None
    camera, lights, pigments, finishes, objects, light_lines, pigment_lines, finish_lines = found
    folder = Path() if file is None else file.parent
    return Scene(
        camera=camera,
        ambient=lights[0].color,
        lights=lights[1:],
        pigments=tuple([_texmap(p, folder, file) if type(p) is tuple else p for p in pigments]),
        finishes=finishes,
        objects=objects,
        file=file,
        finish_lines=finish_lines,
        light_lines=light_lines[1:],
        pigment_lines=pigment_lines,
    )


def _texmap(scanned: tuple[str, model.Plane, model.Plane, int], folder: Path, file: Path | None) -> Texmap:
    name, p0, p1, line = scanned
    return Texmap(folder / name, p0, p1, place(file, line))


def _textures_open(scene: Scene) -> bool:
    """Whether every texture can be opened beside the scene."""
    files = {pigment.file for pigment in scene.pigments if isinstance(pigment, Texmap)}
    if not files:
        return True
    from converter.images.texture import TextureError, probe_texture

    try:
        for file in files:
            probe_texture(file, hint=False)
    except TextureError:
        return False
    return True
