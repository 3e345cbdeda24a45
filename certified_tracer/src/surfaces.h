// Surfaces, as rays start and end on them, and the order of places where these meet them.

#pragma once

#include <cstddef>

#include "prepared.h"
#include "rays.h"
#include "undecided.h"

namespace certified {

template <typename End>
class Surfaces {
 public:
    using I = Interval<End>;
    using V = Vector<I>;
    using R = Ray<End>;
    using S = typename PreparedScene<End>::PreparedSurface;

    Surfaces(const PreparedScene<End>& scene, Judge<End>& judge) : scene_(scene), judge_(judge) {}

    const S& operator[](std::size_t index) const { return scene_.surfaces[index]; }
    const S& operator[](int index) const { return scene_.surfaces[static_cast<std::size_t>(index)]; }

    bool starts_on(const S& s, const R& ray) const {
        return (ray.from_eye && s.eye) || (ray.surface >= 0 && (*this)[ray.surface].identity == s.identity);
    }

    bool ends_on(const S& s, const R& ray) const {
        return ray.to_light >= 0 && (*s.lights)[static_cast<std::size_t>(ray.to_light)];
    }

    // It starts or ends there by rule, whatever the numbers say.
    bool touches(const S& s, const R& ray) const { return starts_on(s, ray) || ends_on(s, ray); }

    // Whether two distances are certainly different, and which is smaller: -1, 0 (equal by rule), 1.
    int order(const Crossing<End>& a, const Crossing<End>& b, Reason reason) const {
        if (a.t.high() < b.t.low()) {
            return -1;
        }
        if (b.t.high() < a.t.low()) {
            return 1;
        }
        const S &one = (*this)[a.surface], &other = (*this)[b.surface];
        if (one.kind == Kind::plane && one.identity == other.identity) {
            return 0;
        }
        return judge_.sign(a.t - b.t, reason);
    }

    // The unit normal, outward.
    V normal(int index, const V& point) const {
        const S& s = (*this)[index];
        switch (s.kind) {
            case Kind::sphere: {
                const V arm = point - s.vector;
                return {arm.x / s.number, arm.y / s.number, arm.z / s.number};
            }
            case Kind::plane:
                return s.vector;
            case Kind::quadric:
                return normalized(gradient(s, point));
        }
        return {};
    }

    // Where a ray starts: within a surface (-1), on it or beyond it (1).
    int side_of_start(const S& s, const R& ray) const {
        return starts_on(s, ray) ? 0 : judge_.sign(height(s, ray.origin), Reason::hit);
    }

    // Which way a ray goes that starts on a surface: inward (-1), along it or outward (1).
    int way_from_start(const S& s, const R& ray) const {
        const V outward = s.kind == Kind::sphere  ? ray.origin - s.vector
                          : s.kind == Kind::plane ? s.vector
                                                  : gradient(s, ray.origin);
        return judge_.sign(dot(outward, ray.direction), Reason::hit);
    }

    // A quadric's value.
    I value(const S& s, const V& p) const {
        const auto& q = s.numbers;
        return p.x * (q[0] * p.x + q[3] * p.y + q[4] * p.z + q[6]) + p.y * (q[1] * p.y + q[5] * p.z + q[7]) +
               p.z * (q[2] * p.z + q[8]) + q[9];
    }

    V gradient(const S& s, const V& p) const {
        const auto& q = s.numbers;
        return {I(2) * q[0] * p.x + q[3] * p.y + q[4] * p.z + q[6], I(2) * q[1] * p.y + q[3] * p.x + q[5] * p.z + q[7],
                I(2) * q[2] * p.z + q[4] * p.x + q[5] * p.y + q[8]};
    }

 private:
    // What is positive outside of a surface.
    I height(const S& s, const V& p) const {
        return s.kind == Kind::sphere  ? length2(p - s.vector) - square(s.number)
               : s.kind == Kind::plane ? dot(s.vector, p) + s.number
                                       : value(s, p);
    }

    const PreparedScene<End>& scene_;
    Judge<End>& judge_;
};

}  // namespace certified
