// Python's view of halfspaces.h. Flat buffers of doubles come in, plain tuples go out, so that NumPy is not needed.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "halfspaces/conflict.h"
#include "halfspaces/halfspaces.h"
#include "halfspaces/parallel.h"
#include "halfspaces/plate.h"

namespace nb = nanobind;

namespace {

using whitted::halfspaces::Body;
using whitted::halfspaces::Face;
using whitted::halfspaces::Plane;
using whitted::halfspaces::Vec;

using Coefficients = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Offsets = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

nb::tuple to_tuple(const Vec& v) {
    return nb::make_tuple(static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
}

std::vector<Plane> read_planes(const Coefficients& coefficients, std::size_t first, std::size_t last) {
    std::vector<Plane> planes;
    planes.reserve(last - first);
    for (std::size_t k = first; k < last; ++k) {
        const double* c = coefficients.data() + 4 * k;
        const Plane plane(c[0], c[1], c[2], c[3]);
        if (!std::isfinite(plane.normal.x) || !std::isfinite(plane.normal.y) || !std::isfinite(plane.normal.z) ||
            !std::isfinite(plane.offset)) {
            throw std::invalid_argument("plane " + std::to_string(k - first) +
                                        " has a zero normal or a coefficient that is not finite");
        }
        planes.push_back(plane);
    }
    return planes;
}

std::size_t count_planes(const Coefficients& coefficients) {
    if (coefficients.size() % 4 != 0) {
        throw std::invalid_argument("planes have four coefficients each");
    }
    return coefficients.size() / 4;
}

struct Result {
    Body body;
    std::vector<int> conflict;
};

// Leaves the faces of all planes in `faces`; of a plate that of its first one alone.
Result examine(const std::vector<Plane>& planes, std::vector<Face>& faces) {
    Result result{whitted::halfspaces::body_of(planes, faces), {}};
    if (!result.body.solid) {
        result.conflict = whitted::halfspaces::conflict_of(planes);
        result.body = {};
        if (result.conflict.size() == 2) {
            result.body = whitted::halfspaces::plate_of(planes, result.conflict, faces);
        }
        if (!result.body.plate.empty()) {
            result.conflict.clear();
        }
    }
    return result;
}

nb::tuple describe(const Result& result) {
    const Body& body = result.body;
    const bool known = body.solid || !body.plate.empty();
    return nb::make_tuple(body.solid, nb::tuple(nb::cast(body.plate)), known && body.bounded,
                          nb::tuple(nb::cast(body.kept)), nb::tuple(nb::cast(body.redundant)), to_tuple(body.low),
                          to_tuple(body.high), to_tuple(body.inside), nb::tuple(nb::cast(result.conflict)));
}

nb::list bodies(const Coefficients& coefficients, const Offsets& offsets) {
    const std::size_t count = count_planes(coefficients);
    std::vector<std::vector<Plane>> polyhedra;
    for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
        const std::int64_t first = offsets(i);
        const std::int64_t last = offsets(i + 1);
        if (first < 0 || last < first || static_cast<std::size_t>(last) > count) {
            throw std::invalid_argument("offsets have to ascend, from 0 to the number of planes at most");
        }
        polyhedra.push_back(read_planes(coefficients, static_cast<std::size_t>(first), static_cast<std::size_t>(last)));
    }
    std::vector<Result> results(polyhedra.size());
    {
        const nb::gil_scoped_release others_may_run;
        constexpr std::size_t share = 256;  // small polyhedra, a few milliseconds
        whitted::for_each_index(results.size(), share, [&](std::size_t i) {
            std::vector<Face> unused;
            results[i] = examine(polyhedra[i], unused);
        });
    }
    nb::list list;
    for (const Result& result : results) {
        list.append(describe(result));
    }
    return list;
}

// The edges of one face: neighbours, -1 where there is none, and three coordinates of where each edge begins.
nb::tuple describe(const Face& face, const std::vector<int>& kept) {
    std::vector<int> neighbors;
    std::vector<double> points;
    for (const auto& [turn, edge] : face.edges()) {
        const Vec p = face.at(edge, edge.low);
        neighbors.push_back(edge.neighbor < 0 ? -1 : kept[static_cast<std::size_t>(edge.neighbor)]);
        points.insert(points.end(), {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)});
    }
    return nb::make_tuple(nb::cast(neighbors), nb::cast(points), static_cast<double>(face.area()));
}

nb::list faces(const Coefficients& coefficients) {
    const std::vector<Plane> all = read_planes(coefficients, 0, count_planes(coefficients));
    std::vector<Face> faces;
    const Body body = examine(all, faces).body;
    nb::list list;
    if ((!body.solid && body.plate.empty()) || !body.bounded) {
        return list;
    }
    const auto add_none = [&] {
        for (std::size_t k = 0; k < all.size(); ++k) {
            list.append(nb::make_tuple(nb::list(), nb::list(), 0.0));
        }
    };
    if (!body.solid) {
        std::vector<int> numbers(all.size());
        std::iota(numbers.begin(), numbers.end(), 0);
        add_none();
        list[faces[0].index()] = describe(faces[0], numbers);
        return list;
    }
    std::vector<Plane> planes;
    for (const int k : body.kept) {
        planes.push_back(all[static_cast<std::size_t>(k)]);
    }
    if (planes.size() < all.size()) {
        // Once more without the planes that only touch the body: then every edge has its two proper neighbours.
        const Body again = whitted::halfspaces::body_of(planes, faces);
        if (!again.solid || !again.bounded || again.kept.size() < planes.size()) {
            return list;  // it is those planes' roundings that bound the body
        }
    }
    add_none();
    for (std::size_t k = 0; k < planes.size(); ++k) {
        list[static_cast<std::size_t>(body.kept[k])] = describe(faces[k], body.kept);
    }
    return list;
}

nb::list polygons(const Coefficients& coefficients, double far, std::size_t leaf_size) {
    const std::vector<Plane> planes = read_planes(coefficients, 0, count_planes(coefficients));
    std::vector<int> numbers(planes.size());
    std::iota(numbers.begin(), numbers.end(), 0);
    nb::list list;
    for (const Face& face : whitted::halfspaces::faces_of(planes, far, leaf_size)) {
        list.append(describe(face, numbers));
    }
    return list;
}

}  // namespace

void bind_halfspaces(nb::module_& m) {
    m.def("halfspace_bodies", &bodies, nb::arg("coefficients"), nb::arg("offsets"),
          "What is known of each intersection of half-spaces; see native_tracer.halfspaces.");
    m.def("halfspace_faces", &faces, nb::arg("coefficients"),
          "The face polygons of one bounded intersection; see native_tracer.halfspaces.");
    m.def("halfspace_polygons", &polygons, nb::arg("coefficients"), nb::arg("far"), nb::arg("leaf_size"),
          "The face polygons of any intersection as far as `far`; a `leaf_size` not below the number of planes has all "
          "of them tried, and none searched for.");
}
