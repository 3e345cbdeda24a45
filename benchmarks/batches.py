"""What drawing many pictures costs: workers' efficiency, and how a worker's memory grows.

python benchmarks/batches.py efficiency [FRAMES]   500 frames: one process, two that share nothing, two workers
python benchmarks/batches.py memory [SCENES]       memory of a process over 10,000 scenes, by native and by Mitsuba
"""

import sys
import time
from multiprocessing import get_context
from multiprocessing.synchronize import Barrier
from pathlib import Path
from statistics import median

from converter.batch.cluster import Cluster, cluster, drawn_by
from converter.batch.pictures import Job, Picture, draw_picture
from converter.batch.run import Wanted
from converter.films.script import Changes, read_script
from converter.scene.parser import load_scene
from converter.scene.settings import Settings

FILM = Path(__file__).parents[1] / "scenes" / "films" / "carving.in"
WORKERS = 2
ROUNDS = 9


def main(what: str, count: int | None = None) -> None:
    """Print it."""
    if what == "efficiency":
        efficiency(count or 500)
    else:
        memory(count or 10_000)


def job_of(method: str, width: int, height: int) -> tuple[Job, list[Changes]]:
    """A film, and what changes in its frames, a hundred of which are a turn."""
    scene = load_scene(FILM)
    script = read_script(FILM.with_suffix(".toml"), scene, FILM.read_text())
    job = Job(scene, Settings(width=width, height=height, threads=1), method, None, ".png")
    return job, [script.changes(k * script.seconds / 100, 1 / 24) for k in range(100)]


def efficiency(count: int) -> None:
    """Wall-clock time of frames at 320 x 240, one thread each.

    Ideal is what as many processes take that draw their shares and know nothing of one another: two hardware threads
    may be less than twice one. Medians of rounds in turn.
    """
    job, changes = job_of("native", 320, 240)
    pictures = [Picture(changes[k % len(changes)]) for k in range(count)]
    alone, apart, together = [], [], []
    begun = time.perf_counter()
    with cluster(WORKERS, None, True) as found:
        start = time.perf_counter() - begun
        _draw_together(found, job, pictures[: 2 * WORKERS])
        for _ in range(ROUNDS):
            begun = time.perf_counter()
            for picture in pictures:
                draw_picture(job, picture)
            alone.append(time.perf_counter() - begun)
            apart.append(_apart(job, pictures))
            together.append(_draw_together(found, job, pictures))
    each, ideal = median(alone), median(apart)
    share = median(one / other for one, other in zip(apart, together, strict=True))
    print(f"{count} frames, one process: {each:.2f} s, {1000 * each / count:.1f} ms a frame")
    print(f"{WORKERS} processes that share nothing: {ideal:.2f} s, {each / ideal:.2f} times as fast")
    print(f"{WORKERS} workers: {median(together):.2f} s, {100 * share:.1f} % of that; {start:.2f} s to start")


def _draw_together(found: Cluster, job: Job, pictures: list[Picture]) -> float:
    """Seconds that the workers take."""
    begun = time.perf_counter()
    for _ in drawn_by(found, (Wanted(k, job, picture) for k, picture in enumerate(pictures)), len(pictures), _nothing):
        pass
    return time.perf_counter() - begun


def _apart(job: Job, pictures: list[Picture]) -> float:
    """Seconds that processes take, each with its share of the pictures, from when all are ready."""
    spawning = get_context("spawn")
    gate = spawning.Barrier(WORKERS + 1)
    shares = [pictures[k::WORKERS] for k in range(WORKERS)]
    processes = [spawning.Process(target=_draw_share, args=(job, share, gate)) for share in shares]
    for process in processes:
        process.start()
    gate.wait()
    started = time.perf_counter()
    for process in processes:
        process.join()
    return time.perf_counter() - started


def _draw_share(job: Job, pictures: list[Picture], gate: Barrier) -> None:
    draw_picture(job, pictures[0])
    gate.wait()
    for picture in pictures:
        draw_picture(job, picture)


def memory(count: int) -> None:
    """Resident memory of this process after some scenes, all different, and after all."""
    for method in ("native", "mitsuba"):
        job, changes = job_of(method, 16, 12)
        sizes = []
        for k in range(count):
            draw_picture(job, Picture(changes[k % len(changes)]))
            if k + 1 in (count // 10, count):
                sizes.append(_resident())
        print(f"{method}: {sizes[0]:.0f} MiB after {count // 10} scenes, {sizes[1]:.0f} MiB after {count}")


def _resident() -> float:
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 2**20


def _nothing(share: float) -> None:
    pass


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:]))
