// The colour of a surface's material at a point.

#pragma once

#include <cmath>
#include <variant>

#include "camera.h"
#include "vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct Solid {
    Color<Real> color;

    Color<Lanes<Real>> at(const Vector<Lanes<Real>>&) const { return Color<Lanes<Real>>(color); }
};

// Cubes of edge `size`, `first` where floor(x/s) + floor(y/s) + floor(z/s) is even.
template <typename Real>
struct Checker {
    Color<Real> first, second;
    Real size;

    Color<Lanes<Real>> at(const Vector<Lanes<Real>>& p) const {
        const Mask<Real> odd_sum = odd(p.x) ^ odd(p.y) ^ odd(p.z);
        return select(odd_sum, Color<Lanes<Real>>(second), Color<Lanes<Real>>(first));
    }

 private:
    // Whether a coordinate's cell has an odd number. No integer could hold every number that a real can.
    Mask<Real> odd(Lanes<Real> coordinate) const {
        const Lanes<Real> half = floor(coordinate / Lanes<Real>(size)) * Lanes<Real>(Real(0.5));
        return floor(half) != half;
    }
};

// An image projected through space: s = p0 . (x, y, z, 1) runs along its columns, r = p1 . (x, y, z, 1) along its rows,
// 1 is the whole image, and the image repeats. Nearest texel: column trunc(s W) mod W, plus W if negative.
template <typename Real>
struct Texmap {
    int width, height;
    const float* texels;  // height x width x 3
    Vector<Real> p0, p1;
    Real p0_offset, p1_offset;

    Color<Lanes<Real>> at(const Vector<Lanes<Real>>& p) const {
        using L = Lanes<Real>;
        const L column = (dot(Vector<L>(p0), p) + L(p0_offset)) * L(static_cast<Real>(width));
        const L row = (dot(Vector<L>(p1), p) + L(p1_offset)) * L(static_cast<Real>(height));
        return gather<Real>([&](int lane) { return texel(wrap(column[lane], width), wrap(row[lane], height)); });
    }

 private:
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

template <typename Real>
[[gnu::always_inline]] inline Color<Lanes<Real>> color_at(const Pigment<Real>& pigment, const Vector<Lanes<Real>>& p) {
    if (const auto* solid = std::get_if<Solid<Real>>(&pigment)) {
        return solid->at(p);
    }
    if (const auto* checker = std::get_if<Checker<Real>>(&pigment)) {
        return checker->at(p);
    }
    return std::get_if<Texmap<Real>>(&pigment)->at(p);
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
