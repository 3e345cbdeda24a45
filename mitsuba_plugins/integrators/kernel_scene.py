"""A scene as a kernel reads it, in one precision: where rays hit, and the finishes, pigments and lights there."""

from typing import Any

import numpy as np

from mitsuba_plugins.integrators.parameters import Parameters
from mitsuba_plugins.integrators.signature import Signer
from mitsuba_plugins.integrators.tables import Bsdfs, Finish, Lights, Materials
from mitsuba_plugins.intersection.contacts import Contacts, EyeContact, LightContacts
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import Hit, Ray, Real
from mitsuba_plugins.intersection.rounding import bounds_all, camera_errors, coordinate_errors, decides_ties
from mitsuba_plugins.intersection.ways import tracer_of


class KernelScene:
    """What kernels are recorded with; read anew for each picture, since mitsuba.traverse lets a user change it.

    A class that Dr.Jit does not know: in what it knows it looks for variables of loops.

    Args:
        types: of the precision.
        parameters, surfaces, bsdfs: the integrator's.
        contacts: of the surfaces.
        scene: Mitsuba's.
        sensor: that rays start from, if it is known; what the eye of a `pinhole` lies on is found out.
        least_weight: pixels get signatures of rays that weigh at least so much; None, and they get none.

    Attributes:
        cutoff: the parameter, in the precision of `types`.
        surfaces: the exact surfaces, in the order of their objects.
        first_primitives: of each object.
        lights, light_contacts: the lights, and what these lie on.
        tracer: finds hits and what lies before a light, see :mod:`mitsuba_plugins.intersection.surfaces`.
        sensor, eye_contact, errors_of_eye: where rays start, what the eye lies on, and how far it may be off.
        signer: makes signatures, or None.
        blinn: whether highlights are Blinn's.
        moves, has_lens, has_soft_shadows, has_cones: what is sampled.
        sampled: whether anything is; where signatures are made, too, rays have paths.

    """

    def __init__(
        self,
        types: Real,
        parameters: Parameters,
        surfaces: list[Surface],
        bsdfs: Bsdfs,
        contacts: Contacts,
        scene: Any,
        sensor: Any,
        least_weight: float | None,
    ) -> None:
        self.types, self.parameters, self.surfaces = types, parameters, surfaces
        self.cutoff = types.Float(parameters.cutoff)
        primitives = Primitives(types, surfaces)
        self.first_primitives = primitives.first
        self._materials = Materials(types, [bsdfs.by_name[surface.material] for surface in surfaces])
        self.blinn = self._materials.blinn
        self.lights = Lights(types, scene.emitters())
        entered = bsdfs.transmitting(surfaces) if parameters.refraction else []
        self.light_contacts = LightContacts(types, contacts, self.lights.positions, self.lights.radii, entered)
        self.tracer = tracer_of(parameters.intersections, types, scene, surfaces, primitives, self.light_contacts)
        self.sensor = sensor
        self.has_lens = getattr(sensor, "has_lens", False)
        has_eye = hasattr(sensor, "eye") and not self.has_lens
        self.eye_contact = EyeContact(types, contacts, np.ravel(sensor.eye)) if has_eye else None
        self.errors_of_eye = camera_errors(types, sensor)
        self.signer: Any = None if least_weight is None else Signer(types, surfaces, least_weight)
        self.moves = any(surface.moves for surface in surfaces)
        self.has_soft_shadows = parameters.shadows and bool(self.lights.radii.any())
        self.has_cones = self._materials.spread and (parameters.reflection or parameters.refraction)
        self.sampled = self.moves or self.has_soft_shadows or self.has_cones or self.has_lens or self.signer is not None

    @property
    def leaves_undecided(self) -> bool:
        """Whether a ray tree may be left undecided, which is told then."""
        return self.postpones_ties or bounds_all(self.types.Float)

    @property
    def postpones_ties(self) -> bool:
        """Whether it is told which rays' trees come close to a tie, and these are left undecided."""
        return bool(self.tracer.postpones_ties)

    def postpone_ties(self, postpones: bool) -> None:
        """Let kernels do so, where they would decide ties: the code by which they do slows them down."""
        decides = self.tracer.finds_ties and self.parameters.precision != "float"
        self.tracer.postpones_ties = postpones and decides

    def closest(self, ray: Ray, active: Any) -> Hit:
        """The first surface that a ray meets."""
        hit: Hit = self.tracer.closest(ray, active)
        return hit

    def material(self, ray: Ray, hit: Hit) -> tuple[Finish, Any]:
        """The finish and the pigment's colour (Color3) at a hit."""
        finish = self._materials.finish(hit.object, hit.valid)
        return finish, self._materials.color(hit.object, hit.p_at_rest, self._errors(ray, hit), hit.valid)

    def color_doubt(self, ray: Ray, hit: Hit) -> Any:
        """By how much a channel of the pigment's colour at a hit may be off (Float)."""
        return self._materials.unlike(hit.object, hit.p_at_rest, self._errors(ray, hit), hit.valid)

    def hit_word(self, ray: Ray, hit: Hit, path: Any) -> Any:
        """What the hit of a ray of that path adds to a signature (UInt32)."""
        cell = self._materials.cell(hit.object, hit.p_at_rest, self._errors(ray, hit), hit.valid)
        return self.signer.hit_word(path, hit, cell)

    def _errors(self, ray: Ray, hit: Hit) -> Any:
        """How far the coordinates of a hit may be off, where a pigment asks."""
        in_kernel = self.parameters.intersections not in ("offset", "ulp")
        decides = (decides_ties(hit.t) or bounds_all(hit.t)) and in_kernel
        if not decides or not self._materials.has_edges:
            return self.types.Vector3(0)
        return coordinate_errors(hit.p_at_rest, hit.n, ray.d, hit.t, hit.off)
