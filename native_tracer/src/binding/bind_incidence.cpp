// Python's view of incidence.h.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "binding/bindings.h"
#include "tracing/incidence.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace {

using Rows = nb::ndarray<const double, nb::shape<-1, 4>, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::vector<std::size_t> surfaces_at(const whitted::Triple& point, const Rows& rows, const Flags& round) {
    if (rows.shape(0) != round.shape(0)) {
        throw std::invalid_argument("there has to be a flag for every row");
    }
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < rows.shape(0); ++i) {
        const double* row = rows.data() + 4 * i;
        const bool lies = round(i) != 0
                              ? whitted::lies_on(whitted::SphereDescription{{row[0], row[1], row[2]}, row[3]}, point)
                              : whitted::lies_on(whitted::Quadruple{row[0], row[1], row[2], row[3]}, point);
        if (lies) {
            found.push_back(i);
        }
    }
    return found;
}

bool within(const whitted::Triple& point, const Rows& rows) {
    std::vector<whitted::Quadruple> planes(rows.shape(0));
    for (std::size_t i = 0; i < planes.size(); ++i) {
        std::copy_n(rows.data() + 4 * i, 4, planes[i].begin());
    }
    return whitted::lies_within(planes, point);
}

}  // namespace

void bind_incidence(nb::module_& module) {
    module.def("surfaces_at", &surfaces_at, "point"_a, "rows"_a, "round"_a,
               "Which surfaces a point lies on; see native_tracer.incidence.");
    module.def("within", &within, "point"_a, "planes"_a,
               "Whether a point lies in a body or on its surface; see native_tracer.incidence.");
}
