// A surface's own colour: its pigment, and the lights that reach it.
//
// A decision that is not certain gives the colour of both answers, where these can be told at once: a tile, a texel,
// whether a light is seen.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "search.h"

namespace certified {

template <typename End>
class Shading {
 public:
    using I = Interval<End>;
    using V = Vector<I>;
    using R = Ray<End>;

    Shading(const PreparedScene<End>& scene, Search<End>& search, Judge<End>& judge)
        : scene_(scene), search_(search), judge_(judge) {}

    // Of the point where a ray meets a surface, with the normal on the ray's side. Throws Undecided.
    V color(const R& ray, const Met<End>& met, const V& point, const V& normal) {
        const Body& body = scene_.scene.bodies[static_cast<std::size_t>(met.body)];
        const auto& finish = scene_.finishes[static_cast<std::size_t>(body.finish)];
        const V pigment = pigment_at(body.pigment, point, met.surface);
        V sum = finish.ka * product(scene_.ambient, pigment);
        if (finish.lit) {
            for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
                sum = sum + lit(i, ray, met, point, normal, finish, pigment);
            }
        }
        return sum;
    }

    // What was not certain, but could be told with all its answers, since this was none.
    Reason doubt = Reason::none;

 private:
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
            if (search_.in_the_way(shadow)) {
                return none;
            }
        } catch (const Undecided& undecided) {
            doubtful = true;
            doubt = undecided.reason == Reason::facing ? Reason::facing : Reason::shadow;
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
                    doubt = Reason::tile;
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
        doubt = Reason::texel;
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

    const PreparedScene<End>& scene_;
    Search<End>& search_;
    Judge<End>& judge_;
};

}  // namespace certified
