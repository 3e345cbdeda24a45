// The colour of a surface's material at a point.

#pragma once

#include <cmath>
#include <variant>

#include "camera.h"
#include "rounding.h"
#include "vector.h"

namespace whitted::WHITTED_ISA {

// How far the coordinates of a point of a surface may be off: by what ray and surface may be off from one another, and
// by `along` along the ray's direction. A plane along the axes fixes one.
template <typename Real>
Vector<Lanes<Real>> coordinate_errors(const Vector<Lanes<Real>>& point, const Vector<Lanes<Real>>& outward,
                                      const Vector<Lanes<Real>>& direction, Lanes<Real> off, Lanes<Real> along) {
    using L = Lanes<Real>;
    const auto error = [&](L coordinate, L normal, L slope) {
        const L rounding = L(2 * tie_epsilon<Real>) * abs(coordinate);
        return rounding + select(abs(normal) < L(Real(1)), off + abs(slope) * along, L(Real(0)));
    };
    return {error(point.x, outward.x, direction.x), error(point.y, outward.y, direction.y),
            error(point.z, outward.z, direction.z)};
}

template <typename Real>
struct Solid {
    Color<Real> color;

    Color<Lanes<Real>> at() const { return Color<Lanes<Real>>(color); }
};

// Cubes of edge `size`, `first` where floor(x/s) + floor(y/s) + floor(z/s) is even. A coordinate that is a whole number
// of edges but for its error is that number.
template <typename Real>
struct Checker {
    Color<Real> first, second;
    Real size;

    Color<Lanes<Real>> at(const Vector<Lanes<Real>>& p, const Vector<Lanes<Real>>& error) const {
        const Mask<Real> odd_sum = odd(p.x, error.x) ^ odd(p.y, error.y) ^ odd(p.z, error.z);
        return select(odd_sum, Color<Lanes<Real>>(second), Color<Lanes<Real>>(first));
    }

 private:
    // Whether a coordinate's cell has an odd number. No integer could hold every number that a real can.
    Mask<Real> odd(Lanes<Real> coordinate, Lanes<Real> error) const {
        using L = Lanes<Real>;
        const L up = error + L(2 * tie_epsilon<Real>) * abs(coordinate);
        const L half = floor((coordinate + up) / L(size)) * L(Real(0.5));
        return floor(half) != half;
    }
};

// An image projected through space: s = p0 . (x, y, z, 1) runs along its columns, r = p1 . (x, y, z, 1) along its rows,
// 1 is the whole image, and the image repeats. Nearest texel: column trunc(s W) mod W, plus W if negative, where s W
// that is a whole number but for its error is that number.
template <typename Real>
struct Texmap {
    int width, height;
    const float* texels;  // height x width x 3
    Vector<Real> p0, p1;
    Real p0_offset, p1_offset;

    Color<Lanes<Real>> at(const Vector<Lanes<Real>>& p, const Vector<Lanes<Real>>& error) const {
        using L = Lanes<Real>;
        const L column = position(p, error, p0, p0_offset, width);
        const L row = position(p, error, p1, p1_offset, height);
        return gather<Real>([&](int lane) { return texel(wrap(column[lane], width), wrap(row[lane], height)); });
    }

 private:
    // In texels, away from 0 by its error.
    static Lanes<Real> position(const Vector<Lanes<Real>>& p, const Vector<Lanes<Real>>& p_error,
                                const Vector<Real>& direction, Real offset, int count) {
        using L = Lanes<Real>;
        const Vector<L> along(direction);
        const L texels = static_cast<Real>(count);
        const L result = (dot(along, p) + L(offset)) * texels;
        const Vector<L> rounded = p_error + L(4 * tie_epsilon<Real>) * absolute(p);
        const L error = dot(absolute(along), rounded) + L(4 * tie_epsilon<Real> * std::abs(offset));
        return result + select(result < L(Real(0)), -error, error) * texels;
    }

    Color<Real> texel(int column, int row) const {
        const float* texel = texels + 3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                                           static_cast<std::size_t>(column));
        return {static_cast<Real>(texel[0]), static_cast<Real>(texel[1]), static_cast<Real>(texel[2])};
    }

    static int wrap(Real position, int count) {
        if (position >= 0 && position < static_cast<Real>(count)) {
            return static_cast<int>(position);  // as most are; no division is needed
        }
        int index = 0;
        if (std::abs(position) < Real(1 << 30)) {
            index = static_cast<int>(position) % count;
        } else if (std::isfinite(position)) {
            index = static_cast<int>(std::fmod(std::trunc(position), static_cast<Real>(count)));
        }
        return index < 0 ? index + count : index;
    }
};

template <typename Real>
using Pigment = std::variant<Solid<Real>, Checker<Real>, Texmap<Real>>;

// The colour at a point; error_of() tells how far its coordinates may be off, where that matters.
template <typename Real, typename ErrorOf>
[[gnu::always_inline]] inline Color<Lanes<Real>> color_at(const Pigment<Real>& pigment, const Vector<Lanes<Real>>& p,
                                                          ErrorOf error_of) {
    if (const auto* solid = std::get_if<Solid<Real>>(&pigment)) {
        return solid->at();
    }
    if (const auto* checker = std::get_if<Checker<Real>>(&pigment)) {
        return checker->at(p, error_of());
    }
    return std::get_if<Texmap<Real>>(&pigment)->at(p, error_of());
}

// The pigment is made of what the file says about it; a texmap keeps the description's texels.
template <typename Real>
Pigment<Real> pigment_of(const PigmentDescription& description) {
    if (const auto* solid = std::get_if<SolidDescription>(&description)) {
        return Solid<Real>{vector_of<Real>(solid->color)};
    }
    if (const auto* checker = std::get_if<CheckerDescription>(&description)) {
        return Checker<Real>{vector_of<Real>(checker->first), vector_of<Real>(checker->second),
                             static_cast<Real>(checker->size)};
    }
    const auto& texmap = *std::get_if<TexmapDescription>(&description);
    const auto direction = [](const Quadruple& p) { return vector_of<Real>({p[0], p[1], p[2]}); };
    return Texmap<Real>{texmap.width,
                        texmap.height,
                        texmap.texels.data(),
                        direction(texmap.p0),
                        direction(texmap.p1),
                        static_cast<Real>(texmap.p0[3]),
                        static_cast<Real>(texmap.p1[3])};
}

}  // namespace whitted::WHITTED_ISA
