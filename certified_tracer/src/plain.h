// What plain doubles tell of a ray before any interval is computed: which boxes and balls it certainly misses, and
// which planes of a polyhedron cannot be those where it enters or leaves.
//
// Values are computed with the middles of intervals, and with each a bound of how far the true one may be from it. The
// bounds hold while the processor rounds upward: a sum or product is off by less than 2^-52 of itself, a bound is never
// rounded down, and what underflows is off by less than `tiny` (Higham, Accuracy and Stability of Numerical Algorithms,
// chapter 3).

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <vector>

#include "prepared.h"

namespace certified {

inline constexpr double rounding = 0x1p-52, tiny = 0x1p-500;

// A vector, and how far the true one may be from it.
struct Plain {
    explicit Plain(const Vector<Interval<double>>& v)
        : x(v.x.middle()), y(v.y.middle()), z(v.z.middle()), off(beside(v.x, x) + beside(v.y, y) + beside(v.z, z)) {}

    // Not below the length.
    double size() const { return std::sqrt(x * x + y * y + z * z + tiny); }

    static double beside(const Interval<double>& v, double middle) {
        return std::max(v.high() - middle, middle - v.low());
    }

    double x, y, z, off;
};

// What a ray's tests share.
struct PlainRay {
    PlainRay(const Vector<Interval<double>>& start, const Vector<Interval<double>>& way)
        : origin(start), direction(way), reach(origin.size()), speed(direction.size()) {
        const std::array<const Interval<double>*, 3> starts = {&start.x, &start.y, &start.z};
        const std::array<const Interval<double>*, 3> ways = {&way.x, &way.y, &way.z};
        for (std::size_t i = 0; i < 3; ++i) {
            const Interval<double>& d = *ways[i];
            Axis& axis = axes[i];
            axis.high = starts[i]->high();
            axis.minus_low = -starts[i]->low();
            axis.sign = d.positive() ? 1 : d.negative() ? -1 : 0;
            axis.still = d.is_zero();
            if (axis.sign != 0) {
                const Interval<double> inverse = Interval<double>(1) / (axis.sign > 0 ? d : -d);
                axis.slowest = inverse.high();
                axis.fastest = inverse.low();
            }
        }
    }

    // `sign`: of the direction's coordinate, 0 where it is not certain; its inverse's size is between `fastest` and
    // `slowest`; `still`: it is 0.
    struct Axis {
        double minus_low, high, fastest = 0, slowest = 0;
        int sign;
        bool still;
    };

    Plain origin, direction;
    double reach, speed;  // not below their lengths
    std::array<Axis, 3> axes;
};

// Slabs (Kay and Kajiya 1986); where a direction's sign is not certain, that axis excludes nothing. Whether the ray may
// meet a box before `reach`, and if so, a distance that it does not meet it before.
inline bool may_meet(const PlainRay& ray, const std::array<double, 3>& low, const std::array<double, 3>& high,
                     double reach, double& near) {
    double leave = reach, minus_near = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const PlainRay::Axis& axis = ray.axes[i];
        const double above = axis.high - low[i], below = high[i] + axis.minus_low;  // of either end, not below
        if (axis.sign == 0) {
            if (axis.still && (above < 0 || below < 0)) {
                return false;
            }
            continue;
        }
        // What lies behind the start is met before 0, whatever the inverse.
        minus_near = std::min(minus_near, (axis.sign > 0 ? above : below) * axis.fastest);
        leave = std::min(leave, (axis.sign > 0 ? below : above) * axis.slowest);
    }
    near = -minus_near;
    return !(near > leave);
}

class PlainSphere {
 public:
    PlainSphere(const Vector<Interval<double>>& center, const Interval<double>& radius)
        : center_(center), least_radius_(radius.low()), radius_(radius.high()) {}

    // Certainly: the ray passes beside it, or it lies behind the start, which is outside, or the ray does not come to
    // it before `end`.
    bool is_missed(const PlainRay& ray, double end) const {
        const Plain &o = ray.origin, &d = ray.direction;
        const double x = o.x - center_.x, y = o.y - center_.y, z = o.z - center_.z;
        const double arm2 = x * x + y * y + z * z, arm = std::sqrt(arm2 + tiny);
        const double off = o.off + center_.off + 2 * rounding * arm + tiny, far = arm + off;
        const double u = y * d.z - z * d.y, v = z * d.x - x * d.z, w = x * d.y - y * d.x;
        const double way = end * (ray.speed + d.off);
        if (least_radius_ > far + way || arm > radius_ + off + 8 * rounding * arm + way) {
            return true;
        }
        // How far their product may be off, be it the dot or the cross product; and how long they are.
        const double speed = ray.speed + d.off;
        const double miss = off * speed + far * d.off + 8 * rounding * far * speed + tiny, size = far * speed + miss;
        const double cross2 = u * u + v * v + w * w, square = radius_ * radius_;
        if (cross2 - (2 * miss + 8 * rounding * size) * size > square * (speed * speed)) {
            return true;
        }
        const double along = x * d.x + y * d.y + z * d.z;
        return along > miss && arm2 - (2 * off + 8 * rounding * far) * far > square;
    }

 private:
    Plain center_;
    double least_radius_, radius_;  // it lies between these
};

// The planes of a polyhedron, by twos.
class PlainPlanes {
 public:
    PlainPlanes() = default;

    // Unit normals, and offsets to these.
    void add(const Vector<Interval<double>>& normal, const Interval<double>& offset) {
        const Plain n(normal);
        const double k = offset.middle();
        if (count_ % 2 == 0) {
            pairs_.push_back({});
        }
        Pair& pair = pairs_.back();
        const std::size_t i = count_++ % 2;
        pair.x[i] = n.x;
        pair.y[i] = n.y;
        pair.z[i] = n.z;
        pair.offset[i] = k;
        normals_off_ = std::max(normals_off_, n.off);
        offsets_off_ = std::max(offsets_off_, Plain::beside(offset, k));
        largest_offset_ = std::max(largest_offset_, std::fabs(k));
    }

    // What a ray leaves of them.
    struct Sieve {
        std::vector<std::size_t> left;             // in their order
        std::vector<double> entry_high, exit_low;  // of each
    };

    // Leaves those planes that may be the last by which the ray enters, if `entries`, or the first by which it leaves,
    // and those along which it may run. False: it certainly passes beside, enters after `end`, or left before its
    // start.
    bool sift(const PlainRay& ray, double end, bool entries, Sieve& sieve) const {
        const Plain &o = ray.origin, &d = ray.direction;
        // Normals are of length 1.
        const double height_off =
            o.off + normals_off_ * ray.reach + offsets_off_ + 8 * rounding * (ray.reach + largest_offset_) + tiny;
        const double slope_off = d.off + normals_off_ * ray.speed + 8 * rounding * ray.speed + tiny;
        const Two none = {-infinite, -infinite};
        Two last_entry = none, first_exit = -none;
        sieve.entry_high.resize(2 * pairs_.size());
        sieve.exit_low.resize(2 * pairs_.size());
        for (std::size_t i = 0; i < pairs_.size(); ++i) {
            const Pair& p = pairs_[i];
            const Two slope = p.x * d.x + p.y * d.y + p.z * d.z, height = p.x * o.x + p.y * o.y + p.z * o.z + p.offset;
            const auto certain = size(slope) > 2 * slope_off, enters = certain & (slope < Two{}),
                       leaves = certain & (slope > Two{});
            // A divisor that is not 0, which a compiler does not make a choice between quotients.
            const Two inverse = 1 / (slope + (certain ? Two{} : Two{} + 4 * slope_off)), t = -height * inverse;
            // The divisor may be half of it.
            const Two off = 2.01 * (height_off + size(t) * slope_off) * size(inverse) + 4 * rounding * size(t);
            const Two low = -(off - t), high = t + off;
            const Two entry_high = enters   ? high
                                   : leaves ? none
                                            : -none,
                      exit_low = leaves   ? low
                                 : enters ? -none
                                          : none;
            const Two entry_low = enters ? low : none, exit_high = leaves ? high : -none;
            last_entry = entry_low > last_entry ? entry_low : last_entry;
            first_exit = exit_high < first_exit ? exit_high : first_exit;
            std::memcpy(&sieve.entry_high[2 * i], &entry_high, sizeof(Two));
            std::memcpy(&sieve.exit_low[2 * i], &exit_low, sizeof(Two));
        }
        const double entry = std::max(last_entry[0], last_entry[1]), exit = std::min(first_exit[0], first_exit[1]);
        if (entries && (exit < 0 || entry > std::min(exit, end))) {
            return false;
        }
        sieve.left.clear();
        for (std::size_t i = 0; i < count_; ++i) {
            if ((entries && sieve.entry_high[i] > entry) || sieve.exit_low[i] < exit) {
                sieve.left.push_back(i);
            }
        }
        return true;
    }

 private:
    using Two = double __attribute__((vector_size(16)));
    static constexpr double infinite = std::numeric_limits<double>::infinity();

    static Two size(const Two& x) { return x < Two{} ? -x : x; }

    struct Pair {
        Two x{}, y{}, z{}, offset{};
    };

    std::vector<Pair> pairs_;
    std::size_t count_ = 0;
    double normals_off_ = 0, offsets_off_ = 0, largest_offset_ = 0;
};

// By the index of a sphere's surface, or of a polyhedron's first.
struct PlainScene {
    explicit PlainScene(const PreparedScene<double>& prepared) {
        for (const auto& surface : prepared.surfaces) {
            spheres.emplace_back(surface.vector, surface.number);
        }
        planes.resize(prepared.surfaces.size());
        for (const Leaf& leaf : prepared.scene.leaves) {
            for (std::size_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
                if (prepared.surfaces[i].kind == Kind::plane) {
                    planes[leaf.first].add(prepared.surfaces[i].vector, prepared.surfaces[i].number);
                }
            }
        }
    }

    std::vector<PlainSphere> spheres;
    std::vector<PlainPlanes> planes;
};

}  // namespace certified
