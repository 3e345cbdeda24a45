// The Python module: a builder for scenes here, rendering in bind_render.cpp, half-spaces in bind_halfspaces.cpp,
// trees over boxes in bind_bvh.cpp, points on surfaces in bind_incidence.cpp, a reserve of memory in bind_memory.cpp.

#include "binding/bindings.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "tracing/description.h"

namespace nb = nanobind;
using namespace nb::literals;
using whitted::Quadruple;
using whitted::SceneDescription;
using whitted::Triple;

namespace {

using Planes = std::vector<Quadruple>;
using PlaneBuffer = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using TexelBuffer = nb::ndarray<const float, nb::c_contig, nb::device::cpu>;

// The value, if it is finite.
template <typename Numbers>
const Numbers& finite(const Numbers& numbers, const char* what) {
    for (const double number : numbers) {
        if (!std::isfinite(number)) {
            throw std::invalid_argument(std::string(what) + " is not finite");
        }
    }
    return numbers;
}

double positive(double number, const char* what) {
    if (!(number > 0) || !std::isfinite(number)) {
        throw std::invalid_argument(std::string(what) + " must be above 0");
    }
    return number;
}

template <typename Element, typename List>
int append(List& list, Element element) {
    list.push_back(std::move(element));
    return static_cast<int>(list.size()) - 1;
}

void check_index(int index, std::size_t size, const char* what) {
    if (index < 0 || static_cast<std::size_t>(index) >= size) {
        throw nb::index_error((std::string("there is no ") + what + " " + std::to_string(index)).c_str());
    }
}

int add_polyhedron(SceneDescription& scene, int pigment, int finish, Planes planes) {
    check_index(pigment, scene.pigments.size(), "pigment");
    check_index(finish, scene.finishes.size(), "finish");
    if (planes.empty()) {
        throw std::invalid_argument("a polyhedron needs at least one plane");
    }
    for (const Quadruple& plane : planes) {
        finite(plane, "a plane");
        if (plane[0] == 0 && plane[1] == 0 && plane[2] == 0) {
            throw std::invalid_argument("a plane's normal is zero");
        }
    }
    return append(scene.objects,
                  whitted::ObjectDescription{pigment, finish, whitted::PolyhedronDescription{std::move(planes)}});
}

int add_quadric(SceneDescription& scene, int pigment, int finish, const std::array<double, 10>& coefficients) {
    check_index(pigment, scene.pigments.size(), "pigment");
    check_index(finish, scene.finishes.size(), "finish");
    finite(coefficients, "a quadric");
    if (std::all_of(coefficients.begin(), coefficients.end() - 1, [](double number) { return number == 0; })) {
        throw std::invalid_argument("a quadric's numbers but the last are all 0");
    }
    return append(scene.objects,
                  whitted::ObjectDescription{pigment, finish, whitted::QuadricDescription{coefficients}});
}

int add_texmap(SceneDescription& scene, int width, int height, const TexelBuffer& texels, const Quadruple& p0,
               const Quadruple& p1) {
    if (width <= 0 || height <= 0 ||
        texels.size() != 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
        throw std::invalid_argument("a texture of " + std::to_string(width) + " x " + std::to_string(height) +
                                    " needs 3 numbers a texel, not " + std::to_string(texels.size()) + " in all");
    }
    return append(scene.pigments, whitted::TexmapDescription{
                                      width, height, std::vector<float>(texels.data(), texels.data() + texels.size()),
                                      finite(p0, "p0"), finite(p1, "p1")});
}

}  // namespace

void bind_scene(nb::module_& module) {
    nb::class_<SceneDescription>(module, "Scene", "A scene to be built, element by element; indices count from 0.")
        .def(nb::init<>())
        .def(
            "set_camera",
            [](SceneDescription& scene, const Triple& eye, const Triple& look_at, const Triple& up, double fovy) {
                scene.camera = {finite(eye, "eye"), finite(look_at, "look_at"), finite(up, "up"),
                                positive(fovy, "fovy")};
            },
            "eye"_a, "look_at"_a, "up"_a, "fovy"_a, "The camera; `up` is a vector, `fovy` the full angle in degrees.")
        .def(
            "set_ambient",
            [](SceneDescription& scene, const Triple& color) { scene.ambient = finite(color, "ambient"); }, "color"_a,
            "The ambient light's colour.")
        .def(
            "set_background",
            [](SceneDescription& scene, const Triple& color) { scene.background = finite(color, "background"); },
            "color"_a, "The colour of rays that hit nothing.")
        .def(
            "add_light",
            [](SceneDescription& scene, const Triple& position, const Triple& color, const Triple& attenuation) {
                return append(scene.lights,
                              whitted::LightDescription{finite(position, "position"), finite(color, "color"),
                                                        finite(attenuation, "attenuation")});
            },
            "position"_a, "color"_a, "attenuation"_a, "Add a point light, and return its index.")
        .def(
            "add_solid",
            [](SceneDescription& scene, const Triple& color) {
                return append(scene.pigments, whitted::SolidDescription{finite(color, "color")});
            },
            "color"_a, "Add a pigment of one colour, and return its index.")
        .def(
            "add_checker",
            [](SceneDescription& scene, const Triple& first, const Triple& second, double size) {
                return append(scene.pigments,
                              whitted::CheckerDescription{finite(first, "first"), finite(second, "second"),
                                                          positive(size, "size")});
            },
            "first"_a, "second"_a, "size"_a, "Add a checkerboard pigment, and return its index.")
        .def("add_texmap", &add_texmap, "width"_a, "height"_a, "texels"_a, "p0"_a, "p1"_a,
             "Add an image pigment, and return its index; `texels` is a buffer of height x width x 3 float32.")
        .def(
            "add_finish",
            [](SceneDescription& scene, double ka, double kd, double ks, double alpha, double kr, double kt,
               double eta) {
                finite(std::array{ka, kd, ks, alpha, kr, kt}, "a finish");
                return append(scene.finishes,
                              whitted::FinishDescription{ka, kd, ks, alpha, kr, kt, positive(eta, "eta")});
            },
            "ka"_a, "kd"_a, "ks"_a, "alpha"_a, "kr"_a, "kt"_a, "eta"_a,
            "Add a finish, and return its index; `eta` is n1/n2, outside over inside.")
        .def(
            "add_sphere",
            [](SceneDescription& scene, int pigment, int finish, const Triple& center, double radius) {
                check_index(pigment, scene.pigments.size(), "pigment");
                check_index(finish, scene.finishes.size(), "finish");
                return append(scene.objects,
                              whitted::ObjectDescription{
                                  pigment, finish,
                                  whitted::SphereDescription{finite(center, "center"), positive(radius, "radius")}});
            },
            "pigment"_a, "finish"_a, "center"_a, "radius"_a, "Add a sphere, and return its index.")
        .def("add_polyhedron", &add_polyhedron, "pigment"_a, "finish"_a, "planes"_a,
             "Add a convex polyhedron, and return its index; a plane is (a, b, c, d), inside where\n"
             "a x + b y + c z + d <= 0. `planes` may be a buffer of float64 too.")
        .def(
            "add_polyhedron",
            [](SceneDescription& scene, int pigment, int finish, const PlaneBuffer& numbers) {
                if (numbers.size() % 4 != 0) {
                    throw std::invalid_argument("a plane needs 4 numbers");
                }
                Planes planes(numbers.size() / 4);
                for (std::size_t i = 0; i < numbers.size(); ++i) {
                    planes[i / 4][i % 4] = numbers.data()[i];
                }
                return add_polyhedron(scene, pigment, finish, std::move(planes));
            },
            "pigment"_a, "finish"_a, "planes"_a)
        .def("add_quadric", &add_quadric, "pigment"_a, "finish"_a, "coefficients"_a,
             "Add a quadric, and return its index; the coefficients are A to J, inside where\n"
             "A x^2 + B y^2 + C z^2 + D x y + E x z + F y z + G x + H y + I z + J <= 0.");
}

NB_MODULE(_core, module) {
    module.doc() = "The native tracer: Whitted's shading of spheres, convex polyhedra and quadrics.";
    bind_scene(module);
    bind_render(module);
    bind_halfspaces(module);
    bind_bvh(module);
    bind_incidence(module);
    bind_memory(module);
}
