// The student's tracer as a Python module.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include "deviations.h"
#include "levels.h"
#include "record.h"
#include "scene.h"
#include "tracer.h"

namespace nb = nanobind;
using namespace nb::literals;
using namespace student;

namespace {

using Pixels = nb::ndarray<const std::int32_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using Colors = nb::ndarray<const float, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Texels = nb::ndarray<const float, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;
using Indices = std::vector<std::size_t>;

Switches switches_of(const Indices& indices) {
    Switches switches;
    for (const std::size_t index : indices) {
        if (index >= deviation_count) {
            throw nb::index_error("there is no such deviation");
        }
        switches.set(index);
    }
    return switches;
}

Size size_of(int width, int height) {
    if (width < 1 || height < 1) {
        throw std::invalid_argument("a picture needs a width and a height above 0");
    }
    return {width, height};
}

void check(const Scene& scene) {
    for (const Object& o : scene.objects) {
        if (o.pigment < 0 || o.finish < 0 || std::size_t(o.pigment) >= scene.pigments.size() ||
            std::size_t(o.finish) >= scene.finishes.size()) {
            throw nb::index_error("an object's pigment or finish does not exist");
        }
    }
}

// An array that Python owns.
template <typename Value>
auto owned(std::vector<Value>&& values, std::initializer_list<std::size_t> shape) {
    auto* kept = new std::vector<Value>(std::move(values));
    const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<Value>*>(p); });
    return nb::ndarray<nb::numpy, Value>(kept->data(), shape, owner);
}

// ---- Pictures -------------------------------------------------------------------------------------------------------

constexpr std::size_t share = 16;  // pixels that a thread takes at once

template <typename Real>
void trace_some(const Scene& scene, Size size, const Switches& switches, const std::int32_t* pixels, std::size_t count,
                float* colors) {
    const Tracer<Real> tracer(scene, size, switches);
    for (std::size_t i = 0; i < count; ++i) {
        const auto color = tracer.pixel(pixels[2 * i], pixels[2 * i + 1]);
        colors[3 * i] = static_cast<float>(color.x);
        colors[3 * i + 1] = static_cast<float>(color.y);
        colors[3 * i + 2] = static_cast<float>(color.z);
    }
}

auto trace(const Scene& scene, int width, int height, const Pixels& pixels, const std::vector<Indices>& sets,
           unsigned threads) {
    check(scene);
    const Size size = size_of(width, height);
    std::vector<Switches> switches;
    for (const Indices& set : sets) {
        switches.push_back(switches_of(set));
    }
    const std::size_t count = pixels.shape(0);
    std::vector<float> colors(sets.size() * count * 3);
    {
        const nb::gil_scoped_release unlocked;
        const std::size_t shares = (count + share - 1) / share;
        std::atomic<std::size_t> next = 0;
        std::exception_ptr failure;
        std::once_flag failed;
        const auto work = [&] {
            try {
                for (std::size_t job = next++; job < shares * switches.size(); job = next++) {
                    const std::size_t set = job / shares, first = job % shares * share;
                    const auto tracing = switches[set](On::single_precision) ? trace_some<float> : trace_some<double>;
                    tracing(scene, size, switches[set], pixels.data() + 2 * first, std::min(share, count - first),
                            colors.data() + 3 * (set * count + first));
                }
            } catch (...) {
                std::call_once(failed, [&] { failure = std::current_exception(); });
            }
        };
        std::vector<std::thread> others;
        try {
            for (unsigned i = 1; i < threads; ++i) {
                others.emplace_back(work);
            }
        } catch (const std::system_error&) {
            // No room for its stack: fewer will do.
        }
        work();
        for (std::thread& thread : others) {
            thread.join();
        }
        if (failure) {
            std::rethrow_exception(failure);
        }
    }
    return owned(std::move(colors), {sets.size(), count, 3});
}

auto bytes(const Colors& colors, const Indices& set) {
    const Switches switches = switches_of(set);
    const std::size_t count = colors.shape(0);
    std::vector<std::uint8_t> result(count * 3);
    for (std::size_t i = 0; i < count; ++i) {
        const float* c = colors.data() + 3 * i;
        const auto pixel = levels({c[0], c[1], c[2]}, switches);
        std::copy(pixel.begin(), pixel.end(), result.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
    return owned(std::move(result), {count, 3});
}

// ---- The rays of a pixel ------------------------------------------------------------------------------------------------

nb::tuple tuple_of(const Triple& v) { return nb::make_tuple(v[0], v[1], v[2]); }

nb::object index_or_none(int index) { return index < 0 ? nb::object(nb::none()) : nb::object(nb::int_(index)); }

nb::object hit_of(const RayRecord& ray) {
    if (ray.object < 0) {
        return nb::none();
    }
    nb::dict hit;
    hit["object"] = ray.object;
    hit["plane"] = index_or_none(ray.plane);
    hit["t"] = ray.t;
    hit["point"] = tuple_of(ray.point);
    hit["normal"] = tuple_of(ray.normal);
    hit["entering"] = !ray.inside;
    hit["pigment"] = tuple_of(ray.pigment);
    hit["total_reflection"] = ray.total_reflection;
    nb::list lights;
    for (const LightRecord& light : ray.lights) {
        nb::dict entry;
        entry["light"] = light.light;
        entry["cosine"] = light.cosine;
        entry["attenuation"] = light.attenuation;
        entry["shadowed_by"] = index_or_none(light.blocker);
        entry["diffuse"] = tuple_of(light.diffuse);
        entry["specular"] = tuple_of(light.specular);
        lights.append(entry);
    }
    hit["lights"] = lights;
    return hit;
}

nb::dict ray_of(const RayRecord& ray) {
    constexpr const char* kinds[] = {"primary", "reflected", "transmitted"};
    nb::dict node, dropped;
    node["kind"] = kinds[static_cast<int>(ray.kind)];
    node["weight"] = ray.weight;
    node["depth"] = ray.depth;
    node["origin"] = tuple_of(ray.origin);
    node["direction"] = tuple_of(ray.direction);
    node["hit"] = hit_of(ray);
    node["local"] = tuple_of(ray.local);
    if (ray.reflected_dropped) {
        dropped["reflected"] = ray.reflected_dropped;
    }
    if (ray.transmitted_dropped) {
        dropped["transmitted"] = ray.transmitted_dropped;
    }
    node["dropped"] = dropped;
    node["children"] = nb::list();
    return node;
}

nb::dict trace_pixel(const Scene& scene, int width, int height, int x, int y, const Indices& set) {
    check(scene);
    const Size size = size_of(width, height);
    if (x < 0 || x >= width || y < 0 || y >= height) {
        throw nb::index_error("the pixel lies outside the picture");
    }
    const Switches switches = switches_of(set);
    Record record;
    Triple color;
    if (switches(On::single_precision)) {
        color = triple(Tracer<float>(scene, size, switches).pixel(x, y, &record));
    } else {
        color = triple(Tracer<double>(scene, size, switches).pixel(x, y, &record));
    }
    nb::list primary;
    std::vector<nb::dict> nodes;
    for (const RayRecord& ray : record.rays) {
        nodes.push_back(ray_of(ray));
        if (ray.parent < 0) {
            primary.append(nodes.back());
        } else {
            nb::cast<nb::list>(nodes[std::size_t(ray.parent)]["children"]).append(nodes.back());
        }
    }
    nb::dict result;
    result["x"] = x;
    result["y"] = y;
    result["color"] = tuple_of(color);
    result["rays"] = primary;
    return result;
}

// ---- Scenes -------------------------------------------------------------------------------------------------------------

int add_pigment(Scene& scene, Pigment pigment) {
    scene.pigments.push_back(std::move(pigment));
    return static_cast<int>(scene.pigments.size()) - 1;
}

int add_texmap(Scene& scene, const Texels& texels, const Quadruple& p0, const Quadruple& p1) {
    if (texels.size() == 0) {
        throw std::invalid_argument("a texture needs texels");
    }
    const int height = static_cast<int>(texels.shape(0)), width = static_cast<int>(texels.shape(1));
    return add_pigment(scene, {Pattern::texmap,
                               {},
                               {},
                               1,
                               width,
                               height,
                               std::vector<float>(texels.data(), texels.data() + texels.size()),
                               p0,
                               p1});
}

int add_object(Scene& scene, Object object) {
    scene.objects.push_back(std::move(object));
    return static_cast<int>(scene.objects.size()) - 1;
}

nb::list table() {
    nb::list result;
    for (const Deviation& d : deviations) {
        result.append(nb::make_tuple(d.name, d.part, d.group, d.sentence, d.hint));
    }
    return result;
}

std::vector<bool> shows(const Scene& scene) {
    check(scene);
    std::vector<bool> result;
    for (const Deviation& d : deviations) {
        result.push_back(holds(scene, d.applies));
    }
    return result;
}

}  // namespace

NB_MODULE(_student, module) {
    module.doc() = "A small scalar tracer with the mistakes of students, each a switch.";
    nb::class_<Scene>(module, "Scene", "A scene, built element by element; indices count from 0.")
        .def(
            "__init__",
            [](Scene* scene, const Triple& eye, const Triple& look_at, const Triple& up, double fovy,
               const Triple& ambient, const Triple& background, double cutoff, int max_depth) {
                new (scene) Scene{{eye, look_at, up, fovy}, ambient, background, {}, {}, {}, {}, {}, cutoff, max_depth};
            },
            nb::kw_only(), "eye"_a, "look_at"_a, "up"_a, "fovy"_a, "ambient"_a, "background"_a, "cutoff"_a,
            "max_depth"_a)
        .def(
            "set_ambient_lamp",
            [](Scene& scene, const Triple& position, const Triple& attenuation) {
                scene.ambient_lamp = {{position, scene.ambient, attenuation}};
            },
            "position"_a, "attenuation"_a)
        .def(
            "add_lamp",
            [](Scene& scene, const Triple& position, const Triple& color, const Triple& attenuation) {
                scene.lamps.push_back({position, color, attenuation});
            },
            "position"_a, "color"_a, "attenuation"_a)
        .def(
            "add_solid",
            [](Scene& scene, const Triple& color) {
                return add_pigment(scene, {Pattern::solid, color, {}, 1, 0, 0, {}, {}, {}});
            },
            "color"_a)
        .def(
            "add_checker",
            [](Scene& scene, const Triple& first, const Triple& second, double size) {
                return add_pigment(scene, {Pattern::checker, first, second, size, 0, 0, {}, {}, {}});
            },
            "first"_a, "second"_a, "size"_a)
        .def("add_texmap", &add_texmap, "texels"_a, "p0"_a, "p1"_a)
        .def(
            "add_finish",
            [](Scene& scene, double ka, double kd, double ks, double alpha, double kr, double kt, double eta,
               double ior) {
                scene.finishes.push_back({ka, kd, ks, alpha, kr, kt, eta, ior});
                return static_cast<int>(scene.finishes.size()) - 1;
            },
            nb::kw_only(), "ka"_a, "kd"_a, "ks"_a, "alpha"_a, "kr"_a, "kt"_a, "eta"_a, "ior"_a)
        .def(
            "add_sphere",
            [](Scene& scene, int pigment, int finish, const Triple& center, double radius) {
                return add_object(scene, {pigment, finish, true, center, radius, {}, true});
            },
            "pigment"_a, "finish"_a, "center"_a, "radius"_a)
        .def(
            "add_polyhedron",
            [](Scene& scene, int pigment, int finish, const std::vector<Quadruple>& planes, bool bounded) {
                return add_object(scene, {pigment, finish, false, {}, 1, planes, bounded});
            },
            "pigment"_a, "finish"_a, "planes"_a, "bounded"_a);
    module.def("deviations", &table, "Name, part, group, sentence and hint of each deviation.");
    module.def("shows", &shows, "scene"_a, "For each deviation whether the scene holds what it needs to show.");
    module.def("trace", &trace, "scene"_a, "width"_a, "height"_a, "pixels"_a, "sets"_a, "threads"_a = 1,
               "Colours (sets, n, 3) float32 of pixels (n, 2) int32, column and row, with each set of deviations.");
    module.def("levels", &bytes, "colors"_a, "deviations"_a, "Bytes (n, 3) uint8 of colours (n, 3) float32.");
    module.def("trace_pixel", &trace_pixel, "scene"_a, "width"_a, "height"_a, "x"_a, "y"_a, "deviations"_a,
               "The rays of one pixel as nested dictionaries.");
}
