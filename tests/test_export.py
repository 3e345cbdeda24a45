"""`whitted convert`: a folder that Mitsuba loads, whose picture is `whitted render`'s."""

import errno
import subprocess
import sys

import numpy as np
import pytest
from variant import VARIANT

import mitsuba_plugins
from converter.errors import ExportError
from converter.images.texture import read_texture
from converter.images.write import write_image
from converter.renderers.mitsuba import MitsubaRenderer
from converter.scene.model import Texmap
from converter.scene.settings import Settings
from converter.to_mitsuba.export import export_scene


@pytest.fixture
def textured(small_scene, tmp_path):
    from dataclasses import replace

    file = tmp_path / "steps.ppm"
    file.write_bytes(b"P6 3 2 255\n" + bytes(range(0, 180, 10)))
    pigments = (
        *small_scene.pigments[:1],
        Texmap(file, (0.7, 0.1, 0.0, 0.2), (0.0, 0.9, 0.3, 0.0)),
        *small_scene.pigments[2:],
    )
    return replace(small_scene, pigments=pigments)


def test_same_bits_as_render(mi, textured, tmp_path):
    settings = Settings(width=160, height=120, samples=4)
    files = export_scene(textured, settings, tmp_path / "out")
    assert [file.name for file in files if not file.exists()] == []
    exported = np.asarray(mi.render(mi.load_file(str(files[0]))))
    rendered = MitsubaRenderer(VARIANT).render(textured, settings)
    assert np.array_equal(exported, rendered.pixels)


@pytest.mark.parametrize("name", ["picture.png", "picture.ppm", "picture.exr"])
def test_what_the_readme_shows_writes_the_bytes_of_render(small_scene, tmp_path, name):
    """In a fresh process, word by word; and what it warns of is true."""
    settings = Settings(width=40, height=30)
    folder = export_scene(small_scene, settings, tmp_path / "out")[0].parent
    program = "\n".join(
        line[4:] for line in (folder / "README.txt").read_text().splitlines() if line.startswith("    ")
    )
    assert program.splitlines()[-1] == 'mitsuba_plugins.write_image("picture.png", image)'
    program = program.replace("set_variant()", "set_variant('llvm_ad_rgb')").replace("picture.png", name)
    program += "\nmitsuba.util.write_bitmap('bitmap.png', image, write_async=False)"
    subprocess.run([sys.executable, "-c", program], cwd=folder, check=True)
    rendered = MitsubaRenderer("llvm_ad_rgb").render(small_scene, settings)
    write_image(tmp_path / name, rendered.pixels, 40, 30)
    assert (folder / name).read_bytes() == (tmp_path / name).read_bytes()
    bitmap = np.asarray(read_texture(folder / "bitmap.png").texels)
    ours = np.clip(rendered.pixels, 0, 1)
    assert (bitmap >= ours - 1 / 255).all()
    assert (np.abs(bitmap - ours) > 1 / 255).any(axis=2).mean() > 0.9


def test_an_image_of_another_shape_is_refused(tmp_path):
    for shape in ((4, 4), (4, 4, 4), (0, 4, 3)):
        with pytest.raises(ValueError, match="expected"):
            mitsuba_plugins.write_image(tmp_path / "a.png", np.zeros(shape))
    assert list(tmp_path.iterdir()) == []


def test_merged_meshes(mi, small_scene, tmp_path, capfd):
    """Mitsuba's default is to merge meshes of one material: nothing to the exact surfaces, but Embree's are lost."""
    from dataclasses import replace

    floor, *_, block = small_scene.objects
    two = replace(small_scene, objects=(floor, replace(block, pigment=floor.pigment, finish=floor.finish)))
    settings = Settings(width=8, height=6)
    file = export_scene(two, settings, tmp_path / "out")[0]
    rendered = MitsubaRenderer(VARIANT).render(two, settings)
    assert np.array_equal(np.asarray(mi.render(mi.load_file(str(file)))), rendered.pixels)

    file.write_text(file.read_text().replace('name="intersections" value="auto"', 'name="intersections" value="mesh"'))
    with pytest.raises(RuntimeError) as error:
        mi.render(mi.load_file(str(file)))
    assert "optimize=False" in _causes(error.value)
    assert np.asarray(mi.render(mi.load_file(str(file), optimize=False))).max() > 0


def _causes(error):
    return str(error) + (_causes(error.__cause__) if error.__cause__ else "")


def test_loads_on_one_core(small_scene, tmp_path):
    """Shows why `backend` starts a worker: without one Mitsuba's `load_file` never returns."""
    import os

    file = export_scene(small_scene, Settings(width=4, height=3), tmp_path / "out")[0]
    program = (
        f"import os; os.sched_setaffinity(0, {{{min(os.sched_getaffinity(0))}}})\n"
        "import mitsuba_plugins; mitsuba_plugins.set_variant('llvm_ad_rgb')\n"
        f"import mitsuba; mitsuba.load_file({str(file)!r})"
    )
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)


def test_meshes_too(mi, textured, tmp_path):
    """With the intersections through Embree, so that the PLY files are what is hit."""
    settings = Settings(width=160, height=120)
    files = export_scene(textured, settings, tmp_path / "out")
    files[0].write_text(
        files[0].read_text().replace('name="intersections" value="auto"', 'name="intersections" value="mesh"')
    )
    exported = np.asarray(mi.render(mi.load_file(str(files[0]), optimize=False)))
    rendered = MitsubaRenderer(VARIANT, "mesh").render(textured, settings)
    assert np.array_equal(exported, rendered.pixels)


def test_refuses_a_file(small_scene, tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(ExportError, match=r"thesis\.tex is a file: expected a folder"):
        export_scene(small_scene, Settings(), tmp_path / "thesis.tex")
    assert (tmp_path / "thesis.tex").read_text() == "years of work"


def test_refuses_a_folder_with_other_files(small_scene, tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(ExportError, match="new or empty folder"):
        export_scene(small_scene, Settings(), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_a_full_disk_leaves_the_earlier_export(small_scene, textured, tmp_path, monkeypatch):
    folder = tmp_path / "out"
    before = {file: file.read_bytes() for file in export_scene(textured, Settings(), folder)}

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("converter.to_mitsuba.meshes.write_ply", full)
    for target in (folder, tmp_path / "new"):
        with pytest.raises(OSError, match="No space"):
            export_scene(small_scene, Settings(), target)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
    assert not (tmp_path / "new").exists()


def test_a_readme_that_is_no_text_is_of_no_export(small_scene, tmp_path):
    (tmp_path / "README.txt").write_bytes(b"\xff\xfe")
    with pytest.raises(ExportError, match="new or empty folder"):
        export_scene(small_scene, Settings(), tmp_path)


def test_replaces_an_earlier_export(small_scene, textured, tmp_path):
    folder = tmp_path / "out"
    assert (folder / "textures") not in [file.parent for file in export_scene(small_scene, Settings(), folder)]
    export_scene(textured, Settings(), folder)
    files = export_scene(small_scene, Settings(), folder)
    assert sorted(path for path in folder.rglob("*") if path.is_file()) == sorted(files)
    assert not (folder / "textures").exists()
