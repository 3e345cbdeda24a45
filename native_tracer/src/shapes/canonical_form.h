// A quadric in coordinates of its own, in which its equation is as short as it can be without loss.

#pragma once

#include <array>
#include <cstddef>

#include "halfspaces/principal_axes.h"
#include "tracing/description.h"

namespace whitted {

// With x the coordinates of p - center along the axes, Q(p) is, but for a factor that makes the largest number in
// `bend` about 1,
//
//     sum over i of bend[i] x[i]^2 + 2 linear[i] x[i]   + constant
//
// Where the quadric has a centre it is that, and linear is 0: so nothing cancels for a small one far from the origin.
// Along an axis on which it goes on so far that the centre says nothing of where it is, up to for ever, `center` is
// where the axis is closest to the origin.
struct CanonicalForm {
    SquareMatrix<long double, 3> axes;  // orthogonal unit vectors, as columns
    bool turned;                        // they are not those of space
    std::array<long double, 3> center, bend, linear;
    long double constant;
    long double scale;  // the factor
};

CanonicalForm canonical_form(const QuadricDescription& quadric);

}  // namespace whitted
