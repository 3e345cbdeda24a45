// Bounds of rounding errors, by which ties are decided.
//
// People place eyes, floors, boxes and tiles at round numbers, so that whole rows of rays meet edges exactly. What then
// decides - a tile's edge against a coordinate, one plane against another - are two numbers that are equal but for
// their rounding errors, and count as equal: each comparison knows a bound of the errors of its two numbers, and what
// happens at a tie is a rule of the format. Three bounds make all others:
//
//     Rays::t_min      how far the origin may be off
//     Rays::spread     how far the direction may be off, in each component, and by how much its products may
//     error_at         how far a shape's primitive may be off
//
// A ray at distance t is off by t_min + t spread, and with it everything that it meets. The spread grows from bounce to
// bounce; where it exceeds `most_blur`, nothing is known that a rule could be applied to.
//
// Higham, "Accuracy and Stability of Numerical Algorithms", 2nd ed., 2002, section 3.3: running error analysis.

#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracing/isa.h"

namespace whitted::WHITTED_ISA {

// The numbers of a file are rounded to double before any precision sees them.
template <typename Real>
inline constexpr Real input_epsilon = static_cast<Real>(
    std::max<long double>(std::numeric_limits<Real>::epsilon(), std::numeric_limits<double>::epsilon()));

// The unit of the bounds by which ties are decided. In single precision they would be seen in pictures: it decides
// none.
template <typename Real>
inline constexpr Real tie_epsilon = sizeof(Real) > sizeof(float) ? input_epsilon<Real> : Real(0);

template <typename Real>
inline constexpr bool decides_ties = tie_epsilon<Real> > 0;

// Of a unit vector's component and of its products with others, some eight roundings.
template <typename Real>
inline constexpr Real least_spread = 4 * tie_epsilon<Real>;

// Relative to distances and coordinates. The bounds of a ray grow by more than its errors do, up to twentyfold a bounce
// where those only double: beyond this they would make ties of what is none.
template <typename Real>
inline constexpr Real most_blur = tie_epsilon<Real> > 0 ? Real(0x1p-36) : Real(0);

// Relative to a radius of curvature, of errors that say something of a surface: much of them may be the file's
// numbers'.
template <typename Real>
inline constexpr Real most_of_radius = tie_epsilon<Real> > 0 ? Real(0x1p-32) : Real(0);

// Of directions from an eye far from the origin, whose bounds have not grown: the square root of epsilon.
template <typename Real>
inline constexpr Real most_camera_blur = tie_epsilon<Real> > 0 ? Real(0x1p-26) : Real(0);

// Of a number in a file: a whole one is meant as it stands, any other is a decimal that was rounded.
template <typename Real>
Real input_error(Real number) {
    return number == std::floor(number) ? Real(0) : tie_epsilon<Real> * std::abs(number);
}

// Of a point in a file, in each coordinate.
template <typename Real, typename Point>
Real input_error_of_point(const Point& point) {
    Real largest = 0;
    for (const double coordinate : point) {
        largest = std::max(largest, input_error(static_cast<Real>(coordinate)));
    }
    return largest;
}

}  // namespace whitted::WHITTED_ISA
