"""The ray trees of some pixels in Mitsuba, built with the integrator's own steps, all rays of a bounce at a time."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from converter.scene.settings import Settings
from mitsuba_plugins.integrators.rays import NOTHING, Ray, lanes

Record = dict[str, Any]

MOST_RAYS = 1 << 20
"""In all the trees together."""


def trace_pixels(scene: Any, settings: Settings, pixels: Sequence[tuple[int, int]]) -> list[Record]:
    """Trace pixels (column, row) of a loaded scene; each result is what `NativeRenderer.trace_pixel` documents.

    Raises:
        ValueError: there are more than `MOST_RAYS` rays.

    """
    import mitsuba as mi

    integrator, sensor = scene.integrator(), scene.sensors()[0]
    offsets = integrator.sample_offsets(settings.samples)
    x, y = (np.array([pixel[k] + offset[k] for pixel in pixels for offset in offsets], float) for k in (0, 1))
    with integrator.prepared(scene, sensor):
        rays = _Rays.of(integrator.primary_ray(sensor, mi.Point2d(x, y)), len(x))
        roots = _Tracer(integrator).trees(rays)
    result = []
    for i, (column, row) in enumerate(pixels):
        samples = roots[i * len(offsets) : (i + 1) * len(offsets)]
        color = tuple(sum(ray["radiance"][k] for ray in samples) / len(samples) for k in range(3))
        result.append({"x": column, "y": row, "color": color, "rays": samples})
    return result


@dataclass(frozen=True)
class _Rays:
    """The numbers of rays, with their last axis the rays': those of a `Ray`, as it has them."""

    columns: tuple[NDArray[Any], ...]  # o, d, object, record, inside, t_min, spread

    @classmethod
    def of(cls, ray: Ray, count: int) -> "_Rays":
        columns = (ray.o, ray.d, ray.object, ray.record, ray.inside, ray.t_min, ray.spread)
        return cls(tuple(np.broadcast_to(a, (*a.shape[:-1], count)) for a in map(np.array, columns)))

    def chosen(self, which: Sequence[int]) -> "_Rays":
        return _Rays(tuple(column[..., which] for column in self.columns))

    def with_more(self, more: "_Rays") -> "_Rays":
        return _Rays(tuple(np.concatenate(pair, axis=-1) for pair in zip(self.columns, more.columns, strict=True)))

    def ray(self, types: Any) -> Ray:
        import mitsuba as mi

        o, d, index, record, inside, t_min, spread = map(np.ascontiguousarray, self.columns)
        return Ray(
            types.Point3(o),
            types.Vector3(d),
            mi.UInt32(index),
            mi.UInt32(record),
            mi.Bool(inside),
            types.Float(t_min),
            types.Float(spread),
        )

    def __len__(self) -> int:
        return int(self.columns[-1].shape[-1])


class _Tracer:
    """Follows rays and writes down what happens to them."""

    def __init__(self, integrator: Any) -> None:
        self._integrator = integrator
        self._cutoff = integrator.cutoff[0]
        self._max_depth = integrator.max_depth[0]

    def trees(self, rays: _Rays) -> list[Record]:
        """The rays' records, with everything below them."""
        roots: list[Record] = [{"kind": "primary", "weight": 1.0, "depth": 0} for _ in range(len(rays))]
        level, count = roots, 0
        levels = []
        while level:
            count += len(level)
            if count > MOST_RAYS:
                raise ValueError(f"there are more than {MOST_RAYS} rays behind these pixels")
            levels.append(level)
            level, rays = self._follow(level, rays)
        for level in reversed(levels):
            for record in level:
                radiance = record["local"]
                for child, coefficient in zip(record["children"], record.pop("coefficients"), strict=True):
                    radiance = tuple(a + coefficient * b for a, b in zip(radiance, child["radiance"], strict=True))
                record["radiance"] = radiance
        return roots

    def _follow(self, level: list[Record], rays: _Rays) -> tuple[list[Record], _Rays]:
        """Complete the records of rays, and begin those of the rays that follow."""
        import drjit as dr

        integrator, count = self._integrator, len(rays)
        ray = rays.ray(integrator.types)
        # Numbers and no expressions of them: every bounce then runs the same few kernels.
        dr.make_opaque(ray)
        hit = integrator.closest(ray, lanes(count))
        dr.make_opaque(hit)
        finish, pigment = integrator.material(ray, hit)
        dr.make_opaque(finish, pigment)
        through, total = integrator.transmitted(ray, hit, finish.eta)
        mirrored = integrator.reflected(ray, hit)
        dr.eval(through, mirrored, total)
        lights = self._lights(ray, hit, finish, pigment, count)

        origin, direction = _rows(ray.o, count), _rows(ray.d, count)
        valid, t, index = _list(hit.valid, count), _list(hit.t, count), _list(hit.object, count)
        plane, point, normal = _list(hit.record, count), _rows(hit.p, count), _rows(hit.n, count)
        inside, total = _list(hit.inside, count), _list(total, count)
        kr, kt = _list(finish.kr, count), _list(finish.kt, count)
        answers = _list(finish.kd + finish.ks > 0, count)
        colors, background = _rows(pigment, count), _rows(integrator.background, 1)[0]
        ambient = _rows(finish.ka * integrator.ambient * pigment, count)
        followed: dict[str, list[tuple[int, Record]]] = {"reflected": [], "transmitted": []}
        for i, record in enumerate(level):
            record |= {
                "origin": origin[i],
                "direction": direction[i],
                "dropped": {},
                "children": [],
                "coefficients": [],
            }
            if not valid[i]:
                record |= {"hit": None, "local": background}
                continue
            own = lights[i] if answers[i] else []
            local = ambient[i]
            for light in own:
                local = tuple(a + b + c for a, b, c in zip(local, light["diffuse"], light["specular"], strict=True))
            record["local"] = local
            record["hit"] = {
                "object": index[i],
                "plane": self._plane(index[i], plane[i]),
                "t": t[i],
                "point": point[i],
                "normal": normal[i],
                "entering": not inside[i],
                "pigment": colors[i],
                "total_reflection": total[i] and kt[i] > 0,
                "lights": own,
            }
            for kind, coefficient in (("reflected", kr[i]), ("transmitted", kt[i])):
                weight = record["weight"] * coefficient
                if weight == 0:
                    continue
                if weight < self._cutoff:
                    record["dropped"][kind] = "cutoff"
                elif record["depth"] + 1 > self._max_depth:
                    record["dropped"][kind] = "depth"
                else:
                    child = {"kind": kind, "weight": weight, "depth": record["depth"] + 1}
                    record["children"].append(child)
                    record["coefficients"].append(coefficient)
                    followed[kind].append((i, child))
        successors = [_Rays.of(mirrored, count), _Rays.of(through, count)]
        chosen = [s.chosen([i for i, _ in which]) for s, which in zip(successors, followed.values(), strict=True)]
        return [child for which in followed.values() for _, child in which], chosen[0].with_more(chosen[1])

    def _plane(self, index: int, record: int) -> int | None:
        """The plane's index in the scene file."""
        surface = self._integrator.surfaces[index]
        if surface.sphere is not None:
            return None
        return int(list(surface.planes)[record - self._integrator.first_records[index]])

    def _lights(self, ray: Any, hit: Any, finish: Any, pigment: Any, count: int) -> list[list[Record]]:
        """For each ray what each light adds."""
        import drjit as dr
        import mitsuba as mi

        result: list[list[Record]] = [[] for _ in range(count)]
        for k in range(self._integrator.light_count if self._integrator.shadows else 0):
            light = self._integrator.light(dr.opaque(mi.UInt32, k, count), ray, hit, finish, pigment, lanes(count))
            dr.eval(light)
            cosine, attenuation = _list(light.cosine, count), _list(light.attenuation, count)
            blocker = _list(light.blocker, count)
            diffuse, specular = _rows(light.diffuse, count), _rows(light.specular, count)
            for i, records in enumerate(result):
                lit = cosine[i] > 0 and blocker[i] == NOTHING
                records.append(
                    {
                        "light": k,
                        "cosine": cosine[i],
                        "shadowed_by": None if blocker[i] == NOTHING else blocker[i],
                        "attenuation": attenuation[i],
                        "diffuse": diffuse[i] if lit else (0.0, 0.0, 0.0),
                        "specular": specular[i] if lit else (0.0, 0.0, 0.0),
                    }
                )
        return result


def _list(numbers: Any, count: int) -> list[Any]:
    """A number for each ray."""
    found: list[Any] = np.broadcast_to(np.array(numbers), count).tolist()
    return found


def _rows(vectors: Any, count: int) -> list[tuple[float, ...]]:
    """A vector for each ray."""
    return [*map(tuple, np.broadcast_to(np.array(vectors), (3, count)).T.tolist())]
