#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "search/bounds.h"
#include "shapes/canonical_form.h"

namespace whitted {

// Only an ellipsoid has bounds. Along a direction e it is as wide on both sides of its centre as the length of the
// vector with the components (e.axis) times semi-axis.
std::optional<Bounds> bounds_of(const QuadricDescription& quadric) {
    CanonicalForm form = canonical_form(quadric);
    std::array<long double, 3> along;
    for (std::size_t i = 0; i < 3; ++i) {
        if (!(form.bend[i] > 0)) {
            return std::nullopt;
        }
        along[i] = -form.linear[i] / form.bend[i];
        form.constant += form.linear[i] * along[i];
    }
    if (!(form.constant < 0)) {
        return std::nullopt;
    }
    Bounds bounds{{}, 1, 0};
    for (std::size_t k = 0; k < 3; ++k) {
        long double middle = form.center[k];
        long double width2 = 0;
        long double size = std::abs(middle);
        for (std::size_t i = 0; i < 3; ++i) {
            const long double component = form.axes[k][i];
            middle += component * along[i];
            width2 += component * component * (-form.constant / form.bend[i]);
            size += std::abs(along[i]) + std::sqrt(-form.constant / form.bend[i]);
        }
        const long double width = std::sqrt(width2) + 16 * std::numeric_limits<double>::epsilon() * size;
        bounds.box.low[k] = static_cast<double>(middle - width);
        bounds.box.high[k] = static_cast<double>(middle + width);
        if (!std::isfinite(bounds.box.low[k]) || !std::isfinite(bounds.box.high[k])) {
            return std::nullopt;
        }
    }
    return bounds;
}

}  // namespace whitted
