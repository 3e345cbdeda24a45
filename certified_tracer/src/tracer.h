// The colours of pixels, as docs and README read the format, in intervals: what they enclose is true whatever is
// rounded.
//
// A decision that is not certain ends the pixel, but where both answers can be told at once: a tile, a texel, whether a
// light is seen.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "crossings.h"
#include "prepared.h"
#include "tree.h"

namespace certified {

template <typename End>
class Tracer {
 public:
    using I = Interval<End>;
    using V = Vector<I>;
    using R = Ray<End>;

    Tracer(const PreparedScene<End>& scene, const Tree& tree, bool last)
        : scene_(scene), tree_(tree), judge_(last, scene.scene.ties), bodies_(scene, judge_) {}

    // The mean of a pixel's rays. Throws Undecided.
    V pixel(int column, int row) {
        judge_.tied = judge_.degenerate = false;
        doubt_ = Reason::none;
        const Scene& s = scene_.scene;
        V sum{0, 0, 0};
        for (int j = 0; j < s.grid; ++j) {
            for (int i = 0; i < s.grid; ++i) {
                sum = sum + color(primary(column, row, i, j));
            }
        }
        if (s.grid == 1) {
            return sum;
        }
        const I count = s.grid * s.grid;
        return {sum.x / count, sum.y / count, sum.z / count};
    }

    // What was not certain, but could be told with all its answers.
    Reason doubt() const { return doubt_; }
    bool tied() const { return judge_.tied; }
    bool degenerate() const { return judge_.degenerate; }

 private:
    struct Task {
        R ray;
        I weight;
        int depth;
    };

    // Through the window, from -W/H to W/H and from -1 to 1, at the grid's cell (i, j) of a pixel.
    R primary(int column, int row, int i, int j) const {
        const Scene& s = scene_.scene;
        // In units of half a cell.
        const int cells = 2 * s.grid, shift = s.corner ? s.grid : 0;
        const I x = I(2 * (column * cells + 2 * i + 1 - shift) - s.width * cells) / I(s.height * cells);
        const I y = I(s.height * cells - 2 * (row * cells + 2 * j + 1 - shift)) / I(s.height * cells);
        R ray;
        ray.origin = scene_.eye;
        ray.direction = normalized(scene_.view + x * scene_.right + y * scene_.up);
        ray.from_eye = true;
        return ray;
    }

    V color(const R& primary) {
        V sum{0, 0, 0};
        tasks_.clear();
        tasks_.push_back({primary, I(1), 0});
        while (!tasks_.empty()) {
            const Task task = tasks_.back();
            tasks_.pop_back();
            sum = sum + task.weight * shade(task);
        }
        return sum;
    }

    // A ray's own colour; what follows it becomes tasks.
    V shade(const Task& task) {
        const R& ray = task.ray;
        Met<End> met;
        if (!nearest(ray, met)) {
            return scene_.background;
        }
        const Body& body = scene_.scene.bodies[static_cast<std::size_t>(met.body)];
        const auto& finish = scene_.finishes[static_cast<std::size_t>(body.finish)];
        const V point = ray.origin + met.t * ray.direction;
        const V outward = bodies_.normal(met.surface, point);
        const V normal = met.behind ? -outward : outward;
        const V pigment = pigment_at(body.pigment, point, met.surface);
        V color = finish.ka * product(scene_.ambient, pigment);
        if (finish.lit) {
            for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
                color = color + lit(i, ray, met, point, normal, finish, pigment);
            }
        }
        follow(task, met, point, normal, finish);
        return color;
    }

    // ---- What a ray meets

    DoubleRay in_doubles(const R& ray) const {
        DoubleRay result;
        const V* vectors[] = {&ray.origin, &ray.direction};
        for (int k = 0; k < 2; ++k) {
            const I* coordinates[] = {&vectors[k]->x, &vectors[k]->y, &vectors[k]->z};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                (k == 0 ? result.origin : result.direction)[axis] = in_double(*coordinates[axis]);
            }
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const Interval<double>& d = result.direction[axis];
            result.sign[axis] = d.positive() ? 1 : d.negative() ? -1 : 0;
            if (result.sign[axis] != 0) {
                result.inverse[axis] = Interval<double>(1) / d;
            }
        }
        return result;
    }

    static Interval<double> in_double(const I& x) {
        if constexpr (std::is_same_v<End, double>) {
            return x;
        } else {
            return Interval<double>::between(x.low_double(), x.high_double());
        }
    }

    // The first of the file of those at the same distance.
    bool nearest(const R& ray, Met<End>& best) {
        bool found = false;
        std::optional<Undecided> unknown;
        double unknown_from = std::numeric_limits<double>::infinity();
        double reach = unknown_from;
        const auto visit = [&](int body, double near) {
            Met<End> met;
            try {
                if (!bodies_.meet(body, ray, met)) {
                    return;
                }
                if (found) {
                    const int order = bodies_.order({met.t, met.surface}, {best.t, best.surface}, Reason::hit);
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
        tree_.search(in_doubles(ray), visit, [&] { return reach; });
        if (unknown && unknown_from <= reach) {
            throw *unknown;
        }
        return found;
    }

    // Whether a body lies between a point and a light, which is where the direction ends.
    bool in_the_way(const R& ray) {
        bool blocked = false;
        std::optional<Undecided> unknown;
        const auto visit = [&](int body, double) {
            if (blocked) {
                return;
            }
            try {
                Met<End> met;
                if (bodies_.meet(body, ray, met) && judge_.sign(met.t - I(1), Reason::shadow) < 0) {
                    blocked = true;
                }
            } catch (const Undecided& undecided) {
                unknown = undecided;
            }
        };
        tree_.search(in_doubles(ray), visit, [&] { return blocked ? -1.0 : 1.0; });
        if (!blocked && unknown) {
            throw *unknown;
        }
        return blocked;
    }

    // ---- Local colour

    static V product(const V& a, const V& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

    template <typename Finish>
    V lit(std::size_t index, const R& ray, const Met<End>& met, const V& point, const V& normal, const Finish& finish,
          const V& pigment) {
        const V none{0, 0, 0};
        const auto& light = scene_.lights[index];
        const auto& surface = scene_.surfaces[static_cast<std::size_t>(met.surface)];
        if (surface.kind == Kind::plane && (*surface.lights)[index]) {
            return none;  // a surface is not lit along itself
        }
        const V path = light.position - point;
        const I along = dot(normal, path);
        if (along.negative()) {
            return none;
        }
        bool doubtful = false;
        try {
            if (judge_.sign(along, Reason::facing) <= 0) {
                return none;
            }
            R shadow;
            shadow.origin = point;
            shadow.direction = path;
            shadow.body = met.body;
            shadow.surface = met.surface;
            shadow.inside = met.inside;
            shadow.to_light = static_cast<int>(index);
            if (in_the_way(shadow)) {
                return none;
            }
        } catch (const Undecided& undecided) {
            doubtful = true;
            doubt_ = undecided.reason == Reason::facing ? Reason::facing : Reason::shadow;
        }
        const I distance2 = length2(path), distance = sqrt(distance2);
        const I cosine = max(along, I(0)) / distance;
        const I dimming = light.a + light.b * distance + light.c * distance2;
        V factor = finish.kd * cosine * pigment;
        if (!finish.ks.is_zero()) {
            const V to_light{path.x / distance, path.y / distance, path.z / distance};
            const I base = scene_.scene.blinn ? dot(normal, normalized(to_light - ray.direction))
                                              : dot(to_light - I(2) * cosine * normal, ray.direction);
            const I shine = finish.ks * power(min(max(base, I(0)), I(1)), finish.alpha);
            factor = {factor.x + shine, factor.y + shine, factor.z + shine};
        }
        const V color = product(factor, light.color);
        const V result{color.x / dimming, color.y / dimming, color.z / dimming};
        return doubtful ? V{hull(result.x, I(0)), hull(result.y, I(0)), hull(result.z, I(0))} : result;
    }

    // ---- Pigments

    V pigment_at(int index, const V& point, int surface) {
        const auto& prepared = scene_.pigments[static_cast<std::size_t>(index)];
        const Pigment& pigment = scene_.scene.pigments[static_cast<std::size_t>(index)];
        if (pigment.pattern == Pattern::solid) {
            return prepared.first;
        }
        if (pigment.pattern == Pattern::checker) {
            const Surface& met = scene_.scene.surfaces[static_cast<std::size_t>(surface)];
            const std::array<const I*, 3> coordinates = {&point.x, &point.y, &point.z};
            bool odd = false;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::optional<std::int64_t> cell =
                    met.axis == static_cast<int>(axis) ? met.layer
                                                       : whole(*coordinates[axis] / prepared.size, Reason::tile, false);
                if (!cell) {
                    doubt_ = Reason::tile;
                    return {hull(prepared.first.x, prepared.second.x), hull(prepared.first.y, prepared.second.y),
                            hull(prepared.first.z, prepared.second.z)};
                }
                odd ^= (*cell & 1) != 0;
            }
            return odd ? prepared.second : prepared.first;
        }
        const I s = dot(prepared.columns, point) + prepared.column, r = dot(prepared.rows, point) + prepared.row;
        const std::optional<std::int64_t> column = whole(s, Reason::texel, true), row = whole(r, Reason::texel, true);
        if (column && row) {
            return texel(pigment, *column, *row);
        }
        // All that the point may lie on.
        doubt_ = Reason::texel;
        const std::array<std::int64_t, 2> columns = span(s, column), rows = span(r, row);
        V all = texel(pigment, columns[0], rows[0]);
        for (std::int64_t y = rows[0]; y <= rows[1]; ++y) {
            for (std::int64_t x = columns[0]; x <= columns[1]; ++x) {
                const V one = texel(pigment, x, y);
                all = {hull(all.x, one.x), hull(all.y, one.y), hull(all.z, one.z)};
            }
        }
        return all;
    }

    // The whole number below x, or next to it on the way to 0; none where that is not certain.
    std::optional<std::int64_t> whole(const I& x, Reason reason, bool toward_zero) {
        const double middle = x.middle();
        if (!(std::fabs(middle) < 0x1p50)) {
            return {};
        }
        const double nearest = nearest_whole(middle);
        const I beyond = x - I(nearest);
        if (!(beyond.high_double() < 1 && beyond.low_double() > -1)) {
            return {};
        }
        try {
            const int side = judge_.sign(beyond, reason);
            const auto number = static_cast<std::int64_t>(nearest);
            if (side == 0) {
                return number;
            }
            const std::int64_t below = side > 0 ? number : number - 1;
            return toward_zero && below < 0 ? below + 1 : below;
        } catch (const Undecided&) {
            return {};
        }
    }

    // Whatever the processor rounds to.
    static double nearest_whole(double x) {
        const auto toward_zero = static_cast<double>(static_cast<std::int64_t>(x));
        const double left = x - toward_zero;
        return left > 0.5 ? toward_zero + 1 : left < -0.5 ? toward_zero - 1 : toward_zero;
    }

    std::array<std::int64_t, 2> span(const I& x, const std::optional<std::int64_t>& known) const {
        if (known) {
            return {*known, *known};
        }
        const double low = x.low_double(), high = x.high_double();
        if (!(high - low < 8 && std::fabs(low) < 0x1p50)) {
            throw Undecided{Reason::texel};
        }
        return {static_cast<std::int64_t>(low), static_cast<std::int64_t>(high)};  // both toward 0
    }

    static V texel(const Pigment& pigment, std::int64_t column, std::int64_t row) {
        const auto wrapped = [](std::int64_t i, int count) {
            const std::int64_t rest = i % count;
            return static_cast<std::size_t>(rest < 0 ? rest + count : rest);
        };
        const unsigned short* t =
            pigment.texels.data() + 3 * (wrapped(row, pigment.height) * static_cast<std::size_t>(pigment.width) +
                                         wrapped(column, pigment.width));
        const I largest = pigment.largest;
        return {I(t[0]) / largest, I(t[1]) / largest, I(t[2]) / largest};
    }

    // ---- Secondary rays

    template <typename Finish>
    void follow(const Task& task, const Met<End>& met, const V& point, const V& normal, const Finish& finish) {
        const bool reflects = finish.reflects && worthwhile(task, task.weight * finish.kr);
        const bool transmits = finish.transmits && worthwhile(task, task.weight * finish.kt);
        if (!reflects && !transmits) {
            return;
        }
        R next;
        next.origin = point;
        next.body = met.body;
        next.surface = met.surface;
        const V& direction = task.ray.direction;
        const I across = dot(direction, normal);
        const V mirrored = direction - I(2) * across * normal;
        if (reflects) {
            next.direction = mirrored;
            next.inside = met.inside;
            tasks_.push_back({next, task.weight * finish.kr, task.depth + 1});
        }
        if (transmits) {
            const I eta = met.inside ? I(1) / finish.eta : finish.eta;
            const I cosine2 = (I(1) - eta) * (I(1) + eta) + square(eta * across);
            const int sign = judge_.sign(cosine2, Reason::reflection);
            next.inside = sign < 0 ? met.inside : !met.inside;
            // The root of what is 0 by rule, whose half of the digits would be lost.
            const I cosine = sign == 0 ? I(0) : sqrt(cosine2);
            next.direction = sign < 0 ? mirrored : eta * direction - (eta * across + cosine) * normal;
            tasks_.push_back({next, task.weight * finish.kt, task.depth + 1});
        }
    }

    bool worthwhile(const Task& task, const I& weight) {
        return task.depth < scene_.scene.max_depth &&
               (scene_.cutoff.is_zero() || judge_.sign(weight - scene_.cutoff, Reason::cutoff) >= 0);
    }

    const PreparedScene<End>& scene_;
    const Tree& tree_;
    Judge<End> judge_;
    Bodies<End> bodies_;
    std::vector<Task> tasks_;
    Reason doubt_ = Reason::none;
};

}  // namespace certified
