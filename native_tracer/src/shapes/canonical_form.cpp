// Levin, "A Parametric Algorithm for Drawing Pictures of Solid Objects Composed of Quadric Surfaces", Communications of
// the ACM 19(10), 1976, reduces quadrics by the eigenvectors of their matrices, as here.

#include "shapes/canonical_form.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace whitted {

namespace {

using Real = long double;
using Vec = std::array<Real, 3>;
using Matrix = SquareMatrix<Real, 3>;

Vec times(const Matrix& matrix, const Vec& v) {
    Vec result{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            result[i] += matrix[i][k] * v[k];
        }
    }
    return result;
}

Real dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vec column(const Matrix& matrix, std::size_t k) { return {matrix[0][k], matrix[1][k], matrix[2][k]}; }

// By what to multiply the coefficients: a power of two, so that no digit is lost, with a sign by which a quadric that
// is turned inside out is the same.
Real scale_of(const std::array<double, 10>& q) {
    Real largest = 0;
    for (std::size_t i = 0; i < 6; ++i) {
        largest = std::max(largest, std::abs(Real(q[i])));
    }
    for (std::size_t i = 6; i < 9 && largest == 0; ++i) {
        largest = std::max(largest, std::abs(Real(q[i])));
    }
    const double first = *std::find_if(q.begin(), q.end(), [](double number) { return number != 0; });
    return std::copysign(std::scalbn(Real(1), -std::ilogb(largest)), Real(first));
}

// The bends along the axes, of which the largest is returned.
Real find_bends(const Matrix& matrix, CanonicalForm& form) {
    Real most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec axis = column(form.axes, i);
        form.bend[i] = dot(axis, times(matrix, axis));
        most = std::max(most, std::abs(form.bend[i]));
    }
    for (Real& bend : form.bend) {
        // Where axes are turned, coefficients that stand for 0 have been rounded to double.
        if (form.turned && std::abs(bend) <= 4 * std::numeric_limits<double>::epsilon() * most) {
            bend = 0;
        }
    }
    return most;
}

// Each axis by itself: the middle is at -linear / bend on it, and the surface is about `extent` wide there. Returns
// where the centre is along the axes.
Vec find_center(Real most_bend, CanonicalForm& form) {
    Vec along{};
    const auto center_on = [&](std::size_t i) {
        along[i] = -form.linear[i] / form.bend[i];
        form.constant += form.linear[i] * along[i];
        form.linear[i] = 0;
    };
    constexpr Real clearly = 0x1p-10L;
    for (std::size_t i = 0; i < 3; ++i) {
        if (std::abs(form.bend[i]) > clearly * most_bend) {
            center_on(i);
        }
    }
    for (std::size_t i = 0; i < 3; ++i) {
        if (form.linear[i] == 0 || form.bend[i] == 0) {
            continue;
        }
        const Real middle = form.linear[i] / form.bend[i];
        const Real extent2 = std::abs((form.constant - form.linear[i] * middle) / form.bend[i]);
        if (middle * middle > 4 * extent2) {
            center_on(i);
        }
    }
    return along;
}

}  // namespace

CanonicalForm canonical_form(const QuadricDescription& quadric) {
    const auto& q = quadric.coefficients;
    CanonicalForm form{};
    form.scale = scale_of(q);
    const auto scaled = [&](std::size_t i) { return form.scale * q[i]; };
    const Matrix matrix{{{scaled(0), scaled(3) / 2, scaled(4) / 2},
                         {scaled(3) / 2, scaled(1), scaled(5) / 2},
                         {scaled(4) / 2, scaled(5) / 2, scaled(2)}}};
    const Vec linear{scaled(6) / 2, scaled(7) / 2, scaled(8) / 2};
    form.turned = q[3] != 0 || q[4] != 0 || q[5] != 0;
    form.axes = principal_axes(matrix);
    for (std::size_t i = 0; i < 3; ++i) {
        form.linear[i] = dot(column(form.axes, i), linear);
    }
    form.constant = scaled(9);
    const Real most_bend = find_bends(matrix, form);
    const Vec along = find_center(most_bend, form);
    // With the sign that it has in the file.
    const Real sign = std::copysign(Real(1), form.scale);
    for (std::size_t k = 0; k < 3; ++k) {
        form.center[k] = dot(form.axes[k], along);
        form.bend[k] *= sign;
        form.linear[k] *= sign;
    }
    form.constant *= sign;
    form.scale = std::abs(form.scale);
    return form;
}

}  // namespace whitted
