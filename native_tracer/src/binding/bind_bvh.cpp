// Python's view of bvh.h.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "binding/bindings.h"
#include "search/bvh.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace {

using Corners = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

std::vector<whitted::Box> boxes_of(const Corners& low, const Corners& high) {
    const std::size_t count = low.shape(0);
    if (high.shape(0) != count) {
        throw std::invalid_argument("there are " + std::to_string(count) + " low corners, but " +
                                    std::to_string(high.shape(0)) + " high ones");
    }
    if (count > std::numeric_limits<std::int32_t>::max()) {
        throw std::invalid_argument("there are too many boxes");
    }
    std::vector<whitted::Box> boxes(count);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            boxes[i].low[k] = low.data()[3 * i + k];
            boxes[i].high[k] = high.data()[3 * i + k];
            if (!std::isfinite(boxes[i].low[k]) || !std::isfinite(boxes[i].high[k])) {
                throw std::invalid_argument("box " + std::to_string(i) + " is not finite");
            }
            if (boxes[i].low[k] > boxes[i].high[k]) {
                throw std::invalid_argument("box " + std::to_string(i) + " has a low corner above its high one");
            }
        }
    }
    return boxes;
}

// An array that owns its numbers.
template <typename Number>
nb::ndarray<nb::memview, Number> array_of(std::vector<Number> numbers, std::size_t columns) {
    auto* const kept = new std::vector<Number>(std::move(numbers));
    const nb::capsule owner(kept, [](void* vector) noexcept { delete static_cast<std::vector<Number>*>(vector); });
    const std::size_t shape[] = {kept->size() / columns, columns};
    return nb::ndarray<nb::memview, Number>(kept->data(), columns == 1 ? 1 : 2, shape, owner);
}

nb::tuple threaded_bvh(const Corners& low, const Corners& high) {
    whitted::ThreadedBvh tree;
    {
        const std::vector<whitted::Box> boxes = boxes_of(low, high);
        const nb::gil_scoped_release others_may_run;
        tree = whitted::thread_bvh(whitted::build_bvh(boxes, 1));
    }
    return nb::make_tuple(array_of(std::move(tree.corners), 6), array_of(std::move(tree.skip), 1),
                          array_of(std::move(tree.item), 1));
}

}  // namespace

void bind_bvh(nb::module_& module) {
    module.def("threaded_bvh", &threaded_bvh, "low"_a, "high"_a,
               "The arrays of a threaded tree over boxes; see native_tracer.bvh.");
}
