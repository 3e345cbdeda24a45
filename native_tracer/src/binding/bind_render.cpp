// Rendering, the ray tree of a pixel, and bytes for a picture file.

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
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "binding/bindings.h"
#include "tracing/description.h"
#include "tracing/kernel.h"
#include "tracing/render.h"

namespace nb = nanobind;
using namespace nb::literals;
using namespace whitted;

namespace {

RenderSettings settings_of(int width, int height, int samples, std::uint32_t seed, bool independent, bool corner,
                           bool blinn, double cutoff, int max_depth, const std::string& precision,
                           const std::string& search) {
    if (width <= 0 || height <= 0) {
        throw std::invalid_argument("a picture needs a width and a height above 0");
    }
    const int grid = static_cast<int>(std::lround(std::sqrt(std::max(samples, 0))));
    if (samples < 1 || grid * grid != samples) {
        throw std::invalid_argument("samples must be a square number");
    }
    if (!(cutoff >= 0)) {
        throw std::invalid_argument("cutoff must not be negative");
    }
    if (max_depth < 0) {
        throw std::invalid_argument("max_depth must not be negative");
    }
    RenderSettings settings{width, height, {0, 0, width}, grid, seed, independent, corner, blinn, cutoff, max_depth};
    if (precision == "float") {
        settings.precision = Precision::single;
    } else if (precision == "long double") {
        settings.precision = Precision::extended;
    } else if (precision != "double") {
        throw std::invalid_argument("precision must be 'float', 'double' or 'long double'");
    }
    if (search == "brute") {
        settings.search = Search::brute;
    } else if (search == "bvh") {
        settings.search = Search::bvh;
    } else if (search != "auto") {
        throw std::invalid_argument("search must be 'auto', 'brute' or 'bvh'");
    }
    return settings;
}

using Mask = nb::ndarray<const std::uint8_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Signatures = nb::ndarray<std::uint32_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

void check_passes(const std::vector<Places>& passes, int samples) {
    std::vector<bool> found(static_cast<std::size_t>(samples));
    for (const Places& places : passes) {
        for (const int place : places) {
            if (place < 0 || place >= samples || found[static_cast<std::size_t>(place)]) {
                throw std::invalid_argument("passes name each sample once at most");
            }
            found[static_cast<std::size_t>(place)] = true;
        }
        if (places.empty()) {
            throw std::invalid_argument("a pass has a sample");
        }
    }
}

nb::dict dict_of(const RayCounts& counts) {
    nb::dict result;
    result["primary"] = counts.primary;
    result["reflected"] = counts.reflected;
    result["transmitted"] = counts.transmitted;
    result["shadow"] = counts.shadow;
    result["deepest"] = counts.deepest;
    result["pixels_too_deep"] = counts.pixels_too_deep;
    return result;
}

void render_image(const SceneDescription& scene, Image& image, int samples, std::uint32_t seed, bool independent,
                  bool corner, bool blinn, double cutoff, int max_depth, const std::string& precision,
                  const std::string& search, int threads, nb::object progress, const std::string& instructions,
                  const std::vector<Places>& passes, PassSums* sums, std::optional<Mask> mask,
                  std::optional<Signatures> signatures, double least_weight, std::optional<std::pair<int, int>> picture,
                  const std::pair<int, int>& first) {
    const auto [width, height] = picture.value_or(std::pair(image.width(), image.height()));
    RenderSettings settings =
        settings_of(width, height, samples, seed, independent, corner, blinn, cutoff, max_depth, precision, search);
    settings.part = {first.first, first.second, image.width()};
    if (first.first < 0 || first.second < 0 || image.width() > width - first.first ||
        image.height() > height - first.second) {
        throw std::invalid_argument("the image does not lie in the picture");
    }
    if (!progress.is_none() && !PyCallable_Check(progress.ptr())) {
        throw nb::type_error("progress must be callable");
    }
    if (sums != nullptr) {
        check_passes(passes, samples);
    }
    const auto fits = [&](const auto& words) {
        return words.shape(0) == static_cast<std::size_t>(image.height()) &&
               words.shape(1) == static_cast<std::size_t>(image.width());
    };
    if ((mask && !fits(*mask)) || (signatures && !fits(*signatures))) {
        throw std::invalid_argument("a mask and signatures have the image's height and width");
    }
    if (mask && sums == nullptr) {
        throw std::invalid_argument("a mask goes with sums");
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
    const nb::gil_scoped_release unlocked;
    const std::unique_ptr<Kernel> kernel = make_kernel(scene, settings, instructions);
    if (sums != nullptr) {
        render(*kernel, image, *sums, passes, mask ? mask->data() : nullptr, threads, watch);
    } else if (signatures) {
        render_signed(*kernel, image, signatures->data(), least_weight, threads, watch);
    } else {
        render(*kernel, image, threads, watch);
    }
}

// ---- The ray tree of a pixel --------------------------------------------------------------------------------------

nb::tuple tuple_of(const Triple& v) { return nb::make_tuple(v[0], v[1], v[2]); }

nb::object index_or_none(int index) { return index < 0 ? nb::object(nb::none()) : nb::object(nb::int_(index)); }

const char* name_of(RayKind kind) {
    return kind == RayKind::primary ? "primary" : kind == RayKind::reflected ? "reflected" : "transmitted";
}

nb::dict dict_of(const LightRecord& light) {
    nb::dict result;
    result["light"] = light.light;
    result["cosine"] = light.cosine;
    result["shadowed_by"] = index_or_none(light.occluder);
    result["attenuation"] = light.attenuation;
    result["diffuse"] = tuple_of(light.diffuse);
    result["specular"] = tuple_of(light.specular);
    return result;
}

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
    nb::list lights;
    for (const LightRecord& light : ray.lights) {
        lights.append(dict_of(light));
    }
    hit["lights"] = lights;
    hit["total_reflection"] = ray.total_reflection;
    return hit;
}

nb::dict dropped_of(const RayRecord& ray) {
    nb::dict dropped;
    const auto add = [&](const char* kind, Successor successor) {
        if (successor == Successor::below_cutoff) {
            dropped[kind] = "cutoff";
        } else if (successor == Successor::too_deep) {
            dropped[kind] = "depth";
        }
    };
    add("reflected", ray.reflected);
    add("transmitted", ray.transmitted);
    return dropped;
}

nb::dict trace_pixel(const SceneDescription& scene, int width, int height, int x, int y, int samples,
                     std::uint32_t seed, bool independent, bool corner, bool blinn, double cutoff, int max_depth,
                     const std::string& precision, const std::string& search) {
    const RenderSettings settings =
        settings_of(width, height, samples, seed, independent, corner, blinn, cutoff, max_depth, precision, search);
    if (x < 0 || x >= width || y < 0 || y >= height) {
        throw nb::index_error("the pixel lies outside the picture");
    }
    std::array<float, 3> color;
    RayTree tree;
    record_pixel(scene, settings, x, y, color.data(), tree);
    const std::vector<RayRecord>& rays = tree.records();

    const bool moves = std::any_of(scene.objects.begin(), scene.objects.end(), [](const ObjectDescription& object) {
        return std::holds_alternative<MovingDescription>(object.shape);
    });

    std::vector<nb::dict> nodes(rays.size());
    std::vector<Triple> radiance(rays.size());
    std::vector<nb::list> children(rays.size());
    nb::list primary;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const RayRecord& ray = rays[i];
        (ray.parent < 0 ? primary : children[static_cast<std::size_t>(ray.parent)]).append(nodes[i]);
        radiance[i] = ray.local;
    }
    // Successors come after their parents: from the last to the first, each finds its own colour complete.
    for (std::size_t i = rays.size(); i-- > 0;) {
        const RayRecord& ray = rays[i];
        if (ray.parent >= 0) {
            const auto parent = static_cast<std::size_t>(ray.parent);
            for (std::size_t channel = 0; channel < 3; ++channel) {
                radiance[parent][channel] += ray.weight / rays[parent].weight * radiance[i][channel];
            }
        }
    }
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const RayRecord& ray = rays[i];
        nb::dict& node = nodes[i];
        node["kind"] = name_of(ray.kind);
        node["weight"] = ray.weight;
        node["depth"] = ray.depth;
        node["origin"] = tuple_of(ray.origin);
        node["direction"] = tuple_of(ray.direction);
        if (moves) {
            node["time"] = ray.time;
        }
        node["hit"] = hit_of(ray);
        node["local"] = tuple_of(ray.local);
        node["dropped"] = dropped_of(ray);
        node["radiance"] = tuple_of(radiance[i]);
        node["children"] = children[i];
    }
    nb::dict result;
    result["x"] = x;
    result["y"] = y;
    result["color"] = nb::make_tuple(color[0], color[1], color[2]);
    result["rays"] = primary;
    return result;
}

// ---- Pixels -------------------------------------------------------------------------------------------------------

using Pixels = nb::ndarray<const float, nb::c_contig, nb::device::cpu>;

std::size_t count_nan_pixels(const Pixels& pixels) {
    std::size_t count = 0;
    for (const float* pixel = pixels.data(); pixel != pixels.data() + pixels.size() / 3 * 3; pixel += 3) {
        count += std::isnan(pixel[0]) || std::isnan(pixel[1]) || std::isnan(pixel[2]) ? 1 : 0;
    }
    return count;
}

// ---- Bytes --------------------------------------------------------------------------------------------------------

// The nearest of 255 levels to c, clamped to 0..1, halves up, where a half is one also if roundings have left it a
// little below: decimal numbers in files make halves common, and renderers must not differ in them. A NaN is black. In
// double, where 255 c is exact. Block by block, so that the compiler can compute several at once.
void quantize(const float* values, std::size_t count, std::uint8_t* bytes) {
    constexpr std::size_t block = 1024;
    constexpr double half = 0.5 + 1e-4;  // of a level
    std::int32_t rounded[block];
    for (std::size_t first = 0; first < count; first += block) {
        const std::size_t size = std::min(block, count - first);
        for (std::size_t i = 0; i < size; ++i) {
            const float positive = values[first + i] > 0.0F ? values[first + i] : 0.0F;
            const float clamped = positive < 1.0F ? positive : 1.0F;
            rounded[i] = static_cast<std::int32_t>(255.0 * static_cast<double>(clamped) + half);
        }
        for (std::size_t i = 0; i < size; ++i) {
            bytes[first + i] = static_cast<std::uint8_t>(rounded[i]);
        }
    }
}

nb::bytes quantized(const Pixels& pixels) {
    const auto result =
        nb::steal<nb::bytes>(PyBytes_FromStringAndSize(nullptr, static_cast<Py_ssize_t>(pixels.size())));
    if (!result.is_valid()) {
        throw nb::python_error();
    }
    quantize(pixels.data(), pixels.size(), reinterpret_cast<std::uint8_t*>(PyBytes_AsString(result.ptr())));
    return result;
}

}  // namespace

void bind_render(nb::module_& module) {
    nb::class_<Image>(module, "Image", "A picture to be drawn into: linear RGB, row 0 on top, black at first.")
        .def(nb::init<int, int>(), "width"_a, "height"_a)
        .def_prop_ro("width", &Image::width)
        .def_prop_ro("height", &Image::height)
        .def_prop_ro(
            "pixels",
            [](nb::handle self) {
                auto& image = nb::cast<Image&>(self);
                const std::size_t shape[] = {static_cast<std::size_t>(image.height()),
                                             static_cast<std::size_t>(image.width()), 3};
                return nb::ndarray<nb::memview, float>(image.data(), 3, shape, self);
            },
            nb::rv_policy::reference, "A memoryview of height x width x 3 float32, not a copy.")
        .def_prop_ro(
            "statistics",
            [](const Image& image) {
                nb::dict result = dict_of(image.counts);
                result["threads"] = image.threads;
                result["search"] = image.by_tree ? "bvh" : "brute";
                return result;
            },
            "Rays of the last rendering by kind, its deepest bounce, its threads, and how it searched.");

    nb::class_<PassSums>(module, "PassSums", "Sums of the samples of whole passes: what drawing may go on from.")
        .def(nb::init<int, int>(), "width"_a, "height"_a)
        .def_rw("passes", &PassSums::passes, "How many passes are in the sums.")
        .def_prop_ro(
            "colors",
            [](nb::handle self) {
                auto& sums = nb::cast<PassSums&>(self);
                const std::size_t shape[] = {static_cast<std::size_t>(sums.height()),
                                             static_cast<std::size_t>(sums.width()), 3};
                return nb::ndarray<nb::memview, double>(sums.colors(), 3, shape, self);
            },
            nb::rv_policy::reference, "A memoryview of height x width x 3 float64, not a copy.")
        .def_prop_ro(
            "too_deep",
            [](nb::handle self) {
                auto& sums = nb::cast<PassSums&>(self);
                const std::size_t shape[] = {static_cast<std::size_t>(sums.height()),
                                             static_cast<std::size_t>(sums.width())};
                return nb::ndarray<nb::memview, std::uint8_t>(sums.too_deep(), 2, shape, self);
            },
            nb::rv_policy::reference, "A memoryview of height x width bytes: 1 where the depth limit dropped a ray.")
        .def_prop_rw(
            "counts", [](const PassSums& sums) { return dict_of(sums.counts); },
            [](PassSums& sums, const nb::dict& counts) {
                const auto read = [&](const char* name) { return nb::cast<std::uint64_t>(counts[name]); };
                sums.counts = {read("primary"), read("reflected"),       read("transmitted"),
                               read("shadow"),  read("pixels_too_deep"), nb::cast<int>(counts["deepest"])};
            },
            "Rays of the passes by kind, and their deepest bounce.");

    module.def(
        "render", &render_image, "scene"_a, "image"_a, nb::kw_only(), "samples"_a = 1, "seed"_a = 0,
        "independent"_a = false, "corner"_a = true, "blinn"_a = false, "cutoff"_a, "max_depth"_a,
        "precision"_a = "double", "search"_a = "auto", "threads"_a = 0, "progress"_a = nb::none(),
        "instructions"_a = "", "passes"_a = nb::list(), "sums"_a = nb::none(), "mask"_a = nb::none(),
        "signatures"_a = nb::none(), "least_weight"_a = 0.0, "picture"_a = nb::none(), "first"_a = std::pair(0, 0),
        "Draw `scene` into `image`. `progress` is called about 20 times a second with the finished share; what\n"
        "it raises, and Ctrl-C, stop the rendering, and what is finished stays in the image.\n"
        "With `sums`, of the image's size, it is drawn in `passes`, which name each sample once at most; passes that "
        "are\n"
        "in the sums are not drawn again, and those that become whole are added. With a `mask` of bytes, too, height\n"
        "x width, only the pixels are drawn that are not 0 there. `signatures`, of uint32, get a word each for what\n"
        "is decided along the pixel's rays that weigh at least `least_weight`. The image may be a part of a `picture` "
        "of\n"
        "that width and height, from the pixel `first`, its column and row, on.");
    module.def("trace_pixel", &trace_pixel, "scene"_a, "width"_a, "height"_a, "x"_a, "y"_a, nb::kw_only(),
               "samples"_a = 1, "seed"_a = 0, "independent"_a = false, "corner"_a = true, "blinn"_a = false, "cutoff"_a,
               "max_depth"_a, "precision"_a = "double", "search"_a = "auto",
               "The rays of one pixel as nested dictionaries.");
    module.def("count_nan_pixels", &count_nan_pixels, "pixels"_a,
               "How many pixels of a float32 buffer, three numbers each, have a NaN among them.");
    module.def(
        "quantize", &quantized, "pixels"_a,
        "8-bit RGB of a float32 buffer: the nearest of 255 levels to c, halves up, c clamped to 0..1, a NaN black.");
}
