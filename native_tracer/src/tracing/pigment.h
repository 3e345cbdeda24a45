// The colour of a surface's material at a point.

#pragma once

#include <cmath>
#include <cstdint>
#include <variant>

#include "tracing/rounding.h"
#include "tracing/sampler.h"
#include "tracing/triple.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// Where a ray has met a surface, for what is known of the point's coordinates.
template <typename Real>
struct Meeting {
    using L = Lanes<Real>;
    Vector<L> point, outward, direction;
    L off;   // how far the ray and the surface may be off from one another
    L blur;  // how far the point may be off for that, at most

    // No coordinate's error is larger.
    L largest_error() const { return L(Real(4)) * blur; }

    // Of a coordinate that a plane along the axes fixes only the rounding counts.
    Vector<Mask<Real>> free() const {
        const L one = Real(1);
        return {abs(outward.x) < one, abs(outward.y) < one, abs(outward.z) < one};
    }

    // How far each coordinate may be off.
    Vector<L> errors() const {
        const L along = min(off / abs(dot(outward, direction)), blur);
        const auto error_of = [&](L coordinate, Mask<Real> may_be_off, L slope) {
            const L rounding = L(2 * tie_epsilon<Real>) * abs(coordinate);
            return rounding + select(may_be_off, off + abs(slope) * along, L(Real(0)));
        };
        const Vector<Mask<Real>> may_be_off = free();
        return {error_of(point.x, may_be_off.x, direction.x), error_of(point.y, may_be_off.y, direction.y),
                error_of(point.z, may_be_off.z, direction.z)};
    }
};

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

    Color<Lanes<Real>> at(const Meeting<Real>& met) const {
        using L = Lanes<Real>;
        const Vector<L> cell = cell_at(met);
        const Mask<Real> odd_sum = odd(cell.x) ^ odd(cell.y) ^ odd(cell.z);
        return select(odd_sum, Color<L>(second), Color<L>(first));
    }

    // The number of the cube, in each direction.
    Vector<Lanes<Real>> cell_at(const Meeting<Real>& met) const {
        using L = Lanes<Real>;
        const Vector<L>& p = met.point;
        const L rounding = 2 * tie_epsilon<Real>;
        Vector<L> cell{cell_of(p.x, rounding * abs(p.x)), cell_of(p.y, rounding * abs(p.y)),
                       cell_of(p.z, rounding * abs(p.z))};
        const Vector<Mask<Real>> may_be_off = met.free();
        const L error = met.largest_error();
        const auto near_next = [&](L coordinate, L number, Mask<Real> off) {
            return off & (L(size) * (number + L(Real(1))) - coordinate <= error);
        };
        const Mask<Real> close = near_next(p.x, cell.x, may_be_off.x) | near_next(p.y, cell.y, may_be_off.y) |
                                 near_next(p.z, cell.z, may_be_off.z);
        if (any(close)) [[unlikely]] {
            const Vector<L> errors = met.errors();
            cell = select(close, {cell_of(p.x, errors.x), cell_of(p.y, errors.y), cell_of(p.z, errors.z)}, cell);
        }
        return cell;
    }

 private:
    // The number of a coordinate's cell.
    Lanes<Real> cell_of(Lanes<Real> coordinate, Lanes<Real> error) const {
        using L = Lanes<Real>;
        return floor((coordinate + (error + L(2 * tie_epsilon<Real>) * abs(coordinate))) / L(size));
    }

    // No integer could hold every number that a real can.
    static Mask<Real> odd(Lanes<Real> number) {
        const Lanes<Real> half = number * Lanes<Real>(Real(0.5));
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

    Color<Lanes<Real>> at(const Meeting<Real>& met) const {
        using L = Lanes<Real>;
        L column = position(met.point, p0, p0_offset, width);
        L row = position(met.point, p1, p1_offset, height);
        const L largest = met.largest_error();
        if (any(near_next(column, largest, p0, p0_offset, width) | near_next(row, largest, p1, p1_offset, height)))
            [[unlikely]] {
            const Vector<L> errors = met.errors();
            column = away_from_0(column, error_of(met.point, errors, p0, p0_offset, width));
            row = away_from_0(row, error_of(met.point, errors, p1, p1_offset, height));
        }
        return gather<Real>([&](int lane) { return texel(wrap(column[lane], width), wrap(row[lane], height)); });
    }

 private:
    // In texels.
    static Lanes<Real> position(const Vector<Lanes<Real>>& p, const Vector<Real>& direction, Real offset, int count) {
        using L = Lanes<Real>;
        return (dot(Vector<L>(direction), p) + L(offset)) * L(static_cast<Real>(count));
    }

    static Lanes<Real> error_of(const Vector<Lanes<Real>>& p, const Vector<Lanes<Real>>& p_error,
                                const Vector<Real>& direction, Real offset, int count) {
        using L = Lanes<Real>;
        const Vector<L> rounded = p_error + L(4 * tie_epsilon<Real>) * absolute(p);
        const L error = dot(absolute(Vector<L>(direction)), rounded) + L(4 * tie_epsilon<Real> * std::abs(offset));
        return error * L(static_cast<Real>(count));
    }

    // Whether a position may be the next texel's but for its error, where no coordinate's is larger than `error`.
    static Mask<Real> near_next(Lanes<Real> position, Lanes<Real> error, const Vector<Real>& direction, Real offset,
                                int count) {
        using L = Lanes<Real>;
        const Real texels = static_cast<Real>(count);
        const Real slope = std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z);
        const L distance = abs(position);
        return L(Real(1)) - (distance - floor(distance)) <=
               L(texels * slope) * error + L(texels * 4 * tie_epsilon<Real> * std::abs(offset));
    }

    static Lanes<Real> away_from_0(Lanes<Real> position, Lanes<Real> error) {
        return position + select(position < Lanes<Real>(Real(0)), -error, error);
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

template <typename Real>
[[gnu::always_inline]] inline Color<Lanes<Real>> color_at(const Pigment<Real>& pigment, const Meeting<Real>& met) {
    if (const auto* solid = std::get_if<Solid<Real>>(&pigment)) {
        return solid->at();
    }
    if (const auto* checker = std::get_if<Checker<Real>>(&pigment)) {
        return checker->at(met);
    }
    return std::get_if<Texmap<Real>>(&pigment)->at(met);
}

// A word for the piece of the pigment in a lane, a checker's cube. An image's texels are told apart by their colours
// only, for most images are smooth.
template <typename Real>
std::uint32_t cell_word(const Pigment<Real>& pigment, const Meeting<Real>& met, int lane) {
    if (const auto* checker = std::get_if<Checker<Real>>(&pigment)) {
        const Vector<Lanes<Real>> cell = checker->cell_at(met);
        const auto word = [&](Real number) {
            constexpr Real period = 1 << 22;  // a float holds them all
            const Real rest = number - std::floor(number / period) * period;
            return rest > 0 ? static_cast<std::uint32_t>(rest) : 0U;
        };
        return combine(combine(word(cell.x[lane]), word(cell.y[lane])), word(cell.z[lane]));
    }
    return 0;
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
