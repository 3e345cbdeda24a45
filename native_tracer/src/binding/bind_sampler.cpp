// Python's view of sampler.h.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "binding/bindings.h"
#include "tracing/sampler.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace {

using namespace whitted::WHITTED_ISA;
using L = Lanes<double>;

using Words = nb::ndarray<const std::uint32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Points = nb::ndarray<const std::uint32_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Vectors = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

void same_length(std::size_t a, std::size_t b) {
    if (a != b) {
        throw std::invalid_argument("the arrays differ in length");
    }
}

// An array that owns its numbers.
template <typename Number>
nb::ndarray<nb::memview, Number> array_of(std::vector<Number> numbers, std::size_t columns) {
    auto* const kept = new std::vector<Number>(std::move(numbers));
    const nb::capsule owner(kept, [](void* vector) noexcept { delete static_cast<std::vector<Number>*>(vector); });
    const std::size_t shape[] = {kept->size() / columns, columns};
    return nb::ndarray<nb::memview, Number>(kept->data(), 2, shape, owner);
}

// The points from `begin` to `end`, as many at once as a Word holds.
template <typename Word>
void fill_points(std::uint32_t seed, bool independent, const Words (&words)[5], std::size_t begin, std::size_t end,
                 std::uint32_t* points) {
    constexpr std::size_t lanes = sizeof(Word) / sizeof(std::uint32_t);
    for (std::size_t i = begin; i < end; i += lanes) {
        const std::size_t count = std::min(lanes, end - i);
        Word taken[5] = {};
        for (std::size_t k = 0; k < 5; ++k) {
            std::memcpy(&taken[k], words[k].data() + i, count * sizeof(std::uint32_t));
        }
        auto& [column, row, number, path, what] = taken;
        Word pixel = pixel_key(Word{} + seed, column, row);
        if (independent) {
            make_independent(pixel, number);
        }
        const SamplePoint<Word> point = sample_point(pixel, number, path, what);
        std::uint32_t x[lanes], y[lanes];
        std::memcpy(x, &point.x, sizeof(x));
        std::memcpy(y, &point.y, sizeof(y));
        for (std::size_t lane = 0; lane < count; ++lane) {
            points[2 * (i + lane)] = x[lane];
            points[2 * (i + lane) + 1] = y[lane];
        }
    }
}

// The first half of them in lanes, the others one by one, as the renderer may do either.
nb::ndarray<nb::memview, std::uint32_t> sample_points(std::uint32_t seed, const Words& column, const Words& row,
                                                      const Words& k, const Words& path, const Words& what,
                                                      bool independent) {
    using Four = std::uint32_t __attribute__((vector_size(16)));
    const std::size_t count = column.shape(0);
    const Words words[5] = {column, row, k, path, what};
    for (const Words& others : words) {
        same_length(count, others.shape(0));
    }
    std::vector<std::uint32_t> points(2 * count);
    fill_points<Four>(seed, independent, words, 0, count / 2, points.data());
    fill_points<std::uint32_t>(seed, independent, words, count / 2, count, points.data());
    return array_of(std::move(points), 2);
}

// Calls visit(u, v, lanes' numbers, how many of them count) for all points, some at once.
template <typename Visit>
void for_points(const Points& points, Visit visit) {
    const std::size_t count = points.shape(0);
    for (std::size_t i = 0; i < count; i += lane_count<double>) {
        const auto at = [&](int lane) { return std::min(i + static_cast<std::size_t>(lane), count - 1); };
        const auto coordinate = [&](std::size_t axis) {
            return L::gather([&](int lane) { return unit_interval<double>(points(at(lane), axis)); });
        };
        visit(coordinate(0), coordinate(1), at, static_cast<int>(std::min<std::size_t>(lane_count<double>, count - i)));
    }
}

nb::ndarray<nb::memview, double> disc_points(const Points& points) {
    std::vector<double> found(2 * points.shape(0));
    for_points(points, [&](L u, L v, auto at, int count) {
        const PlanePoint<double> point = disc_point(u, v);
        for (int lane = 0; lane < count; ++lane) {
            found[2 * at(lane)] = point.x[lane];
            found[2 * at(lane) + 1] = point.y[lane];
        }
    });
    return array_of(std::move(found), 2);
}

nb::ndarray<nb::memview, double> cone_directions(const Vectors& axes, const Numbers& versines, const Points& points) {
    same_length(points.shape(0), axes.shape(0));
    same_length(points.shape(0), versines.shape(0));
    std::vector<double> found(3 * points.shape(0));
    for_points(points, [&](L u, L v, auto at, int count) {
        const auto axis = gather<double>(
            [&](int lane) -> Vector<double> { return {axes(at(lane), 0), axes(at(lane), 1), axes(at(lane), 2)}; });
        const L versine = L::gather([&](int lane) { return versines(at(lane)); });
        const Vector<L> direction = cone_direction(Frame<double>(axis), versine, u, v);
        for (int lane = 0; lane < count; ++lane) {
            found[3 * at(lane)] = direction.x[lane];
            found[3 * at(lane) + 1] = direction.y[lane];
            found[3 * at(lane) + 2] = direction.z[lane];
        }
    });
    return array_of(std::move(found), 3);
}

}  // namespace

void bind_sampler(nb::module_& module) {
    module.def("sample_points", &sample_points, "seed"_a, "column"_a, "row"_a, "k"_a, "path"_a, "use"_a,
               "independent"_a = false, "The points of samples; see native_tracer.sampler.");
    module.def("disc_points", &disc_points, "points"_a, "Points of the unit disc; see native_tracer.sampler.");
    module.def("cone_directions", &cone_directions, "axes"_a, "versines"_a, "points"_a,
               "Directions in cones; see native_tracer.sampler.");
}
