// What rays meet, by a tree of boxes.
//
// Rays of more digits are first searched for with doubles that enclose them, which nearly always decide what they meet;
// only the place is then computed with all digits.

#pragma once

#include <limits>
#include <optional>

#include "bodies.h"
#include "prepared.h"
#include "tree.h"

namespace certified {

inline Interval<double> in_doubles(const Interval<double>& x) { return x; }

template <typename End>
Interval<double> in_doubles(const Interval<End>& x) {
    return Interval<double>::between(x.low_double(), x.high_double());
}

template <typename End>
Vector<Interval<double>> in_doubles(const Vector<Interval<End>>& v) {
    return {in_doubles(v.x), in_doubles(v.y), in_doubles(v.z)};
}

inline const Ray<double>& in_doubles(const Ray<double>& ray) { return ray; }

template <typename End>
Ray<double> in_doubles(const Ray<End>& ray) {
    return {in_doubles(ray.origin),
            in_doubles(ray.direction),
            ray.body,
            ray.surface,
            ray.inside,
            ray.from_eye,
            ray.to_light};
}

template <typename End>
class Search {
 public:
    using R = Ray<End>;
    static constexpr bool wide = !std::is_same_v<End, double>;

    // `plain`: for tests before those with intervals. `quick`: one in doubles, for a search with more digits. Or none.
    Search(const PreparedScene<End>& scene, const Tree& tree, Judge<End>& judge, const PlainScene* plain,
           Search<double>* quick)
        : tree_(tree), judge_(judge), bodies_(scene, judge, plain), quick_(quick) {}

    const Bodies<End>& bodies() const { return bodies_; }

    // The first of the file of those at the same distance. Throws Undecided.
    bool nearest(const R& ray, Met<End>& met) {
        if constexpr (wide) {
            if (quick_ != nullptr) {
                try {
                    Met<double> found;
                    if (!quick_->nearest(in_doubles(ray), found)) {
                        return false;
                    }
                    met = bodies_.located(found, ray);
                    return true;
                } catch (const Undecided&) {  // more digits may tell
                }
            }
        }
        return nearest_of_all(ray, met);
    }

    // Whether a body lies between a point and a light, which is where the direction ends. Throws Undecided.
    bool in_the_way(const R& ray) {
        if constexpr (wide) {
            if (quick_ != nullptr) {
                try {
                    return quick_->in_the_way(in_doubles(ray));
                } catch (const Undecided&) {
                }
            }
        }
        return any_in_the_way(ray);
    }

 private:
    bool nearest_of_all(const R& ray, Met<End>& best) {
        bool found = false;
        std::optional<Undecided> unknown;
        double unknown_from = std::numeric_limits<double>::infinity();
        double reach = unknown_from;
        const Ray<double>& in_double = in_doubles(ray);
        const PlainRay narrow(in_double.origin, in_double.direction);
        const auto visit = [&](int body, double near) {
            Met<End> met;
            try {
                if (misses(body, in_double, narrow, reach) || !bodies_.meet(body, ray, narrow, reach, met)) {
                    return;
                }
                if (found) {
                    const int order =
                        bodies_.surfaces().order({met.t, met.surface}, {best.t, best.surface}, Reason::hit);
                    if (order > 0 || (order == 0 && best.body < body)) {
                        return;
                    }
                }
            } catch (const Undecided& undecided) {
                if (near < unknown_from) {
                    unknown_from = near;
                    unknown = undecided;
                }
                return;
            }
            found = true;
            best = met;
            reach = best.t.high_double();
        };
        tree_.search(narrow, visit, [&] { return reach; });
        if (unknown && unknown_from <= reach) {
            throw *unknown;
        }
        return found;
    }

    bool any_in_the_way(const R& ray) {
        bool blocked = false;
        std::optional<Undecided> unknown;
        const Ray<double>& in_double = in_doubles(ray);
        const PlainRay narrow(in_double.origin, in_double.direction);
        const auto visit = [&](int body, double) {
            if (blocked) {
                return;
            }
            try {
                Met<End> met;
                if (!misses(body, in_double, narrow, 1) && bodies_.meet(body, ray, narrow, 1, met) &&
                    judge_.sign(met.t - Interval<End>(1), Reason::shadow) < 0) {
                    blocked = true;
                }
            } catch (const Undecided& undecided) {
                unknown = undecided;
            }
        };
        tree_.search(narrow, visit, [&] { return blocked ? -1.0 : 1.0; });
        if (!blocked && unknown) {
            throw *unknown;
        }
        return blocked;
    }

    // Whether doubles tell already that a ray with more digits does not meet a body.
    bool misses([[maybe_unused]] int body, [[maybe_unused]] const Ray<double>& ray,
                [[maybe_unused]] const PlainRay& narrow, [[maybe_unused]] double end) {
        if constexpr (wide) {
            if (quick_ != nullptr) {
                try {
                    Met<double> met;
                    return !quick_->bodies_.meet(body, ray, narrow, end, met);
                } catch (const Undecided&) {
                }
            }
        }
        return false;
    }

    template <typename>
    friend class Search;

    const Tree& tree_;
    Judge<End>& judge_;
    Bodies<End> bodies_;
    Search<double>* quick_;
};

}  // namespace certified
