// The certifying tracer as a Python module. A number is a pair: doubles that add up to it, and how far it may be off.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "certify.h"
#include "given.h"
#include "scene.h"

namespace nb = nanobind;
using namespace nb::literals;
using namespace certified;

namespace {

using Texels = nb::ndarray<const std::uint16_t, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>;
using Pixels = nb::ndarray<const std::int32_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

void check(const Scene& scene) {
    const auto below = [](int index, std::size_t size) { return index >= 0 && static_cast<std::size_t>(index) < size; };
    for (const Body& body : scene.bodies) {
        if (!below(body.pigment, scene.pigments.size()) || !below(body.finish, scene.finishes.size())) {
            throw nb::index_error("a body's pigment or finish does not exist");
        }
    }
    for (const Surface& surface : scene.surfaces) {
        const std::size_t wanted = surface.kind == Kind::quadric ? 10 : 4;
        if (surface.numbers.size() != wanted || surface.lights.size() != scene.lights.size()) {
            throw std::invalid_argument("a surface lacks numbers, or lights");
        }
    }
    if (scene.width < 1 || scene.height < 1 || scene.grid < 1) {
        throw std::invalid_argument("a picture needs a width, a height and rays");
    }
}

template <typename Value>
auto owned(std::vector<Value>&& values, std::initializer_list<std::size_t> shape) {
    auto* kept = new std::vector<Value>(std::move(values));
    const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<Value>*>(p); });
    return nb::ndarray<nb::numpy, Value>(kept->data(), shape, owner);
}

nb::dict certify_pixels(const Scene& scene, const Pixels& pixels, int first, int last, int threads, nb::object progress,
                        bool quick) {
    check(scene);
    const std::size_t count = pixels.shape(0);
    std::vector<std::array<int, 2>> places(count);
    for (std::size_t i = 0; i < count; ++i) {
        places[i] = {pixels.data()[2 * i], pixels.data()[2 * i + 1]};
    }
    const auto watch = [&](double done) {
        const nb::gil_scoped_acquire lock;
        if (PyErr_CheckSignals() != 0) {
            throw nb::python_error();
        }
        if (!progress.is_none()) {
            progress(done);
        }
    };
    std::vector<Pixel> results;
    {
        const nb::gil_scoped_release unlocked;
        results = certify(scene, places, first, last, threads, quick, watch);
    }
    std::vector<std::uint8_t> low, high, reason, rung, tied;
    std::vector<double> color;
    for (const Pixel& pixel : results) {
        low.insert(low.end(), pixel.low.begin(), pixel.low.end());
        high.insert(high.end(), pixel.high.begin(), pixel.high.end());
        color.insert(color.end(), pixel.color.begin(), pixel.color.end());
        reason.push_back(static_cast<std::uint8_t>(pixel.reason));
        rung.push_back(pixel.rung);
        tied.push_back(pixel.tied);
    }
    nb::dict found;
    found["low"] = owned(std::move(low), {count, 3});
    found["high"] = owned(std::move(high), {count, 3});
    found["color"] = owned(std::move(color), {count, 3});
    found["reason"] = owned(std::move(reason), {count});
    found["rung"] = owned(std::move(rung), {count});
    found["tied"] = owned(std::move(tied), {count});
    return found;
}

}  // namespace

NB_MODULE(_certified, module) {
    module.doc() = "A tracer of intervals, which proves the bytes of pixels.";
    nb::class_<Scene>(module, "Scene", "A scene, built element by element; indices count from 0.")
        .def(
            "__init__",
            [](Scene* scene, const GivenTriple& eye, const GivenTriple& look_at, const GivenTriple& up,
               const Given& fovy, const GivenTriple& ambient, const GivenTriple& background, const Given& cutoff,
               int max_depth, int width, int height, int grid, bool corner, bool blinn, bool ties) {
                new (scene) Scene{numbers(eye),
                                  numbers(look_at),
                                  numbers(up),
                                  number(fovy),
                                  numbers(ambient),
                                  numbers(background),
                                  number(cutoff),
                                  max_depth,
                                  width,
                                  height,
                                  grid,
                                  corner,
                                  blinn,
                                  ties,
                                  {},
                                  {},
                                  {},
                                  {},
                                  {},
                                  {}};
            },
            nb::kw_only(), "eye"_a, "look_at"_a, "up"_a, "fovy"_a, "ambient"_a, "background"_a, "cutoff"_a,
            "max_depth"_a, "width"_a, "height"_a, "grid"_a, "corner"_a, "blinn"_a, "ties"_a)
        .def(
            "add_light",
            [](Scene& scene, const GivenTriple& position, const GivenTriple& color, const GivenTriple& attenuation) {
                scene.lights.push_back({numbers(position), numbers(color), numbers(attenuation)});
            },
            "position"_a, "color"_a, "attenuation"_a)
        .def(
            "add_solid",
            [](Scene& scene, const GivenTriple& color) {
                Pigment pigment{};
                pigment.pattern = Pattern::solid;
                pigment.first = pigment.second = numbers(color);
                pigment.size = {{1}, 0};
                scene.pigments.push_back(pigment);
            },
            "color"_a)
        .def(
            "add_checker",
            [](Scene& scene, const GivenTriple& first, const GivenTriple& second, const Given& size) {
                Pigment pigment{};
                pigment.pattern = Pattern::checker;
                pigment.first = numbers(first);
                pigment.second = numbers(second);
                pigment.size = number(size);
                scene.pigments.push_back(pigment);
            },
            "first"_a, "second"_a, "size"_a)
        .def(
            "add_texmap",
            [](Scene& scene, const Texels& texels, int largest, const GivenFour& columns, const GivenFour& rows) {
                if (texels.size() == 0) {
                    throw std::invalid_argument("a texture needs texels");
                }
                Pigment pigment{};
                pigment.pattern = Pattern::texmap;
                const Number zero{{0}, 0};
                pigment.first = pigment.second = {zero, zero, zero};
                pigment.size = zero;
                pigment.width = static_cast<int>(texels.shape(1));
                pigment.height = static_cast<int>(texels.shape(0));
                pigment.texels.assign(texels.data(), texels.data() + texels.size());
                pigment.largest = largest;
                pigment.columns = numbers(columns);
                pigment.rows = numbers(rows);
                scene.pigments.push_back(pigment);
            },
            "texels"_a, "largest"_a, "columns"_a, "rows"_a)
        .def(
            "add_finish",
            [](Scene& scene, const std::array<Given, 7>& given, bool ior_is_index) {
                const auto n = numbers(given);
                scene.finishes.push_back({n[0], n[1], n[2], n[3], n[4], n[5], n[6], ior_is_index});
            },
            "numbers"_a, "ior_is_index"_a)
        .def(
            "add_leaf",
            [](Scene& scene, int kind, const std::vector<std::vector<Given>>& surfaces,
               const std::vector<int>& identities, const std::vector<bool>& eye,
               const std::vector<std::vector<bool>>& lights, const std::vector<std::pair<int, std::int64_t>>& layers) {
                if (kind < 0 || kind > 2 || surfaces.empty() || identities.size() != surfaces.size() ||
                    eye.size() != surfaces.size() || lights.size() != surfaces.size() ||
                    layers.size() != surfaces.size()) {
                    throw std::invalid_argument("a leaf needs surfaces of a kind");
                }
                const std::size_t first = scene.surfaces.size();
                for (std::size_t i = 0; i < surfaces.size(); ++i) {
                    scene.surfaces.push_back({static_cast<Kind>(kind), numbers(surfaces[i]), identities[i], eye[i],
                                              lights[i], layers[i].first, layers[i].second});
                }
                scene.leaves.push_back({first, surfaces.size()});
                return scene.leaves.size() - 1;
            },
            "kind"_a, "surfaces"_a, "identities"_a, "eye"_a, "lights"_a, "layers"_a)
        .def(
            "add_body",
            [](Scene& scene, int pigment, int finish, const std::vector<std::size_t>& leaves,
               const std::vector<int>& program, const std::array<double, 3>& low, const std::array<double, 3>& high) {
                for (const std::size_t leaf : leaves) {
                    if (leaf >= scene.leaves.size()) {
                        throw nb::index_error("a body's leaf does not exist");
                    }
                }
                if (leaves.empty() || leaves.size() > 64) {
                    throw std::invalid_argument("a body has 1 to 64 leaves");
                }
                scene.bodies.push_back({pigment, finish, leaves, program, low, high});
            },
            "pigment"_a, "finish"_a, "leaves"_a, "program"_a, "low"_a, "high"_a);
    module.def(
        "certify", &certify_pixels, "scene"_a, "pixels"_a, "first"_a, "last"_a, "threads"_a,
        "progress"_a.none() = nb::none(), "quick"_a = true,
        "What is known of pixels (n, 2) int32, column and row, on some of the rungs: arrays by name. Not `quick`: "
        "by their intervals alone.");
    bind_tests(module);
    nb::list reasons;
    for (const char* name : reason_names) {
        reasons.append(name);
    }
    module.attr("reasons") = reasons;
    module.attr("digits") = nb::cast(std::vector<int>(rung_digits.begin(), rung_digits.end()));
}
