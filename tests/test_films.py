"""Films: keyframes, what they address, what is blurred, and the files."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from converter.batch.manifest import MANIFEST, Manifest, digest_of
from converter.commands import main
from converter.files import only_one
from converter.films.addresses import AddressError, changed, find_address, names_of, read
from converter.films.curve import Key, value_at
from converter.films.script import frame_scene, read_script
from converter.films.shift import shifted
from converter.films.writers import _durations
from converter.images.texture import read_texture
from converter.scene.model import Quadric
from converter.scene.parser import load_scene, parse_scene
from converter.shapes.table import shape_kind

FILMS = Path(__file__).parents[1] / "scenes" / "films"
NATIVE = ("--method", "native", "-q")
TEXT = """\
0 0 -10   0 0 0   0 1 0   40
2
0 0 0     .1 .2 .3     1 0 0
5 5 -9    .8 .7 .6  1 0 0  # sun
# both
2   solid 1 .5 .2
checker 1 1 1 0 0 0 2 # tiles
1   .2 .6 .3 20 .2 0 0
4
0 0 sphere 0 0 0 1  # ball
0 0 polyhedron 2
0 1 0 5
# ground glass
0 -1 0 -6
0 0 quadric 1 1 1 0 0 0 0 0 0 -1
0 0 csg 2
+ 0 0 sphere 0 3 0 1
- 0 0 sphere 0 3 1 .5 # ball
"""
KEYS = """\
[tracks."ball.sphere.center"]
keys = [[0, [0, 0, 0]], [1, [2, 0, 0]]]
"""


@pytest.fixture
def film(tmp_path):
    """Writes a scene with keyframes; its file."""

    def write(keys=KEYS, text=TEXT):
        (tmp_path / "s.in").write_text(text)
        (tmp_path / "s.toml").write_text(keys)
        return tmp_path / "s.in"

    return write


# ---- Curves


@pytest.mark.parametrize("easing", ["linear", "smooth", "catmull-rom"])
def test_a_curve_passes_through_its_keys(easing):
    keys = [Key(t, (t**2, -t / 3), easing) for t in (0.1, 0.7, 1.3, 4.9)]
    for key in keys:
        assert value_at(keys, key.time) == key.value
    assert value_at(keys, 0) == keys[0].value
    assert value_at(keys, 9) == keys[-1].value


def test_halfway():
    assert value_at([Key(1, (2.0,)), Key(3, (6.0,))], 1.5) == (3.0,)
    assert value_at([Key(0, (0.0,), "smooth"), Key(1, (1.0,))], 0.25) == (0.15625,)  # 3/16 - 2/64


def test_catmull_rom_has_what_is_straight_and_a_parabola_within():
    """The velocity at inner keys is a parabola's where times are even, so there the curve is one."""
    straight = [Key(t, (3 * t - 1,), "catmull-rom") for t in (0.0, 0.4, 1.5, 2.0)]
    parabola = [Key(t, (t * t,), "catmull-rom") for t in (0.0, 1.0, 2.0, 3.0)]
    for t in np.linspace(0, 2, 41):
        assert value_at(straight, t)[0] == pytest.approx(3 * t - 1, abs=1e-14)
    for t in np.linspace(1, 2, 21):
        assert value_at(parabola, t)[0] == pytest.approx(t * t, abs=1e-14)


def test_a_loop_has_no_seam():
    keys = [Key(t, (np.cos(np.pi * t / 2),), "catmull-rom") for t in (0.0, 1.0, 2.0, 3.0)]
    keys.append(Key(4.0, keys[0].value, "catmull-rom"))
    turned = [Key(t - 1, k.value, k.easing) for t, k in zip((1, 2, 3, 4, 5), (*keys[1:4], *keys[:2]), strict=True)]
    for t in np.linspace(0, 9, 91):
        assert value_at(keys, t + 1, loop=True) == pytest.approx(value_at(turned, t, loop=True), abs=1e-14)


# ---- Addresses


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("camera.eye", (0, 0, -10)),
        ("camera.eye.z", (-10,)),
        ("camera.eye[2]", (-10,)),
        ("camera.fovy", (40,)),
        ("lights[0].color", (0.1, 0.2, 0.3)),
        ("lights[1].color.g", (0.7,)),
        ("sun.position", (5, 5, -9)),
        ("both.color", (1, 0.5, 0.2)),
        ("tiles.size", (2,)),
        ("finishes[0].alpha", (20,)),
        ("objects[1].polyhedron.planes[1].d", (-6,)),
        ("objects[2].quadric[9]", (-1,)),
        ("objects[2].quadric.J", (-1,)),
        ("objects[3].csg[1].sphere.radius", (0.5,)),
        ("ball.sphere.center", (0, 0, 0)),
        ("ball.move", (0, 0, 0)),
        ("ball.shift", (0, 0, 0)),
    ],
)
def test_every_number_has_an_address(path, value):
    scene = parse_scene(TEXT)
    address = find_address(scene, path, names_of(scene, TEXT))
    assert read(scene, address) == value
    other = tuple(number + 0.25 for number in value)
    there = changed(scene, [(address, other)])
    if ".shift" not in path:
        assert read(there, address) == other
        assert changed(there, [(address, tuple(map(float, value)))]) == scene
    assert there != scene


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("camera.eye.w", "camera.eye has no 'w': there are 0 to 2 or a letter of 'xyz'"),
        ("camera.eyes", "camera has no 'eyes' (did you mean 'eye'?): there is camera.eye, camera.look_at"),
        ("camera", "camera is no number: there is camera.eye"),
        ("camera.eye.x.y", "camera.eye.x is one number"),
        ("lights[2].color", "lights has no 2: there are numbers from 0 to 1, as in lights[0]"),
        (
            "objects[0].cube.radius",
            "objects[0] has no 'cube': there is objects[0].sphere,",
        ),
        ("objects[1].sphere.radius", "objects[1] is a polyhedron, not a sphere"),
        ("objects.sphere", "objects has no 'sphere': there are numbers from 0 to 3"),
        ("bell.color", "there is no 'bell' (did you mean 'ball'?)"),
        ("camera eye", "there is no 'camera eye' (did you mean 'camera'?)"),
        ("camera..eye", "'camera..eye' is no path from '..eye' on"),
        ("[3]", "'[3]' is no path: one begins with camera, lights"),
    ],
)
def test_no_address(path, message):
    scene = parse_scene(TEXT)
    with pytest.raises(AddressError) as error:
        find_address(scene, path, names_of(scene, TEXT))
    assert str(error.value).startswith(message)


def test_a_name_of_two():
    text = TEXT.replace("# tiles", "# sun")
    scene = parse_scene(text)
    with pytest.raises(AddressError, match=r"'sun' is the name of lights\[1\] and pigments\[1\]"):
        find_address(scene, "sun.color", names_of(scene, text))


def test_shapes_are_displaced_as_points_are():
    random = np.random.default_rng(5)
    scene = parse_scene(TEXT)
    general = Quadric(tuple(float(x) for x in random.normal(size=10)))
    for shape in (*(o.shape for o in scene.objects), general):
        by = tuple(float(x) for x in random.normal(size=3))
        there = shifted(shape, by)
        for p in random.uniform(-4, 4, size=(200, 3)):
            q = tuple(float(x) for x in p + by)
            assert shape_kind(there).contains(there, q) == shape_kind(shape).contains(shape, tuple(map(float, p)))


# ---- Files of keyframes


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ("a = x\n", "s.toml:1: column 5: Invalid value"),
        ("a = " + "[" * 5000, "s.toml: maximum recursion depth exceeded"),
        ("a = " + "1" * 5000, "s.toml: Exceeds the limit"),
        (
            '[tracks."camera.fovy"]\nkeys=[[0, 1' + "0" * 400 + "]]",
            "s.toml:2: camera.fovy, key 1: its value must be a number, found 1000",
        ),
        ('[tracks."camera.eye"]\nkeys=[[nan, [0, 0, 0]]]', "s.toml:2: camera.eye, key 1: its time must be a number of"),
        ('[tracks."camera.fovy"]\nkeys=[[1e300, 40]]', "the last key is at 1e+300 s, which takes more than 1000000"),
        (
            '[tracks."camera.eye.x"]\nkeys=[[0, 1e308], [1, -1e308]]',
            "s.toml: frame 1 would be no scene: a number between two keys must be finite, found -inf",
        ),
        (
            f'[tracks."objects[{9 * "9"}9].shift"]\nkeys=[[0, 1]]',
            "s.toml:1: 'objects[9999999999].shift' is no path from '[9999999999].shift' on",
        ),
        ('[tracks."bull.x"]\nkeys=[[0, 1]]', "s.toml:1: there is no 'bull'"),
        ("\nshuter = 1\n", "s.toml:2: a file of keyframes has no 'shuter' (did you mean 'shutter'?)"),
        ("shutter = 2\n", "s.toml:1: shutter must be a share from 0 to 1, found 2"),
        ("", 's.toml: there are no tracks, as in [tracks."camera.eye"]'),
        ('\n[tracks."camera.eyes"]\nkeys=[[0, 1]]', "s.toml:2: camera has no 'eyes' (did you mean 'eye'?)"),
        ("[tracks.camera.eye]\nkeys=[[0, 1]]", "s.toml:2: camera.eye, key 1: its value must be 3 numbers, found 1"),
        (KEYS.replace("[1, [2", "[0, [2"), "s.toml:2: ball.sphere.center, key 2: its time, 0, is not after that"),
        (
            '[tracks."camera.fovy"]\nkeys = [\n[0, 40],\n[1, "x"],\n]',
            "s.toml:4: camera.fovy, key 2: its value must be a",
        ),
        (
            '[tracks."camera.fovy"]\nkeys = [[0, 40, "smoth"]]',
            "s.toml:2: camera.fovy: there is no easing 'smoth' (did you",
        ),
        ('[tracks."camera.fovy"]\nkey = 1', "s.toml:2: camera.fovy has no 'key' (did you mean 'keys'?)"),
        ('[tracks."camera.fovy"]\nkeys = [[0, 4], [1, 5]]\nloop = true', "s.toml:2: camera.fovy, key 2: a loop ends"),
        ("tracks = 1", "s.toml: there are no tracks"),
        ('[tracks]\n"camera.fovy" = 1', "s.toml:2: camera.fovy must be a table, as in [tracks.'camera.fovy']"),
        ('[tracks."camera.fovy"]\nkeys = []', "s.toml:1: camera.fovy has no keys, as in keys = [[0.0, 1], [2.0, 5]]"),
        ('[tracks."camera.fovy"]\nkeys = [[0]]', "s.toml:2: camera.fovy, key 1: must be [seconds, value], or have an"),
        ('[tracks."camera.fovy"]\nkeys = [[-1, 4]]', "s.toml:2: camera.fovy, key 1: its time must be a number of sec"),
        ('[tracks."camera.fovy"]\nkeys = [[0, 4]]\nloop = 1', "s.toml:1: loop must be true or false, found 1"),
        (
            '[tracks."ball.sphere.radius"]\nkeys = [[0, 1], [1, -1]]',
            "s.toml: frame 12 would be no scene: the radius must be above 0, found '0'\n",
        ),
    ],
)
def test_what_is_wrong_is_told_with_its_line(film, whitted, tmp_path, keys, message):
    text = TEXT.replace(".5 # ball", ".5")
    status, _, err = whitted("animate", film(keys, text), tmp_path / "f{frame:02}.png", 4, 3, *NATIVE)
    assert status == 2
    assert err.replace(f"{tmp_path}/", "").removeprefix("whitted animate: ").startswith(message)


def test_keyframes_are_text(film, whitted, tmp_path):
    scene = film(KEYS)
    (tmp_path / "s.toml").write_bytes(b"\xff\xfe")
    status, _, err = whitted("animate", scene, tmp_path / "f{frame:02}.png", 4, 3, *NATIVE)
    assert (status, "s.toml: this is no UTF-8 text" in err) == (2, True)


def test_frames_have_names_of_their_own(film, whitted, tmp_path):
    status, _, err = whitted("animate", film(KEYS), tmp_path / "f{frame:.0e}.png", 4, 3, *NATIVE)
    assert (status, "gives two frames one name" in err) == (2, True)
    assert not list(tmp_path.glob("*.png"))


def test_the_shutter_makes_moves_of_keyframes(film, tmp_path):
    """Of a centre and of a displacement, together; not of other numbers."""
    keys = "shutter = 0.5\n" + KEYS + '[tracks."objects[0].shift.y"]\nkeys = [[0, 0], [1, 4]]\n'
    keys += '[tracks."camera.fovy"]\nkeys = [[0, 40], [1, 50]]\n'
    file = film(keys)
    scene = load_scene(file)
    script = read_script(tmp_path / "s.toml", scene, TEXT)
    at_half = frame_scene(scene, script.changes(0.5, 0.1))
    ball = at_half.objects[0]
    assert ball.shape.center == (1, 2, 0)
    assert ball.move == pytest.approx((0.1, 0.2, 0))
    assert [o.move for o in at_half.objects[1:]] == [(0, 0, 0)] * 3
    assert at_half.camera.fovy == 45
    assert script.blurs
    assert not any(any(o.move) for o in frame_scene(scene, script.changes(2.0, 0.1)).objects)


# ---- Films


@pytest.mark.parametrize("ending", ["mp4", "webm", "gif", "webp", "png"])
def test_a_film(whitted, tmp_path, ending):
    """It has the pictures that a pattern gives, as well as its format can."""
    film, words = tmp_path / f"film.{ending}", (32, 24, "--frames", "5", "--fps", "5", *NATIVE)
    assert whitted("animate", FILMS / "orbit.in", film, *words) == (0, "", "")
    assert [file.name for file in tmp_path.iterdir()] == [film.name]
    assert whitted("animate", FILMS / "orbit.in", tmp_path / "{frame}.ppm", *words)[0] == 0
    wanted = [np.reshape(read_texture(tmp_path / f"{k}.ppm").texels, (24, 32, 3)) * 255 for k in range(5)]
    found = frames(film)
    assert len(found) == 5
    for one, other in zip(found, wanted, strict=True):
        assert np.abs(one - other).mean() < (0.5 if ending == "png" else 6)
    assert np.abs(found[4] - wanted[0]).mean() > 6


def frames(film):
    if film.suffix in (".mp4", ".webm"):
        import av

        with av.open(str(film)) as opened:
            assert opened.streams.video[0].average_rate == 5
            return [frame.to_ndarray(format="rgb24").astype(float) for frame in opened.decode(video=0)]
    from PIL import Image, ImageSequence

    with Image.open(film) as opened:
        durations = []
        pictures = []
        for frame in ImageSequence.Iterator(opened):
            pictures.append(np.asarray(frame.convert("RGB")).astype(float))
            durations.append(frame.info["duration"])
        assert sum(durations) == 1000
        return pictures


def test_durations_sum_up():
    assert _durations(24, Fraction(24), 10)[:4] == [40, 40, 40, 50]
    assert sum(_durations(1000, Fraction(30000, 1001), 1)) == round(1000 * 1000 * 1001 / 30000)


def test_into_a_pipe(capfdbinary):
    words = ("animate", FILMS / "orbit.in", "-", 16, 12, "--frames", "2", *NATIVE)
    assert main.main([*map(str, words), "--format", "gif"]) == 0
    told = capfdbinary.readouterr()
    assert told.out.startswith(b"GIF89a")
    assert main.main([*map(str, words)]) == 2
    assert b"--format says which one" in capfdbinary.readouterr().err


def test_a_second_start_draws_what_is_not_there(film, whitted, tmp_path):
    """What is missing, damaged, or of another scene, option or keyframe, and nothing else."""
    scene, pattern = film(), tmp_path / "new" / "{frame}.ppm"
    folder = pattern.parent

    def drawn(*options):
        before = {file.name: file.stat().st_ino for file in folder.glob("*.ppm")} if folder.exists() else {}
        words = ("animate", scene, pattern, 8, 6, "--frames", "3", "--fps", "3", *NATIVE, *options)
        assert whitted(*words) == (0, "", "")
        return {f.name[0] for f in folder.glob("*.ppm") if before.get(f.name) != f.stat().st_ino}

    assert drawn() == {"0", "1", "2"}
    assert drawn() == set()
    (folder / "1.ppm").unlink()
    (folder / "2.ppm").write_bytes((folder / "2.ppm").read_bytes()[:-1])
    assert drawn() == {"1", "2"}
    (tmp_path / "s.toml").write_text(KEYS.replace("[2, 0, 0]", "[3, 0, 0]"))
    assert drawn() == {"1", "2"}
    assert drawn("--samples", "4") == {"0", "1", "2"}
    assert drawn("--samples", "4", "--threads", "1") == set()
    assert drawn("--samples", "4", "--anew") == {"0", "1", "2"}
    film(KEYS, TEXT.replace(".8 .7 .6", ".8 .7 .5"))
    assert drawn() == {"0", "1", "2"}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--fps", "1e-9"), "argument --fps: must lie between 0.001 and 1000, found 1e-9"),
        (("--fps", "-1"), "argument --fps: must lie between 0.001 and 1000, found -1"),
        (("--keys", "no.toml"), "no.toml: there is no such file of keyframes; --keys names another"),
    ],
)
def test_options_that_make_no_film(film, whitted, tmp_path, words, message):
    status, _, err = whitted("animate", film(), tmp_path / "f.gif", 4, 3, *NATIVE, *words)
    assert (status, err.startswith(f"whitted animate: {message}")) == (2, True), err


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("{frame:.png", "FILM: '{frame:.png' is no pattern: "),
        ("{frame:9999999999}.png", "FILM: '{frame:9999999999}.png' asks for a name of more than 999 characters"),
        ("{frame}.avi/a", "0.avi/a: no ending that says which picture format is meant"),
        ("a/{frame}.avi", "a/0.avi: unknown picture format '.avi'"),
        ("s.in/{frame}.png", "s.in: this is a file, and a folder is needed"),
    ],
)
def test_names_that_are_no_film(film, whitted, tmp_path, monkeypatch, name, message):
    monkeypatch.chdir(tmp_path)
    film()
    status, _, err = whitted("animate", "s.in", name, 4, 3, *NATIVE)
    assert (status, err.startswith(f"whitted animate: {message}")) == (2, True), err
    assert {file.name for file in tmp_path.iterdir()} == {"s.in", "s.toml"}


def test_two_commands_at_once(film, whitted, tmp_path):
    """The second is refused, for the first removes the pictures that both would have."""
    words = ("animate", film(), tmp_path / "f.gif", 4, 3, "--frames", "2", *NATIVE, "-q")
    folder = tmp_path / "f.gif.frames"
    folder.mkdir()
    with only_one(folder) as alone:
        assert alone
        status, _, err = whitted(*words)
    assert status == 2
    assert "another command draws this film at this moment" in err
    assert folder.is_dir()
    assert whitted(*words) == (0, "", "")
    assert not folder.exists()


def test_one_picture_is_no_pictures(film, whitted, tmp_path):
    _, _, err = whitted("animate", film(), tmp_path / "f.gif", 4, 3, "--frames", "1", *NATIVE[:2])
    assert ": 1 picture, 4 x 3" in err


def test_a_manifest_that_is_damaged(tmp_path):
    """What is added to it counts all the same."""
    (tmp_path / MANIFEST).write_bytes(b"\xff\x80\n")
    Manifest(tmp_path).write(tmp_path / "a.ppm", "source", b"picture")
    assert Manifest(tmp_path).has(tmp_path / "a.ppm", "source")


def test_a_manifest_that_was_cut_short(tmp_path):
    """The line is before the picture, and a line that is cut is none."""
    source = digest_of("a")
    Manifest(tmp_path).write(tmp_path / "a.ppm", source, b"picture")
    assert Manifest(tmp_path).has(tmp_path / "a.ppm", source)
    whole = (tmp_path / MANIFEST).read_text()
    (tmp_path / MANIFEST).write_text(whole[:-20])
    assert not Manifest(tmp_path).has(tmp_path / "a.ppm", source)
    (tmp_path / MANIFEST).write_text(whole)
    (tmp_path / "a.ppm").write_bytes(b"pict")
    assert not Manifest(tmp_path).has(tmp_path / "a.ppm", source)


@pytest.mark.parametrize("scene", sorted(FILMS.glob("*.in")), ids=lambda file: file.stem)
def test_films_of_the_project(scene):
    """Every frame is a scene, and the last is followed by the first."""
    text = scene.read_text()
    found = load_scene(scene)
    script = read_script(scene.with_suffix(".toml"), found, text)
    for time in np.linspace(0, script.seconds, 17):
        frame_scene(found, script.changes(float(time), 1 / 24))
    begin, end = (dict(script.changes(time, 1 / 24)) for time in (0.0, script.seconds))
    assert any(address.steps[2:] != ("move",) for address in begin)
    for address, value in begin.items():
        assert address.steps[2:] == ("move",) or end[address] == pytest.approx(value, abs=1e-9)
