// Where rays meet bodies, with certainty.

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

#include "plain.h"
#include "prepared.h"
#include "rays.h"

namespace certified {

template <typename End>
class Bodies {
 public:
    using I = Interval<End>;
    using V = Vector<I>;
    using R = Ray<End>;
    using S = typename PreparedScene<End>::PreparedSurface;

    // `plain`: with which to leave out what plain doubles exclude, or none.
    Bodies(const PreparedScene<End>& scene, Judge<End>& judge, const PlainScene* plain)
        : scene_(scene), judge_(judge), plain_(plain) {}

    // The first place beyond the ray's start; whether there is one. `narrow`: the ray in plain doubles;
    // what is certainly not met before `end` may count as missed.
    bool meet(int index, const R& ray, const PlainRay& narrow, double end, Met<End>& met) {
        const Body& body = scene_.scene.bodies[static_cast<std::size_t>(index)];
        if (body.program.empty()) {
            const Leaf& leaf = scene_.scene.leaves[body.leaves[0]];
            const bool own = ray.body == index;
            if (leaf.count > 0 && surface(leaf.first).kind != Kind::quadric && own && !ray.inside) {
                return false;  // they are convex
            }
            if (own && surface(leaf.first).kind == Kind::plane) {
                return leave(index, leaf, ray, narrow, met);
            }
            const Passage<End> passage = pass(leaf, ray, narrow, end, own);
            if (passage.count == 0) {
                return false;
            }
            met = {passage.crossings[0].t, index, passage.crossings[0].surface, passage.inside, passage.inside};
            return true;
        }
        return meet_csg(index, body, ray, narrow, met);
    }

    // What another kind of intervals has found of this ray, with its own place. Throws Undecided.
    Met<End> located(const Met<double>& found, const R& ray) {
        Met<End> met{{}, found.body, found.surface, found.inside, found.behind};
        const S& s = surface(found.surface);
        if (found.t.low() == 0 && found.t.high() == 0) {
            met.t = I(0);
            return met;
        }
        if (s.kind == Kind::plane) {
            int side;
            if (meet_plane(s, ray, met.t, side) == 0) {
                throw Undecided{Reason::hit};
            }
            return met;
        }
        const Body& body = scene_.scene.bodies[static_cast<std::size_t>(found.body)];
        const bool own = ray.body == found.body && body.program.empty();
        const Passage<End> passage =
            s.kind == Kind::sphere ? pass_sphere(found.surface, ray, own) : pass_quadric(found.surface, ray, own);
        int places = 0;
        for (int i = 0; i < passage.count; ++i) {
            const I& t = passage.crossings[static_cast<std::size_t>(i)].t;
            if (t.low_double() <= found.t.high() && t.high_double() >= found.t.low()) {
                met.t = t;
                ++places;
            }
        }
        if (places != 1) {
            throw Undecided{Reason::hit};
        }
        return met;
    }

    // Whether two distances are certainly different, and which is smaller: -1, 0 (equal by rule), 1.
    int order(const Crossing<End>& a, const Crossing<End>& b, Reason reason) {
        if (a.t.high() < b.t.low()) {
            return -1;
        }
        if (b.t.high() < a.t.low()) {
            return 1;
        }
        const S &one = surface(a.surface), &other = surface(b.surface);
        if (one.kind == Kind::plane && one.identity == other.identity) {
            return 0;
        }
        return judge_.sign(a.t - b.t, reason);
    }

    // The unit normal, outward.
    V normal(int index, const V& point) const {
        const S& s = surface(index);
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

 private:
    const S& surface(std::size_t index) const { return scene_.surfaces[index]; }
    const S& surface(int index) const { return scene_.surfaces[static_cast<std::size_t>(index)]; }

    bool starts_on(const S& s, const R& ray) const {
        return (ray.from_eye && s.eye) || (ray.surface >= 0 && surface(ray.surface).identity == s.identity);
    }

    // It starts or ends there by rule, whatever the numbers say.
    bool touches(const S& s, const R& ray) const { return starts_on(s, ray) || ends_on(s, ray); }

    bool ends_on(const S& s, const R& ray) const {
        return ray.to_light >= 0 && (*s.lights)[static_cast<std::size_t>(ray.to_light)];
    }

    Passage<End> pass(const Leaf& leaf, const R& ray, const PlainRay& narrow, double end, bool own) {
        switch (surface(leaf.first).kind) {
            case Kind::sphere:
                if (plain_ != nullptr && !own && plain_->spheres[leaf.first].is_missed(narrow, end) &&
                    !touches(surface(leaf.first), ray)) {
                    return {};
                }
                return pass_sphere(static_cast<int>(leaf.first), ray, own);
            case Kind::plane:
                return pass_planes(leaf, ray, narrow, end);
            case Kind::quadric:
                break;
        }
        return pass_quadric(static_cast<int>(leaf.first), ray, own);
    }

    // a t^2 + 2 b t + c = 0, with the discriminant r^2 a - |arm x d|^2, Lagrange's identity for b^2 - a c.
    Passage<End> pass_sphere(int index, const R& ray, bool own) {
        const S& s = surface(index);
        const V arm = ray.origin - s.vector;
        const I b = dot(arm, ray.direction);
        const bool at_start = starts_on(s, ray);
        if (!at_start && !own) {
            const I a = length2(ray.direction), r2 = square(s.number);
            const I discriminant = r2 * a - length2(cross(arm, ray.direction));
            if (discriminant.negative()) {
                return {};
            }
            const I c = length2(arm) - r2;
            if (b.positive() && c.positive()) {
                return {};
            }
            if (judge_.sign(discriminant, Reason::hit) <= 0) {
                return {};
            }
            return between_roots(index, ray, a, b, c, sqrt(discriminant), judge_.sign(c, Reason::hit));
        }
        const I a = length2(ray.direction);
        const bool inward = (own && ray.inside) || judge_.sign(b, Reason::hit) < 0;
        Passage<End> result;
        result.inside = inward;
        if (inward) {
            // Inward from the surface itself, b is negative, however little of it is known.
            const I t = ends_on(s, ray) ? I(1) : I(-2) * b / a;
            if (!t.positive()) {
                judge_.sign(t, Reason::hit);
            }
            add(result, t, index);
        }
        return result;
    }

    // The crossings at (-b -+ root) / a, for a > 0 and c not 0.
    Passage<End> between_roots(int index, const R& ray, const I& a, const I& b, const I& c, const I& root, int side) {
        Passage<End> result;
        result.inside = side < 0;
        const S& s = surface(index);
        if (ends_on(s, ray)) {
            // One root is 1, and the other c / a.
            const I other = c / a;
            if (side < 0) {
                add(result, I(1), index);
            } else if (judge_.sign(other, Reason::shadow) > 0) {
                const bool first = judge_.sign(other - I(1), Reason::shadow) < 0;
                add(result, first ? other : I(1), index);
                add(result, first ? I(1) : other, index);
            }
            return result;
        }
        if (side < 0) {
            // The root that is positive, by the formula without a difference of like numbers.
            add(result, b.positive() ? -c / (b + root) : (root - b) / a, index);
        } else if (judge_.sign(b, Reason::hit) < 0) {
            const I sum = root - b;
            add(result, c / sum, index);
            add(result, sum / a, index);
        }
        return result;
    }

    Passage<End> pass_quadric(int index, const R& ray, bool own) {
        const S& s = surface(index);
        const auto& q = s.numbers;
        const V& d = ray.direction;
        const I a = q[0] * square(d.x) + q[1] * square(d.y) + q[2] * square(d.z) + q[3] * d.x * d.y + q[4] * d.x * d.z +
                    q[5] * d.y * d.z;
        const I b2 = dot(gradient(s, ray.origin), d);  // 2 b
        const int second = judge_.sign(a, Reason::hit);
        Passage<End> result;
        if (own || starts_on(s, ray)) {
            const int first = own && second == 0 ? (ray.inside ? -1 : 1) : judge_.sign(b2, Reason::hit);
            // In the surface itself it is inside: a body is closed.
            result.inside = own ? ray.inside : first != 0 ? first < 0 : second <= 0;
            if (ends_on(s, ray)) {
                if (second != 0) {
                    add(result, I(1), index);
                }
            } else if (second != 0 && first * second < 0) {
                add(result, -b2 / a, index);
            }
            return result;
        }
        const I c = value(s, ray.origin);
        const int side = judge_.sign(c, Reason::hit);
        result.inside = side < 0;
        if (side == 0) {
            // It starts there by rule.
            const int first = judge_.sign(b2, Reason::hit);
            result.inside = first != 0 ? first < 0 : second <= 0;
            if (second != 0 && first * second < 0) {
                add(result, -b2 / a, index);
            }
            return result;
        }
        if (second == 0) {
            const int slope = judge_.sign(b2, Reason::hit);
            if (slope * side < 0) {
                add(result, ends_on(s, ray) ? I(1) : -c / b2, index);
            }
            return result;
        }
        const I b = I(0.5) * b2;
        const I discriminant = square(b) - a * c;
        if (second * side > 0) {
            // Both roots have one sign, that of -b a.
            if (discriminant.negative() || (second > 0 ? b.positive() : b.negative())) {
                return result;
            }
            if (judge_.sign(discriminant, Reason::hit) <= 0) {
                return result;
            }
            if (second > 0) {
                Passage<End> found = between_roots(index, ray, a, b, c, sqrt(discriminant), side);
                found.inside = result.inside;
                return found;
            }
            Passage<End> found = between_roots(index, ray, -a, -b, -c, sqrt(discriminant), -side);
            found.inside = result.inside;
            return found;
        }
        // One root ahead.
        Passage<End> found = second > 0 ? between_roots(index, ray, a, b, c, sqrt(discriminant), side)
                                        : between_roots(index, ray, -a, -b, -c, sqrt(discriminant), -side);
        found.inside = result.inside;
        return found;
    }

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

    // ---- Half-spaces

    // Of distances the largest (1) or the smallest (-1), and the plane with the lowest number that has it.
    struct Extreme {
        int direction;
        bool found = false, sure = true;
        Crossing<End> first{0, -1};
    };

    void consider(Extreme& extreme, const I& t, int index) {
        if (!extreme.found) {
            extreme.found = true;
            extreme.first = {t, index};
            return;
        }
        Crossing<End>& first = extreme.first;
        const bool above = first.t.high() < t.low(), below = t.high() < first.t.low();
        if (above || below) {
            if (above == (extreme.direction > 0)) {
                first = {t, index};
                extreme.sure = true;
            }
            return;
        }
        int order = 0;
        try {
            order = this->order({t, index}, first, Reason::plane);
        } catch (const Undecided&) {
            first.t = extreme.direction > 0 ? max(first.t, t) : min(first.t, t);
            extreme.sure = false;
            return;
        }
        if (order * extreme.direction > 0) {
            first = {t, index};
        }
    }

    // Where a ray meets a plane: sign of its slope, and the distance if that is not 0; `side` tells of one that runs
    // along.
    int meet_plane(const S& s, const R& ray, I& t, int& side) {
        const bool start = starts_on(s, ray), end = ends_on(s, ray);
        side = 0;
        if (start && end) {
            return 0;
        }
        const I slope = dot(s.vector, ray.direction);
        if (start) {
            t = I(0);
            return judge_.sign(slope, Reason::hit);
        }
        const I height = dot(s.vector, ray.origin) + s.number;
        if (end) {
            t = I(1);
            return -judge_.sign(height, Reason::shadow);
        }
        const int sign = judge_.sign(slope, Reason::hit);
        if (sign == 0) {
            side = judge_.sign(height, Reason::hit);
        } else {
            t = -height / slope;
        }
        return sign;
    }

    // Those of a polyhedron that matter, in their order; false: the ray certainly misses it.
    bool sift(const Leaf& leaf, const PlainRay& narrow, double end, bool entries) {
        if (plain_ != nullptr) {
            return plain_->planes[leaf.first].sift(narrow, end, entries, sieve_);
        }
        sieve_.left.resize(leaf.count);
        std::iota(sieve_.left.begin(), sieve_.left.end(), std::size_t(0));
        return true;
    }

    Passage<End> pass_planes(const Leaf& leaf, const R& ray, const PlainRay& narrow, double end) {
        if (!sift(leaf, narrow, end, true)) {
            return {};
        }
        Extreme enters{1}, leaves{-1};
        for (const std::size_t k : sieve_.left) {
            const int index = static_cast<int>(leaf.first + k);
            I t;
            int side;
            const int slope = meet_plane(surface(index), ray, t, side);
            if (slope == 0) {
                if (side > 0) {
                    return {};
                }
                continue;
            }
            if (slope > 0 && t.negative()) {
                return {};  // it is left before the start
            }
            consider(slope < 0 ? enters : leaves, t, index);
            if (enters.found && leaves.found && leaves.first.t.high() < enters.first.t.low()) {
                return {};
            }
        }
        Passage<End> result;
        if (enters.found && leaves.found && order(enters.first, leaves.first, Reason::hit) > 0) {
            return {};
        }
        const int entered = enters.found ? judge_.sign(enters.first.t, Reason::hit) : -1;
        const int left = leaves.found ? judge_.sign(leaves.first.t, Reason::hit) : 1;
        result.inside = entered <= 0 && left > 0;
        if (entered > 0) {
            check(enters);
            add(result, enters.first.t, enters.first.surface);
        }
        if (leaves.found && left > 0) {
            if (result.count == 0) {
                check(leaves);
            }
            add(result, leaves.first.t, leaves.first.surface);
            second_sure_ = leaves.sure;
        }
        return result;
    }

    // From a face inward, or a plate's other side.
    bool leave(int index, const Leaf& leaf, const R& ray, const PlainRay& narrow, Met<End>& met) {
        sift(leaf, narrow, infinite, false);
        Extreme leaves{-1};
        for (const std::size_t k : sieve_.left) {
            const int plane = static_cast<int>(leaf.first + k);
            if (plane == ray.surface) {
                continue;
            }
            I t;
            int side;
            const int slope = meet_plane(surface(plane), ray, t, side);
            if (slope > 0) {
                // From within it is not before the start.
                consider(leaves, max(t, I(0)), plane);
            }
        }
        if (!leaves.found) {
            return false;
        }
        check(leaves);
        met = {leaves.first.t, index, leaves.first.surface, true, true};
        return true;
    }

    static void check(const Extreme& extreme) {
        if (!extreme.sure) {
            throw Undecided{Reason::plane};
        }
    }

    static void add(Passage<End>& passage, const I& t, int surface) {
        passage.crossings[static_cast<std::size_t>(passage.count++)] = {t, surface};
    }

    // ---- Constructive solid geometry

    struct Event {
        Crossing<End> crossing;
        std::size_t leaf;  // of the body's
        bool sure;         // which surface it is
    };

    bool meet_csg(int index, const Body& body, const R& ray, const PlainRay& narrow, Met<End>& met) {
        std::uint64_t bits = 0;
        std::vector<Event>& events = events_;
        events.clear();
        for (std::size_t k = 0; k < body.leaves.size(); ++k) {
            second_sure_ = true;
            const Passage<End> passage = pass(scene_.scene.leaves[body.leaves[k]], ray, narrow, infinite, false);
            bits |= std::uint64_t(passage.inside) << k;
            for (int i = 0; i < passage.count; ++i) {
                events.push_back(
                    {passage.crossings[static_cast<std::size_t>(i)], k, i == passage.count - 1 ? second_sure_ : true});
            }
        }
        const bool before = contains(body, bits);
        if (ray.body == index && before != ray.inside && cross_at_start(index, body, ray, met)) {
            return true;
        }
        if (events.empty()) {
            return false;
        }
        std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
            const double one = a.crossing.t.high_double(), other = b.crossing.t.high_double();
            return one != other ? one < other : a.crossing.surface < b.crossing.surface;
        });
        for (std::size_t first = 0; first < events.size();) {
            std::size_t last = first + 1;
            while (last < events.size() && order(events[first].crossing, events[last].crossing, Reason::hit) >= 0) {
                ++last;
            }
            // What comes later may still begin before what is sorted last here.
            for (std::size_t k = last; k < events.size(); ++k) {
                if (events[k].crossing.t.low() <= events[first].crossing.t.high() &&
                    order(events[first].crossing, events[k].crossing, Reason::hit) >= 0) {
                    throw Undecided{Reason::hit};
                }
            }
            std::size_t named = first;
            const std::uint64_t bits_before = bits;
            for (std::size_t k = first; k < last; ++k) {
                bits ^= std::uint64_t(1) << events[k].leaf;
                named = events[k].crossing.surface < events[named].crossing.surface ? k : named;
            }
            if (contains(body, bits) != before) {
                if (!events[named].sure) {
                    throw Undecided{Reason::plane};
                }
                met = {events[named].crossing.t, index, events[named].crossing.surface, before,
                       (bits_before >> events[named].leaf & 1) != 0};
                return true;
            }
            first = last;
        }
        return false;
    }

    // A ray that starts on the body, and goes on inside or outside of it, meets what else is at an edge at once, as it
    // does at a polyhedron's: the first surface of those by which the whole is left there, or entered.
    bool cross_at_start(int index, const Body& body, const R& ray, Met<End>& met) {
        const std::uint64_t turned = subtracted(body);
        for (std::size_t k = 0; k < body.leaves.size(); ++k) {
            const Leaf& leaf = scene_.scene.leaves[body.leaves[k]];
            const bool leaves = ray.inside != ((turned >> k & 1) != 0);
            int first = -1;
            for (std::size_t i = 0; i < std::max(leaf.count, std::size_t(1)); ++i) {
                const S& s = surface(leaf.first + i);
                const bool start = starts_on(s, ray);
                const int side = start ? 0 : judge_.sign(height(s, ray.origin), Reason::hit);
                if (side > 0) {
                    first = -1;
                    break;  // beside the leaf
                }
                if (side == 0 && first < 0 && judge_.sign(slope(s, ray), Reason::hit) == (leaves ? 1 : -1)) {
                    first = static_cast<int>(leaf.first + i);
                }
            }
            if (first >= 0) {
                met = {I(0), index, first, ray.inside, leaves};
                return true;
            }
        }
        return false;
    }

    // What is positive outside of a surface, and how that grows along a ray where it starts.
    I height(const S& s, const V& p) const {
        return s.kind == Kind::sphere  ? length2(p - s.vector) - square(s.number)
               : s.kind == Kind::plane ? dot(s.vector, p) + s.number
                                       : value(s, p);
    }
    I slope(const S& s, const R& ray) const {
        return dot(s.kind == Kind::sphere  ? ray.origin - s.vector
                   : s.kind == Kind::plane ? s.vector
                                           : gradient(s, ray.origin),
                   ray.direction);
    }

    // The leaves, a bit each, with which the body can only shrink.
    static std::uint64_t subtracted(const Body& body) {
        std::uint64_t stack = 0, leaves = 0;  // of the operands that are left to be read, backwards
        for (std::size_t i = body.program.size(); i-- > 0;) {
            const int step = body.program[i];
            const std::uint64_t turned = stack & 1;
            if (step >= 0) {
                leaves |= turned << step;
                stack >>= 1;
            } else {
                stack = stack << 1 | (turned ^ std::uint64_t(step == Body::subtract));
            }
        }
        return leaves;
    }

    static bool contains(const Body& body, std::uint64_t bits) {
        std::uint64_t stack = 0;  // the last value lowest
        for (const int step : body.program) {
            if (step >= 0) {
                stack = stack << 1 | (bits >> step & 1);
                continue;
            }
            const std::uint64_t right = stack & 1, left = stack >> 1 & 1;
            const std::uint64_t value = step == Body::unite      ? left | right
                                        : step == Body::subtract ? left & ~right
                                                                 : left & right;
            stack = (stack >> 2) << 1 | (value & 1);
        }
        return stack & 1;
    }

    static constexpr double infinite = std::numeric_limits<double>::infinity();

    const PreparedScene<End>& scene_;
    Judge<End>& judge_;
    const PlainScene* plain_;
    PlainPlanes::Sieve sieve_;
    std::vector<Event> events_;
    bool second_sure_ = true;
};

}  // namespace certified
