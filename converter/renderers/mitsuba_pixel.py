"""The ray trees of some pixels in Mitsuba, all rays of a bounce at a time.

The integrator's own steps say what is met, what it sends back by itself, and which rays follow.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from converter.renderers.records import MOST_RAYS, HitRecord, LightRecord, PixelRecord, RayKind, RayRecord
from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.rays import NOTHING, UPRIGHT, Ray, lanes
from mitsuba_plugins.sampler import PRIMARY_PATH


def trace_pixels(scene: Any, pixels: Sequence[tuple[int, int]]) -> list[PixelRecord]:
    """Trace pixels (column, row) of a loaded scene.

    Raises:
        ValueError: there are more than `MOST_RAYS` rays.

    """
    import mitsuba as mi

    from mitsuba_plugins.integrators.pixels import sample_offsets
    from mitsuba_plugins.integrators.primary_rays import name_sample, pixel_key, primary_ray

    sensor = scene.sensors()[0]
    offsets = sample_offsets(sensor.sampler().sample_count())
    x, y = (np.array([pixel[k] + offset[k] for pixel in pixels for offset in offsets], float) for k in (0, 1))
    columns, rows = (np.repeat([pixel[k] for pixel in pixels], len(offsets)) for k in (0, 1))
    prepared = scene.integrator().prepared(scene, sensor).deciding
    key = pixel_key(prepared, mi.Point2d(column(mi.Float64, columns), column(mi.Float64, rows)))
    number = column(mi.UInt32, np.tile(np.arange(len(offsets)), len(pixels)))
    position = mi.Point2d(column(mi.Float64, x), column(mi.Float64, y))
    primary = primary_ray(prepared, position, name_sample(prepared, key, number))
    rays = _Rays.of(primary, (key, number, mi.UInt32(PRIMARY_PATH)), len(x))
    roots = _Tracer(prepared).trees(rays)
    result = []
    for i, pixel in enumerate(pixels):
        samples = roots[i * len(offsets) : (i + 1) * len(offsets)]
        color = tuple(sum(ray.radiance[k] for ray in samples) / len(samples) for k in range(3))
        result.append(PixelRecord(*pixel, color, samples))
    return result


@dataclass(frozen=True)
class _Rays:
    """The numbers of rays, with their last axis the rays': those of a `Ray`, as it has them, and what tells its random
    numbers.
    """

    columns: tuple[NDArray[Any], ...]  # o, d, object, primitive, inside, t_min, spread; pixel key, number, path

    @classmethod
    def of(cls, ray: Ray, names: tuple[Any, Any, Any], count: int) -> "_Rays":
        columns = (ray.o, ray.d, ray.object, ray.primitive, ray.inside, ray.t_min, ray.spread, *names)
        return cls(tuple(np.broadcast_to(a, (*a.shape[:-1], count)) for a in map(np.array, columns)))

    def chosen(self, which: Sequence[int]) -> "_Rays":
        return _Rays(tuple(column[..., which] for column in self.columns))

    def with_more(self, more: "_Rays") -> "_Rays":
        return _Rays(tuple(np.concatenate(pair, axis=-1) for pair in zip(self.columns, more.columns, strict=True)))

    def ray(self, types: Any) -> Ray:
        import mitsuba as mi

        o, d, index, primitive, inside, t_min, spread = map(np.ascontiguousarray, self.columns[:7])
        return Ray(
            types.Point3(o),
            types.Vector3(d),
            column(mi.UInt32, index),
            column(mi.UInt32, primitive),
            column(mi.Bool, inside),
            column(types.Float, t_min),
            column(types.Float, spread),
        )

    def names(self) -> tuple[Any, Any, Any]:
        """The pixel's key, the number of the sample, and the path of each."""
        import mitsuba as mi

        key, number, path = (column(mi.UInt32, np.ascontiguousarray(numbers)) for numbers in self.columns[7:])
        return key, number, path

    def places(self) -> tuple[list[tuple[float, ...]], list[tuple[float, ...]]]:
        """The origin and the direction of each."""
        origin, direction = self.columns[:2]
        return _rows(origin, len(self)), _rows(direction, len(self))

    def __len__(self) -> int:
        return int(self.columns[-1].shape[-1])


class _Tracer:
    """Follows rays by the integrator's steps, and writes down what happens to them; the scene is a `KernelScene`."""

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._cutoff = scene.cutoff[0]

    def trees(self, rays: _Rays) -> list[RayRecord]:
        """The rays' records, with everything below them."""
        origin, direction = rays.places()
        times = self._times(rays)
        roots = [RayRecord("primary", 1.0, 0, *place) for place in zip(origin, direction, times, strict=True)]
        level, count = roots, 0
        bounces = []
        while level:
            count += len(level)
            if count > MOST_RAYS:
                raise ValueError(f"there are more than {MOST_RAYS} rays behind these pixels")
            following, next_rays, coefficients = self._follow(level, rays)
            bounces.append((level, coefficients))
            level, rays = following, next_rays
        for level, coefficients in reversed(bounces):
            for record, factors in zip(level, coefficients, strict=True):
                record.radiance = record.local
                for child in record.children:
                    pairs = zip(record.radiance, child.radiance, strict=True)
                    record.radiance = tuple(a + factors[child.kind] * b for a, b in pairs)
        return roots

    def _times(self, rays: _Rays) -> list[float | None]:
        """The time of each ray, if it has one."""
        from mitsuba_plugins.integrators.primary_rays import name_sample, timed

        key, number, _ = rays.names()
        scene = self._scene
        time = timed(scene, rays.ray(scene.types), name_sample(scene, key, number)).time
        return [None] * len(rays) if time is None else _list(time, len(rays))

    def _follow(self, level: list[RayRecord], rays: _Rays) -> tuple[list[RayRecord], _Rays, list[dict[RayKind, float]]]:
        """Complete the records of rays of one depth; begin those of the rays that follow, and give these, and for each
        of the former its kr and kt.
        """
        import drjit as dr
        import mitsuba as mi

        from mitsuba_plugins.integrators.primary_rays import name_sample, timed
        from mitsuba_plugins.integrators.secondary_rays import followed, reflected, transmitted
        from mitsuba_plugins.integrators.shading import local_radiance

        scene, count = self._scene, len(rays)
        ray = rays.ray(scene.types)
        key, number, path = rays.names()
        sample = name_sample(scene, key, number)
        # Numbers and no expressions of them: every bounce then runs the same few kernels.
        ray = timed(scene, ray, sample)
        dr.make_opaque(ray, sample, path)
        hit = scene.closest(ray, lanes(count))
        dr.make_opaque(hit)
        finish, pigment = scene.material(ray, hit)
        dr.make_opaque(finish, pigment)
        through, total = transmitted(scene, ray, hit, finish, sample, path, hit.valid)
        mirrored = reflected(scene, ray, hit, finish, sample, path, hit.valid)
        depth = level[0].depth + 1
        throughput = column(scene.types.Float, [record.throughput for record in level])
        mirror_throughput, mirrors, through_throughput, refracts = followed(
            scene, throughput, dr.opaque(mi.UInt32, depth, count), hit, finish
        )
        local, *_ = local_radiance(scene, ray, hit, finish, pigment, sample, path)
        dr.eval(through, mirrored, total, local, mirror_throughput, mirrors, through_throughput, refracts)

        local_colors, background = _rows(local, count), _rows(scene.parameters.background, 1)[0]
        hits = self._hits(ray, hit, finish, pigment, total, (sample, path), count)
        for record, found, color in zip(level, hits, local_colors, strict=True):
            record.hit = found
            record.local = background if found is None else color
        kinds: tuple[tuple[RayKind, Any, Any, Any, Ray, Any], ...] = (
            ("reflected", finish.kr, mirrors, mirror_throughput, mirrored, 2 * path),
            ("transmitted", finish.kt, refracts, through_throughput, through, 2 * path + 1),
        )
        coefficients: list[dict[RayKind, float]] = [{} for _ in level]
        following: list[RayRecord] = []
        chosen = []
        for kind, coefficient, follows, throughputs, spawned, its_path in kinds:
            secondary = _Rays.of(spawned, (key, number, its_path), count)
            which = []
            columns = (_list(numbers, count) for numbers in (coefficient, follows, throughputs))
            for i, (factor, goes_on, its_throughput) in enumerate(zip(*columns, strict=True)):
                unbounded = level[i].throughput * factor  # by any limit
                if level[i].hit is None or unbounded == 0:
                    continue
                if not goes_on:
                    level[i].dropped[kind] = "cutoff" if unbounded < self._cutoff else "depth"
                    continue
                coefficients[i][kind] = factor
                which.append((i, its_throughput))
            chosen.append(secondary.chosen([i for i, _ in which]))
            for (i, its_throughput), o, d in zip(which, *chosen[-1].places(), strict=True):
                following.append(RayRecord(kind, its_throughput, depth, o, d, level[i].time))
                level[i].children.append(following[-1])
        return following, chosen[0].with_more(chosen[1]), coefficients

    def _hits(
        self, ray: Ray, hit: Any, finish: Any, pigment: Any, total: Any, sampled: tuple[Any, Any], count: int
    ) -> Iterator[HitRecord | None]:
        """What each ray hits; None where that is nothing."""
        lights = self._lights(ray, hit, finish, pigment, sampled, count)
        answers = _list(finish.kd + finish.ks > 0, count)
        transmits = _list(finish.kt > 0, count)
        columns = (
            _list(numbers, count) for numbers in (hit.valid, hit.object, hit.primitive, hit.t, hit.inside, total)
        )
        vectors = (_rows(numbers, count) for numbers in (hit.p, hit.n, pigment))
        for i, (valid, index, primitive, t, inside, past, point, normal, color) in enumerate(
            zip(*columns, *vectors, strict=True)
        ):
            if not valid:
                yield None
                continue
            own = lights[i] if answers[i] else []
            plane = self._plane(index, primitive)
            yield HitRecord(index, plane, t, point, normal, not inside, color, past and transmits[i], own)

    def _plane(self, index: int, primitive: int) -> int | None:
        """The plane's index in the scene file."""
        first = self._scene.first_primitives[index]
        piece: int | None = self._scene.surfaces[index].pieces[(primitive & UPRIGHT) - first]
        return piece

    def _lights(
        self, ray: Any, hit: Any, finish: Any, pigment: Any, sampled: tuple[Any, Any], count: int
    ) -> list[list[LightRecord]]:
        """For each ray what each light adds."""
        import drjit as dr
        import mitsuba as mi

        from mitsuba_plugins.integrators.shading import light

        scene = self._scene
        result: list[list[LightRecord]] = [[] for _ in range(count)]
        for k in range(scene.lights.count if scene.parameters.shadows else 0):
            index = dr.opaque(mi.UInt32, k, count)
            added = light(scene, index, ray, hit, finish, pigment, lanes(count), *sampled)
            dr.eval(added)
            cosine, attenuation = _list(added.cosine, count), _list(added.attenuation, count)
            blocker = _list(added.blocker, count)
            diffuse, specular = _rows(added.diffuse, count), _rows(added.specular, count)
            for i, records in enumerate(result):
                shadowed_by = None if blocker[i] == NOTHING else blocker[i]
                records.append(LightRecord(k, cosine[i], shadowed_by, attenuation[i], diffuse[i], specular[i]))
        return result


def _list(numbers: Any, count: int) -> list[Any]:
    """A number for each ray."""
    found: list[Any] = np.broadcast_to(np.array(numbers), count).tolist()
    return found


def _rows(vectors: Any, count: int) -> list[tuple[float, ...]]:
    """A vector for each ray."""
    return [*map(tuple, np.broadcast_to(np.array(vectors), (3, count)).T.tolist())]
