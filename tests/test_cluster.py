"""Pictures drawn by workers of Dask: the same bytes, whatever happens to the workers."""

import gc
import os
import signal
from argparse import Namespace
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from itertools import pairwise
from pathlib import Path

import pytest
from distributed import Client, LocalCluster

from converter.batch import cluster as dask
from converter.batch import pictures
from converter.batch.pictures import Job, Picture, draw_picture, tiles_of
from converter.batch.run import Wanted
from converter.batch.worker import draw_at_worker
from converter.scene.parser import load_scene
from converter.scene.settings import Settings

SCENES = Path(__file__).parents[1] / "scenes"
NATIVE = ("--method", "native", "-q")


@pytest.fixture(scope="module")
def scheduler():
    """The address of a scheduler with two workers, each a process."""
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50) as local:
        yield local.scheduler_address


def pids(address):
    with Client(address, set_as_default=False) as client:
        return list(client.run(os.getpid, on_error="ignore").values())  # one may have been killed just now


def files(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir() if file.name[0] != "."}


def test_a_film_has_the_same_bytes(whitted, scheduler, tmp_path):
    words = (24, 18, "--frames", "7", "--fps", "3", *NATIVE)
    for folder, more in (("one", ()), ("two", ("--scheduler", scheduler))):
        assert whitted("animate", SCENES / "films/orbit.in", tmp_path / folder / "{frame}.png", *words, *more) == (
            0,
            "",
            "",
        )
    assert len(files(tmp_path / "one")) == 7
    assert files(tmp_path / "one") == files(tmp_path / "two")


def test_scenes_with_textures_and_a_bad_one(whitted, scheduler, tmp_path):
    """Textures go with them: workers do not look for files."""
    bad = tmp_path / "bad.in"
    bad.write_text("nonsense")
    scenes = [SCENES / "figure1.in", bad, SCENES / "tiles.in", SCENES / "sampled/dew.in"]
    words = ("--size", "24x18", *NATIVE)
    for folder, more in (("one", ()), ("two", ("--scheduler", scheduler))):
        status, _, err = whitted("render", *scenes, "-o", tmp_path / folder / "{name}.ppm", *words, *more)
        assert status == 2
        assert err.count("bad.in:1:1") == 1
    assert len(files(tmp_path / "one")) == 3
    assert files(tmp_path / "one") == files(tmp_path / "two")


def test_a_worker_needs_no_texture_file(tmp_path):
    texture = tmp_path / "t.ppm"
    texture.write_bytes(b"P6 2 1 255\n\xff\x00\x00\x00\x00\xff")
    (tmp_path / "s.in").write_text(
        "0 0 -10 0 0 0 0 1 0 40 2 0 0 0 1 1 1 1 0 0 5 5 -9 .8 .8 .8 1 0 0\n"
        "1 texmap t.ppm .3 0 0 0 0 .3 0 0  1 .5 .5 0 1 0 0 0  1 0 0 sphere 0 0 0 3\n"
    )
    job = Job(load_scene(tmp_path / "s.in"), Settings(12, 9), "native", None, ".ppm")
    here = draw_picture(job, Picture()).data
    blob = dask.Blob("digest.ppm", texture.read_bytes())
    texture.unlink()
    (there,) = draw_at_worker(("job", job), [(str(texture), blob)], [Picture()])
    assert there.data == here


@pytest.mark.parametrize("crop", [None, (3, 5, 60, 47)])
def test_tiles_make_the_picture(scheduler, monkeypatch, crop):
    monkeypatch.setattr(pictures, "TILE_RAYS", 700)
    settings = Settings(64, 48, samples=4, crop=crop, threads=1)
    job = Job(load_scene(SCENES / "figure1.in"), settings, "native", None, ".png")
    tiles = tiles_of(settings, 4)
    assert len(tiles) > 10
    assert tiles[0][1] == settings.drawn[1]
    assert tiles[-1][3] == settings.drawn[3]
    assert all(one[3] == other[1] for one, other in pairwise(tiles))
    shares = []
    with dask.cluster(None, scheduler, True) as found:
        ((number, drawn),) = dask.drawn_by(found, [Wanted(5, job)], 1, shares.append)
    whole = draw_picture(job, Picture())
    assert number == 5
    assert drawn.data == whole.data
    for name in ("rays", "shadow", "deepest", "pixels_too_deep"):
        assert drawn.statistics[name] == whole.statistics[name]
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1)


def test_killed_workers_cost_time_only(scheduler):
    """Both are killed by force in the middle."""
    job = Job(load_scene(SCENES / "figure1.in"), Settings(160, 120, threads=1), "native", None, ".ppm")
    settings = [replace(job.settings, background=(k / 100, 0.0, 0.0)) for k in range(60)]
    wanted = [Wanted(k, replace(job, settings=each)) for k, each in enumerate(settings)]
    found, killed = {}, []
    with dask.cluster(None, scheduler, True) as there:
        for number, drawn in dask.drawn_by(there, wanted, len(wanted), lambda _: None):
            assert number not in found
            assert not isinstance(drawn, Exception)
            found[number] = drawn.data
            if len(found) in (5, 20):
                killed.append(pids(scheduler)[0])
                os.kill(killed[-1], signal.SIGKILL)
    assert len(set(killed)) == 2
    assert sorted(found) == list(range(60))
    assert all(found[k] == draw_picture(wanted[k].job, Picture()).data for k in (0, 19, 21, 59))


def test_what_a_worker_had_drawn_when_it_died_is_waited_for():
    """However long it takes others to draw it again."""
    answers = [TimeoutError(), TimeoutError(), ["drawn"]]

    def result(timeout):
        if isinstance(answer := answers.pop(0), Exception):
            raise answer
        return answer

    future = Namespace(result=result, status="pending")
    assert dask._results(Namespace(status="running"), future, 1) == ["drawn"]
    answers.append(TimeoutError())
    with pytest.raises(dask.ClusterError, match="the scheduler is gone"):
        dask._results(Namespace(status="closed"), future, 1)


def test_a_worker_that_waits_in_vain_says_so(scheduler):
    """For a disk, say: its own timeout is none of ours."""
    with Client(scheduler, set_as_default=False) as client:
        future = client.submit(_wait_in_vain, pure=False)
        assert [str(error) for error in dask._results(client, future, 2)] == ["the disk does not answer"] * 2


def _wait_in_vain():
    raise TimeoutError("the disk does not answer")


def test_tasks_get_shorter_at_the_end():
    """So that workers are done at about the same time, and a task costs the scheduler little."""
    left, sizes = 500, []
    while left:
        sizes.append(min(dask._task_size(0.01, left, 2), left))
        left -= sizes[-1]
    assert sizes[0] == 50  # half a second's
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[-2] == 5
    assert len(sizes) < 25
    assert [dask._task_size(seconds, 500, 2) for seconds in (0.0, 0.1, 3.0)] == [50000, 5, 1]


def test_workers_may_come_later(whitted, tmp_path, monkeypatch):
    """They are waited for, and each that comes has something to do."""
    monkeypatch.setattr(dask, "COUNTING_SECONDS", 0.0)
    count_workers, counted = dask._Sending.count_workers, []
    words = ("animate", SCENES / "films/orbit.in", tmp_path / "{frame}.ppm", 40, 30, "--frames", "30", *NATIVE[:2])
    with LocalCluster(n_workers=0, processes=False, dashboard_address=":0", silence_logs=50) as local:

        def count(sending):
            if len(counted) == 1:
                sending._client.wait_for_workers(2)  # else the first may have drawn all before the other is there
            count_workers(sending)
            if not counted:
                local.scale(2)
            counted.append((sending.workers, sending.room))

        monkeypatch.setattr(dask._Sending, "count_workers", count)
        status, _, err = whitted(*words, "--scheduler", local.scheduler_address)
    assert status == 0
    assert "there are no workers yet; those that come draw" in err
    assert len(files(tmp_path)) == 30
    assert (counted[0], counted[-1]) == ((1, 3), (2, 6))


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (PackageNotFoundError("whitted"), "does not have this package: pip install 'whitted[cluster]'"),
        ("0.0.1", "has whitted 0.0.1, and this is "),
    ],
)
def test_workers_with_another_package(whitted, scheduler, tmp_path, monkeypatch, answer, message):
    """They would die of what is sent to them, or draw other pictures."""
    run, asked = Client.run, []

    def answered(client, function, *words, **options):
        asked.append(run(client, function, *words, **options))
        return dict.fromkeys(asked[-1], answer)

    monkeypatch.setattr(Client, "run", answered)
    words = (SCENES / "films/orbit.in", tmp_path / "{frame}.ppm", 8, 6, "--frames", "2", *NATIVE)
    status, _, err = whitted("animate", *words, "--scheduler", scheduler)
    assert status == 2
    assert err.startswith("whitted animate: the worker at tcp://")
    assert message in err
    assert set(asked[0].values()) == {version("whitted")}


def test_a_scheduler_that_goes_loses_no_picture(whitted, tmp_path, monkeypatch):
    """What is drawn is there, and the same command goes on from it."""
    monkeypatch.setattr(dask, "PATIENCE", 0.5)
    monkeypatch.setattr(dask, "_task_size", lambda *_: 1)  # else all may be drawn in the first task
    words = ("animate", SCENES / "films/orbit.in", tmp_path / "{frame}.ppm", 40, 30, "--frames", "40", *NATIVE)
    local = LocalCluster(n_workers=1, processes=False, dashboard_address=":0", silence_logs=50)
    finished = dask._finished

    def leave(client, futures):
        if len(files(tmp_path)) >= 3:
            local.close()
        return finished(client, futures)

    monkeypatch.setattr(dask, "_finished", leave)
    status, _, err = whitted(*words, "--scheduler", local.scheduler_address)
    assert status == 2
    assert "the same command goes on from there" in err
    there = files(tmp_path)
    assert 3 <= len(there) < 40
    times = {name: (tmp_path / name).stat().st_mtime_ns for name in there}
    assert whitted(*words)[0] == 0
    assert times == {name: (tmp_path / name).stat().st_mtime_ns for name in there}
    assert len(files(tmp_path)) == 40
    assert {file.name for file in tmp_path.iterdir() if file.name[0] == "."} == {".whitted-pictures"}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ("--workers", "2", "--scheduler", "tcp://127.0.0.1:1"),
            "--workers and --scheduler: the scheduler has its own",
        ),
        (("--workers", "0"), "argument --workers: must lie between 1 and 1024, found 0"),
        (("--scheduler", "tcp://127.0.0.1:1"), "--scheduler: nothing answers at 'tcp://127.0.0.1:1'"),
        (("--scheduler", "here"), "--scheduler: nothing answers at 'here'"),
        (("--scheduler", "tls://127.0.0.1:1"), "--scheduler: nothing answers at 'tls://127.0.0.1:1': TLS expects"),
        (("--workers", "2", "--adaptive", "8"), "--adaptive: not with --workers or --scheduler"),
    ],
)
def test_usage(whitted, tmp_path, monkeypatch, options, message):
    monkeypatch.setattr(dask, "PATIENCE", 0.5)
    status, _, err = whitted("render", SCENES / "figure1.in", tmp_path / "a.ppm", 8, 6, *NATIVE, *options)
    assert status == 2
    assert err.startswith(f"whitted render: {message}")
    assert not list(tmp_path.iterdir())
    # One that is collected later, in a thread that Dask starts, waits for that thread, which waits for it.
    assert not [each for each in gc.get_objects() if issubclass(type(each), Client) and each.status != "closed"]


def test_workers_of_our_own(tmp_path):
    job = Job(load_scene(SCENES / "figure1.in"), Settings(16, 12), "native", None, ".ppm")
    arguments = Namespace(workers=1, scheduler=None, quiet=True)
    from converter.batch.run import draw_pictures

    with draw_pictures(arguments, [Wanted(0, job)], 1, lambda _: None) as results:
        assert [drawn.data for _, drawn in results] == [draw_picture(job, Picture()).data]
