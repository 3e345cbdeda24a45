// The colour of a pigment at a point.

#pragma once

#include <algorithm>
#include <cmath>

#include "deviations.h"
#include "scene.h"
#include "vector.h"

namespace student {

// The remainder of division by count that has its sign.
inline long long remainder(double value, long long count) {
    if (!std::isfinite(value)) {
        return 0;
    }
    const auto rest = static_cast<long long>(std::fmod(value, static_cast<double>(count)));
    return rest < 0 ? rest + count : rest;
}

// Cubes of edge `size`: the first colour where floor(x/s) + floor(y/s) + floor(z/s) is even.
template <typename Real>
Color<Real> checker_color(const Pigment& pigment, Vector<Real> p, const Switches& on) {
    const Real size = static_cast<Real>(on(On::checker_size_ignored) ? 1 : pigment.size);
    const auto tile = [&](Real coordinate) {
        const Real tiles = on(On::checker_multiplies) ? coordinate * size : coordinate / size;
        return on(On::checker_truncates)   ? std::trunc(tiles)
               : on(On::checker_rounds)    ? std::floor(tiles + Real(0.5))
               : on(On::checker_sum_first) ? tiles
                                           : std::floor(tiles);
    };
    Real sum = 0;
    sum += on(On::checker_without_x) ? 0 : tile(p.x);
    sum += on(On::checker_without_y) ? 0 : tile(p.y);
    sum += on(On::checker_without_z) ? 0 : tile(p.z);
    sum = std::floor(sum);
    bool odd = std::fmod(sum, Real(2)) != 0;
    if (on(On::checker_remainder)) {
        odd = std::fmod(sum, Real(2)) == 1;
    } else if (on(On::checker_swapped)) {
        odd = !odd;
    }
    return vector_of<Real>(odd ? pigment.second : pigment.first);
}

// The texel in column trunc(s width) mod width, row trunc(r height) mod height, s = P0.(x, y, z, 1) and r = P1.(x, y,
// z, 1), with width or height added if negative.
template <typename Real>
class Texture {
 public:
    Texture(const Pigment& pigment, const Switches& on) : pigment_(pigment), on_(on) {}

    Color<Real> at(Vector<Real> p) const {
        Real s = along(pigment_.p0, p);
        Real r = along(pigment_.p1, p);
        if (on_(On::texture_exchanged)) {
            std::swap(s, r);
        }
        const int less = on_(On::texture_one_less) ? 1 : 0;
        const Real column = s * static_cast<Real>(pigment_.width - less);
        const Real row = r * static_cast<Real>(pigment_.height - less);
        return on_(On::texture_filtered) ? filtered(column, row)
                                         : texel(index(column, pigment_.width), index(row, pigment_.height));
    }

 private:
    Real along(const Quadruple& plane, Vector<Real> p) const {
        const Real offset = on_(On::texture_without_offset) ? 0 : static_cast<Real>(plane[3]);
        return dot(vector_of<Real>({plane[0], plane[1], plane[2]}), p) + offset;
    }

    int index(Real position, int count) const {
        double at = static_cast<double>(position);
        if (on_(On::texture_clamped)) {
            return static_cast<int>(std::clamp(at, 0.0, count - 1.0));
        }
        at = on_(On::texture_floor)     ? std::floor(at)
             : on_(On::texture_rounded) ? std::floor(at + 0.5)
                                        : std::trunc(on_(On::texture_absolute) ? std::abs(at) : at);
        return static_cast<int>(remainder(at, count));
    }

    // The mean of four texels, which have their colours at their centres.
    Color<Real> filtered(Real column, Real row) const {
        const Real left = std::floor(column - Real(0.5)), top = std::floor(row - Real(0.5));
        const Real x = column - Real(0.5) - left, y = row - Real(0.5) - top;
        const auto at = [&](Real i, Real j) {
            return texel(static_cast<int>(remainder(double(i), pigment_.width)),
                         static_cast<int>(remainder(double(j), pigment_.height)));
        };
        return (1 - y) * ((1 - x) * at(left, top) + x * at(left + 1, top)) +
               y * ((1 - x) * at(left, top + 1) + x * at(left + 1, top + 1));
    }

    Color<Real> texel(int column, int row) const {
        const int width = pigment_.width, height = pigment_.height;
        column = on_(On::texture_columns_turned) ? width - 1 - column : column;
        row = on_(On::texture_rows_turned) ? height - 1 - row : row;
        long long index = static_cast<long long>(row) * width + column;
        if (on_(On::texture_stride)) {
            index = (static_cast<long long>(row) * height + column) % (static_cast<long long>(width) * height);
        } else if (on_(On::texture_transposed)) {
            index = static_cast<long long>(column) * height + row;
        }
        const float* t = pigment_.texels.data() + 3 * index;
        const Color<Real> color{Real(t[0]), Real(t[1]), Real(t[2])};
        return on_(On::texture_bgr) ? Color<Real>{color.z, color.y, color.x} : color;
    }

    const Pigment& pigment_;
    const Switches& on_;
};

template <typename Real>
Color<Real> color_at(const Pigment& pigment, Vector<Real> p, const Switches& on) {
    switch (pigment.pattern) {
        case Pattern::checker:
            return checker_color(pigment, p, on);
        case Pattern::texmap:
            return Texture<Real>(pigment, on).at(p);
        case Pattern::solid:
            break;
    }
    return vector_of<Real>(pigment.first);
}

}  // namespace student
