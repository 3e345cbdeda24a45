"""Mitsuba 3 plugins that reproduce the course's shading model: textures, a BSDF, an emitter, a sensor, an integrator.

    import mitsuba_plugins  # before mitsuba, which takes the first LLVM library it finds
    import mitsuba

    mitsuba_plugins.set_variant("auto")
    image = mitsuba.render(mitsuba.load_file("scene.xml"))
    mitsuba_plugins.write_image("picture.png", image)

Importing this package is cheap and loads neither Mitsuba nor LLVM; `set_variant` and `register` do.
"""

from mitsuba_plugins.backend import BackendError, name_llvm, register, set_variant
from mitsuba_plugins.picture import write_image

name_llvm()

__all__ = ["BackendError", "register", "set_variant", "write_image"]
