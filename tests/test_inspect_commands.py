"""What scenes and single pixels are told to be: `whitted inspect` and `whitted pixel`."""

import json

import pytest
from command_scenes import SCENE
from variant import VARIANT

from converter.renderers.native import NativeRenderer

ON_VARIANT = ("--variant", VARIANT)


# ---- inspect


def test_inspect(whitted, scene):
    status, out, err = whitted("inspect", scene)
    assert (status, err) == (0, "")
    assert out.splitlines()[0] == str(scene)
    assert "3 spheres" in out
    assert "shadows, highlights, reflection, refraction" in out
    assert "rays split in two" in out
    assert "unused pigments  2" in out
    assert "note: " in out


def test_inspect_json(whitted, scene, tmp_path):
    status, out, _ = whitted("inspect", scene, "--json", "-", "--max-depth", "5")
    found = json.loads(out)
    assert status == 0
    assert found["objects"] == {
        "count": 3,
        "kinds": {"sphere": 3},
        "planes": 0,
        "redundant_planes": 0,
        "unbounded": 0,
    }
    assert found["needs"]["max_depth"] == 5
    assert found["unused"] == {"pigments": [2], "finishes": []}
    assert found["finishes"][2]["ior_read_as"] == "n2/n1"
    assert found["finishes"][0]["ior_read_as"] is None
    assert [pigment["objects"] for pigment in found["pigments"]] == [2, 1, 0]
    assert 0 < found["cutoff"]["bound"] < 1
    assert len(found["notices"]) == 1
    whitted("inspect", scene, "--json", tmp_path / "a.json", "--max-depth", "5")
    assert json.loads((tmp_path / "a.json").read_text()) == found


@pytest.mark.parametrize(
    ("old", "new", "cutoff", "told"),
    [
        (".1 .1 .3 100 .1 .8 1.5", "1 0 0 1 0 0 0", 1 / 512, "1/512: no channel is off by more than 0.00"),
        (".1 .1 .3 100 .1 .8 1.5", "1 0 0 1 0 0 0", 0, "0: drops no ray"),
        (
            ".2 .6 .3 20 .2 0 0",
            "1 0 0 1 0 0 0",
            0.3,
            "0.3: the bound is loose here; whitted compare --reference native:cutoff=1/4096",
        ),
        (
            "5 5 -9 .8 .8 .8 1 0 0",
            "1 0 0 .8 .8 .8 0 1 0",
            1 / 512,
            "light 1's attenuation may be 0 on object 0 (line 17)",
        ),
    ],
)
def test_inspect_tells_what_the_cut_off_costs(whitted, tmp_path, old, new, cutoff, told):
    file = tmp_path / "a.in"
    file.write_text(SCENE.replace(old, new))
    status, out, _ = whitted("inspect", file, "--cutoff", cutoff)
    (line,) = [line for line in out.splitlines() if line.startswith("cut-off")]
    assert status == 0
    assert told in line


def test_inspect_names_the_methods_that_fail_in_one_line(whitted, scene):
    scene.write_text(SCENE.replace("0 0 sphere 0 0 0 1", "0 0 sphere 0 0 1e7 1"))
    _, out, _ = whitted("inspect", scene)
    told = [line for line in out.splitlines() if "known to fail" in line]
    assert len(told) == 1
    assert told[0].startswith("note: other methods are known to fail here: native-float, ")
    assert len(json.loads(whitted("inspect", scene, "--json", "-")[1])["warnings"]) > 2
    scene.write_text(SCENE.replace("0 0 sphere 0 0 0 1", "0 0 sphere 0 0 1e15 1"))
    assert "\nwarning: " in whitted("inspect", scene)[1]  # the default fails, too


def test_inspect_finds_planes_that_cut_nothing(whitted, tmp_path):
    file = tmp_path / "a.in"
    cube = "0 0 polyhedron 7 1 0 0 -1 -1 0 0 -1 0 1 0 -1 0 -1 0 -1 0 0 1 -1 0 0 -1 -1 1 0 0 -5"
    slab = "0 0 polyhedron 2 0 1 0 3 0 -1 0 -4"
    file.write_text(SCENE.replace("\n3\n0 0 sphere 0 0 0 1\n", f"\n5\n{cube}\n{slab}\n0 0 sphere 0 0 0 1\n"))
    _, out, _ = whitted("inspect", file, "--json", "-")
    found = json.loads(out)
    assert found["objects"]["redundant_planes"] == 1
    assert found["objects"]["unbounded"] == 1
    assert [(p["redundant_planes"], p["bounded"]) for p in found["polyhedra"]] == [([6], True), ([], False)]
    _, out, _ = whitted("inspect", file)
    assert "9, redundant: 1" in out
    assert "unbounded" in out and " 1 object\n" in out


def test_inspect_names_quadrics(whitted, tmp_path):
    file = tmp_path / "a.in"
    cone, slab = "0 0 quadric 1 1 -1 0 0 0 0 0 0 0", "0 0 quadric 1 0 0 0 0 0 0 0 0 -1"
    ball, outside = "0 0 quadric 1 1 1 0 0 0 0 0 0 -1", "0 0 quadric -1 -1 -1 0 0 0 0 0 0 1"
    file.write_text(SCENE.replace("\n3\n0 0 sphere", f"\n7\n{cone}\n{slab}\n{ball}\n{outside}\n0 0 sphere"))
    _, out, _ = whitted("inspect", file, "--json", "-")
    found = json.loads(out)
    assert found["objects"]["kinds"] == {"quadric": 4, "sphere": 3}
    assert found["objects"]["unbounded"] == 3
    assert [(q["kind"], q["drawn_as"], q["bounded"]) for q in found["quadrics"]] == [
        ("cone", "quadric", False),
        ("parallel planes", "polyhedron", False),
        ("ellipsoid", "sphere", True),
        ("complement of an ellipsoid", "quadric", False),
    ]
    _, out, _ = whitted("inspect", file)
    assert "unbounded" in out and " 3 objects\n" in out
    assert "complement of an ellipsoid" in out


def test_json_into_no_folder(whitted, scene, tmp_path):
    status, _, err = whitted("inspect", scene, "--json", tmp_path / "nowhere" / "a.json")
    assert status == 2
    assert err == f"whitted inspect: {tmp_path}/nowhere/a.json: there is no folder '{tmp_path}/nowhere'\n"


# ---- pixel


def test_pixel_of_one_renderer(whitted, scene):
    status, out, err = whitted("pixel", scene, 20, 14, 40, 30, "--method", "native", "-q")
    assert (status, err) == (0, "")
    lines = out.splitlines()
    assert lines[0] == f"{scene} at 40 x 30, pixel (20, 14): native"
    assert "#0 sphere (17)" in lines[3]
    assert "light 1 adds" in lines[4]
    assert lines[-1].startswith("colour  native  ")


def test_pixel_by_two_methods_of_one_initial(whitted, scene, monkeypatch):
    right = NativeRenderer.trace_pixel

    def wrong(self, *arguments):
        tree = right(self, *arguments)
        tree.rays[0].hit.t += 0.25 if self.precision == "float" else 0.0
        return tree

    monkeypatch.setattr(NativeRenderer, "trace_pixel", wrong)
    _, out, _ = whitted("pixel", scene, 20, 14, 40, 30, "--method", "native-float", "-q")
    assert "pixel (20, 14): native | native-float\n" in out
    assert [line[:11] for line in out.splitlines() if line.startswith(">")][::2] == [">1 primary ", ">2 primary "]


def test_pixel_by_a_method_that_does_not_tell_its_rays(whitted, scene, monkeypatch):
    monkeypatch.delattr(NativeRenderer, "trace_pixel")
    status, _, err = whitted("pixel", scene, 20, 14, 40, 30, "--method", "native")
    assert (status, err.splitlines()[0]) == (2, "whitted pixel: native does not tell its rays")


@pytest.mark.parametrize(("x", "y"), [(40, 0), (0, 30)])
def test_pixel_outside_the_picture(whitted, scene, x, y):
    status, _, err = whitted("pixel", scene, x, y, 40, 30)
    assert status == 2
    assert f"pixel ({x}, {y}) lies outside the picture of 40 x 30 pixels" in err


def test_pixel_in_both_renderers(whitted, scene, mi):
    status, out, _ = whitted("pixel", scene, 20, 14, 40, 30, *ON_VARIANT)
    assert status == 0
    assert "\nno difference\n" in out
    _, out, _ = whitted("pixel", scene, 20, 14, 40, 30, "--json", "-", "-q", *ON_VARIANT)
    trees = json.loads(out)
    assert list(trees) == ["native", "mitsuba"]
    assert all(tree["rays"][0]["hit"]["object"] == 0 for tree in trees.values())


def test_pixel_marks_and_tells_the_first_difference(whitted, scene, monkeypatch):
    from converter.renderers.mitsuba import MitsubaRenderer

    def wrong(self, scene, settings, x, y):
        tree = NativeRenderer().trace_pixel(scene, settings, x, y)
        tree.rays[0].hit.t += 0.25
        return tree

    monkeypatch.setattr(MitsubaRenderer, "trace_pixel", wrong)
    _, out, _ = whitted("pixel", scene, 20, 14, 40, 30, "-q")
    marked = [line for line in out.splitlines() if line.startswith(">")]
    assert marked[0].startswith(">n primary")
    assert any(line.startswith(">m primary") for line in marked)
    assert "first difference: the primary ray at depth 0 of throughput 1\n" in out
    assert out.splitlines()[-1].startswith("t ")
