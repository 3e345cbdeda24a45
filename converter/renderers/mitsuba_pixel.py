"""The ray tree of one pixel in Mitsuba, built with the integrator's own steps, one ray at a time."""

from typing import Any

from converter.scene.settings import Settings
from mitsuba_plugins.integrators.rays import NOTHING, lanes


def trace_pixel(scene: Any, settings: Settings, x: int, y: int) -> dict[str, Any]:
    """Trace column `x` and row `y` of a loaded scene; the result is what `NativeRenderer.trace_pixel` documents."""
    import mitsuba as mi

    integrator, sensor = scene.integrator(), scene.sensors()[0]
    integrator.prepare(scene)
    tracer = _PixelTracer(integrator)
    rays = [
        tracer.tree(integrator.primary_ray(sensor, mi.Point2d(x + dx, y + dy)), "primary", 1.0, 0)
        for dx, dy in integrator.sample_offsets(settings.samples)
    ]
    color = [sum(ray["radiance"][k] for ray in rays) / len(rays) for k in range(3)]
    return {"x": x, "y": y, "color": tuple(color), "rays": rays}


class _PixelTracer:
    """Follows rays of width 1 and writes down what happens to them."""

    def __init__(self, integrator: Any) -> None:
        import drjit
        import mitsuba

        self._dr = drjit
        self._mi = mitsuba
        self._integrator = integrator
        self._cutoff = integrator.cutoff[0]
        self._max_depth = integrator.max_depth[0]

    def tree(self, ray: Any, kind: str, weight: float, depth: int) -> dict[str, Any]:
        """A ray and everything below it."""
        # Numbers and no expressions of them: every step of every ray then runs the same few kernels.
        self._dr.make_opaque(ray)
        hit = self._integrator.closest(ray, lanes(1))
        self._dr.make_opaque(hit)
        record: dict[str, Any] = {
            "kind": kind,
            "weight": weight,
            "depth": depth,
            "origin": _numbers(ray.o),
            "direction": _numbers(ray.d),
            "dropped": {},
            "children": [],
        }
        if not hit.valid[0]:
            background = _numbers(self._integrator.background)
            return record | {"hit": None, "local": background, "radiance": background}
        finish, pigment = self._integrator.material(hit)
        self._dr.make_opaque(finish, pigment)
        through, total = self._integrator.transmitted(ray, hit, finish.eta)
        lights = self._lights(ray, hit, finish, pigment)
        local = _numbers(finish.ka * self._integrator.ambient * pigment)
        for light in lights:
            local = tuple(a + b + c for a, b, c in zip(local, light["diffuse"], light["specular"], strict=True))
        record["hit"] = {
            "object": hit.object[0],
            "plane": self._plane(hit),
            "t": hit.t[0],
            "point": _numbers(hit.p),
            "normal": _numbers(hit.n),
            "entering": not hit.inside[0],
            "pigment": _numbers(pigment),
            "total_reflection": bool(total[0]) and finish.kt[0] > 0,
            "lights": lights,
        }
        record["local"] = local
        radiance = local
        mirrored = self._integrator.reflected(ray, hit)
        for name, coefficient, child in (("reflected", finish.kr[0], mirrored), ("transmitted", finish.kt[0], through)):
            if coefficient == 0:
                continue
            if depth + 1 > self._max_depth:
                record["dropped"][name] = "depth"
            elif weight * coefficient < self._cutoff:
                record["dropped"][name] = "cutoff"
            else:
                record["children"].append(self.tree(child, name, weight * coefficient, depth + 1))
                below = record["children"][-1]["radiance"]
                radiance = tuple(a + coefficient * b for a, b in zip(radiance, below, strict=True))
        return record | {"radiance": radiance}

    def _plane(self, hit: Any) -> int | None:
        """The plane's index in the scene file."""
        index = hit.object[0]
        surface = self._integrator.surfaces[index]
        if surface.sphere is not None:
            return None
        return int(list(surface.planes)[hit.record[0] - self._integrator.first_records[index]])

    def _lights(self, ray: Any, hit: Any, finish: Any, pigment: Any) -> list[dict[str, Any]]:
        if not self._integrator.shadows or finish.kd[0] + finish.ks[0] == 0:
            return []
        mi = self._mi
        records = []
        for i in range(self._integrator.light_count):
            light = self._integrator.light(self._dr.opaque(mi.UInt32, i), ray, hit, finish, pigment, lanes(1))
            self._dr.eval(light)
            blocker = int(light.blocker[0])
            lit = light.cosine[0] > 0 and blocker == NOTHING
            records.append(
                {
                    "light": i,
                    "cosine": light.cosine[0],
                    "shadowed_by": None if blocker == NOTHING else blocker,
                    "attenuation": light.attenuation[0],
                    "diffuse": _numbers(light.diffuse) if lit else (0.0, 0.0, 0.0),
                    "specular": _numbers(light.specular) if lit else (0.0, 0.0, 0.0),
                }
            )
        return records


def _numbers(vector: Any) -> tuple[float, ...]:
    return tuple(component[0] for component in vector)
