// The Python module: a builder for scenes here, rendering in bind_render.cpp, half-spaces in bind_halfspaces.cpp,
// trees over boxes in bind_bvh.cpp, points on surfaces in bind_incidence.cpp, a reserve of memory in bind_memory.cpp,
// scene files in bind_scene_file.cpp.

#include "binding/bindings.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "search/bounds.h"
#include "shapes/simplified_csg.h"
#include "tracing/description.h"

namespace nb = nanobind;
using namespace nb::literals;
using whitted::Quadruple;
using whitted::SceneDescription;
using whitted::Triple;

namespace {

using Planes = std::vector<Quadruple>;
using Coefficients = std::array<double, 10>;
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

double not_negative(double number, const char* what) {
    if (!(number >= 0) || !std::isfinite(number)) {
        throw std::invalid_argument(std::string(what) + " must not be negative");
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

void check_object(const SceneDescription& scene, int pigment, int finish) {
    check_index(pigment, scene.pigments.size(), "pigment");
    check_index(finish, scene.finishes.size(), "finish");
}

int add_object(SceneDescription& scene, int pigment, int finish, whitted::ShapeDescription shape) {
    check_object(scene, pigment, finish);
    return append(scene.objects, whitted::ObjectDescription{pigment, finish, std::move(shape)});
}

whitted::SphereDescription sphere_of(const Triple& center, double radius) {
    return {finite(center, "center"), positive(radius, "radius")};
}

whitted::PolyhedronDescription polyhedron_of(Planes planes) {
    if (planes.empty()) {
        throw std::invalid_argument("a polyhedron needs at least one plane");
    }
    for (const Quadruple& plane : planes) {
        finite(plane, "a plane");
        if (plane[0] == 0 && plane[1] == 0 && plane[2] == 0) {
            throw std::invalid_argument("a plane's normal is zero");
        }
    }
    return {std::move(planes)};
}

whitted::QuadricDescription quadric_of(const Coefficients& coefficients) {
    finite(coefficients, "a quadric");
    if (std::all_of(coefficients.begin(), coefficients.end() - 1, [](double number) { return number == 0; })) {
        throw std::invalid_argument("a quadric's numbers but the last are all 0");
    }
    return {coefficients};
}

whitted::LeafDescription leaf_of(const std::string& kind, nb::handle numbers) {
    if (kind == "sphere") {
        const auto [x, y, z, radius] = nb::cast<Quadruple>(numbers);
        return sphere_of({x, y, z}, radius);
    }
    if (kind == "polyhedron") {
        return polyhedron_of(nb::cast<Planes>(numbers));
    }
    if (kind == "quadric") {
        return quadric_of(nb::cast<Coefficients>(numbers));
    }
    throw std::invalid_argument("a leaf is a 'sphere', a 'polyhedron' or a 'quadric', not '" + kind + "'");
}

void check_program(const std::vector<int>& program, std::size_t leaves) {
    std::size_t size = 0;  // of the stack
    std::size_t uses = 0;  // of leaves
    for (const int step : program) {
        if (step >= 0) {
            check_index(step, leaves, "leaf");
            ++size;
            ++uses;
        } else if (step < whitted::CsgDescription::intersect) {
            throw std::invalid_argument("a csg has no operation " + std::to_string(step));
        } else if (size-- < 2) {
            throw std::invalid_argument("an operation of a csg lacks an operand");
        }
        if (size > whitted::deepest_csg_stack) {
            throw std::invalid_argument("a csg is nested too deep");
        }
    }
    if (uses > whitted::most_csg_leaves) {
        throw std::invalid_argument("a csg's program uses " + std::to_string(whitted::most_csg_leaves) +
                                    " leaves at most");
    }
    if (size != 1) {
        throw std::invalid_argument("a csg's program has to leave one value");
    }
}

int add_csg(SceneDescription& scene, int pigment, int finish,
            const std::vector<std::pair<std::string, nb::object>>& leaves, const std::vector<int>& program) {
    check_object(scene, pigment, finish);
    if (leaves.size() > whitted::most_csg_leaves) {
        throw std::invalid_argument("a csg has " + std::to_string(whitted::most_csg_leaves) + " leaves at most");
    }
    check_program(program, leaves.size());
    whitted::CsgDescription csg{{}, program};
    for (const auto& [kind, numbers] : leaves) {
        csg.leaves.push_back(leaf_of(kind, numbers));
    }
    return add_object(scene, pigment, finish, whitted::simplified(csg));
}

void move_object(SceneDescription& scene, int index, const Triple& displacement) {
    check_index(index, scene.objects.size(), "object");
    whitted::ShapeDescription& shape = scene.objects[static_cast<std::size_t>(index)].shape;
    finite(displacement, "displacement");
    shape = std::visit(
        [&](auto& still) -> whitted::MovingDescription {
            if constexpr (std::is_same_v<std::decay_t<decltype(still)>, whitted::MovingDescription>) {
                return {std::move(still.body), displacement};
            } else {
                return {std::move(still), displacement};
            }
        },
        shape);
}

std::optional<std::pair<Triple, Triple>> box_of(const SceneDescription& scene, int index) {
    check_index(index, scene.objects.size(), "object");
    const std::optional<whitted::Bounds> bounds =
        std::visit([](const auto& shape) { return whitted::bounds_of(shape); },
                   scene.objects[static_cast<std::size_t>(index)].shape);
    return bounds ? std::optional(std::pair(bounds->box.low, bounds->box.high)) : std::nullopt;
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
            [](SceneDescription& scene, const Triple& eye, const Triple& look_at, const Triple& up, double fovy,
               double aperture, double focal) {
                scene.camera = {finite(eye, "eye"),     finite(look_at, "look_at"),         finite(up, "up"),
                                positive(fovy, "fovy"), not_negative(aperture, "aperture"), positive(focal, "focal")};
            },
            "eye"_a, "look_at"_a, "up"_a, "fovy"_a, "aperture"_a = 0.0, "focal"_a = 1.0,
            "The camera; `up` is a vector, `fovy` the full angle in degrees, `aperture` the lens's radius, and what "
            "lies\n"
            "at distance `focal` along the view direction is in focus.")
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
            [](SceneDescription& scene, const Triple& position, const Triple& color, const Triple& attenuation,
               double radius) {
                return append(scene.lights, whitted::LightDescription{
                                                finite(position, "position"), finite(color, "color"),
                                                finite(attenuation, "attenuation"), not_negative(radius, "radius")});
            },
            "position"_a, "color"_a, "attenuation"_a, "radius"_a = 0.0,
            "Add a light, a point or a disc that faces the point being lit, and return its index.")
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
            [](SceneDescription& scene, double ka, double kd, double ks, double alpha, double kr, double kt, double eta,
               double cone) {
                finite(std::array{ka, kd, ks, alpha, kr, kt}, "a finish");
                if (!(cone >= 0 && cone <= 90)) {
                    throw std::invalid_argument("cone must lie in 0..90");
                }
                return append(scene.finishes,
                              whitted::FinishDescription{ka, kd, ks, alpha, kr, kt, positive(eta, "eta"), cone});
            },
            "ka"_a, "kd"_a, "ks"_a, "alpha"_a, "kr"_a, "kt"_a, "eta"_a, "cone"_a = 0.0,
            "Add a finish, and return its index; `eta` is n1/n2, outside over inside, `cone` the half-angle, in "
            "degrees,\n"
            "of the cone in which mirrored and transmitted rays are spread.")
        .def(
            "add_sphere",
            [](SceneDescription& scene, int pigment, int finish, const Triple& center, double radius) {
                return add_object(scene, pigment, finish, sphere_of(center, radius));
            },
            "pigment"_a, "finish"_a, "center"_a, "radius"_a, "Add a sphere, and return its index.")
        .def(
            "add_polyhedron",
            [](SceneDescription& scene, int pigment, int finish, Planes planes) {
                return add_object(scene, pigment, finish, polyhedron_of(std::move(planes)));
            },
            "pigment"_a, "finish"_a, "planes"_a,
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
                return add_object(scene, pigment, finish, polyhedron_of(std::move(planes)));
            },
            "pigment"_a, "finish"_a, "planes"_a)
        .def(
            "add_quadric",
            [](SceneDescription& scene, int pigment, int finish, const Coefficients& coefficients) {
                return add_object(scene, pigment, finish, quadric_of(coefficients));
            },
            "pigment"_a, "finish"_a, "coefficients"_a,
            "Add a quadric, and return its index; the coefficients are A to J, inside where\n"
            "A x^2 + B y^2 + C z^2 + D x y + E x z + F y z + G x + H y + I z + J <= 0.")
        .def("add_csg", &add_csg, "pigment"_a, "finish"_a, "leaves"_a, "program"_a,
             "Add constructive solid geometry, and return its index. A leaf is ('sphere', (x, y, z, radius)),\n"
             "('polyhedron', planes) or ('quadric', coefficients); the program is a Boolean expression in postfix\n"
             "order: k >= 0 pushes leaf k, -1 unites the last two, -2 subtracts, -3 intersects them.")
        .def("move_object", &move_object, "index"_a, "displacement"_a,
             "Let an object, its pigment too, move by a displacement while the picture is taken.")
        .def("box_of", &box_of, "index"_a,
             "The low and the high corner of the box around an object, or None if it is not known to have bounds.");
}

NB_MODULE(_core, module) {
    module.doc() = "The native tracer: Whitted's shading of spheres, convex polyhedra, quadrics and csg.";
    bind_scene(module);
    bind_render(module);
    bind_halfspaces(module);
    bind_bvh(module);
    bind_incidence(module);
    bind_memory(module);
    bind_sampler(module);
    bind_scene_file(module);
}
