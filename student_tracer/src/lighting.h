// A surface's own colour: the light that it sends to the viewer from lamps and from all around.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>

#include "deviations.h"
#include "record.h"
#include "scene.h"
#include "shapes.h"
#include "surface.h"
#include "vector.h"
#include "world.h"

namespace student {

template <typename Real>
class Lighting {
 public:
    using V = Vector<Real>;
    using C = Color<Real>;

    explicit Lighting(const World<Real>& world) : world_(world), on(world.on) {}

    // ka ambient C + sum over the lamps in sight of  lamp / (a + b d + c d^2) (kd C (n.l) + ks highlight^alpha)
    C local_color(const Surface<Real>& surface, Record* record, int index) const {
        const Finish& finish = *surface.finish;
        C color{};
        bool some_shadow = false;
        if (finish.kd > 0 || finish.ks > 0) {
            for (std::size_t i = 0; i < world_.lamps.size(); ++i) {
                bool shadowed = false;
                color += lamp_color(surface, i, shadowed, record, index);
                some_shadow |= shadowed;
                if (shadowed && on(On::shadow_stops_lamps)) {
                    break;
                }
            }
        }
        if (!(some_shadow && on(On::ambient_shadowed))) {
            color = ambient_color(surface) + color;
        }
        if (on(On::local_scaled)) {
            color = std::max(Real(0), Real(1 - finish.kr - finish.kt)) * color;
        }
        if (record) {
            record->rays[std::size_t(index)].local = triple(color);
        }
        return color;
    }

 private:
    C ambient_color(const Surface<Real>& surface) const {
        const C one{1, 1, 1};
        const C pigment = on(On::ambient_without_pigment) ? one : surface.pigment;
        Real k = static_cast<Real>(surface.finish->ka);
        if (on(On::ambient_missing)) {
            k = 0;
        } else if (on(On::ambient_times_kd)) {
            k *= static_cast<Real>(surface.finish->kd);
        } else if (on(On::ambient_without_ka)) {
            k = 1;
        } else if (on(On::ambient_per_lamp)) {
            k *= static_cast<Real>(world_.lamps.size());
        }
        return k * world_.ambient * pigment;
    }

    // A lamp as a surface sees it.
    struct Seen {
        V to_lamp, normal;
        Real cosine;  // of the angle between these
        Real scale;   // 1, but for vectors of a wrong length
        bool there;   // it is not at the very point
        bool faces;   // it is before the surface
        Real open;    // which share of its light gets through
        C color;
        Real attenuation;  // what its colour is divided by
    };

    C lamp_color(const Surface<Real>& surface, std::size_t i, bool& shadowed, Record* record, int index) const {
        const Lamp& lamp = world_.lamps[i];
        const V path = vector_of<Real>(lamp.position) - surface.point;
        const Real distance = length(path);
        Seen seen;
        seen.to_lamp = path / distance;
        seen.normal = on(On::shading_normal_not_turned) ? surface.outward : surface.normal;
        seen.cosine = dot(seen.normal, seen.to_lamp);
        // A surface is not lit along itself, nor by a lamp at the very point.
        constexpr Real along = std::is_same_v<Real, float> ? Real(1e-6) : Real(1e-9);
        seen.there = distance > along * reach(surface.point);
        seen.faces = seen.cosine > along && seen.there;
        const bool unlit_side = on(On::diffuse_two_sided) || on(On::diffuse_negative) || on(On::highlight_uncut) ||
                                on(On::highlight_unlit_side);
        const bool answers = seen.faces || (unlit_side && seen.there);
        if (!answers && !record) {
            return {};
        }
        int blocker = -1;
        seen.open = answers ? light_through(surface, i, seen.to_lamp, distance, blocker) : 0;
        shadowed = seen.open < 1 && (seen.faces || on(On::diffuse_two_sided));
        seen.color = on(On::lamp_color_ignored) ? C{1, 1, 1} : vector_of<Real>(lamp.color);
        seen.attenuation = attenuation_of(lamp, distance);
        seen.scale = surface.normal_length * (on(On::lamp_vector_not_unit) ? distance : Real(1));

        const C diffuse = diffuse_color(surface, seen);
        C specular = specular_color(surface, seen);
        if (on(On::clamped_per_lamp)) {
            const C sum = clamped(diffuse + specular);
            specular = sum - diffuse;
        }
        if (record) {
            record->light(index, world_.number_of(i), double(seen.cosine), double(seen.attenuation), blocker, diffuse,
                          specular);
        }
        return diffuse + specular;
    }

    C diffuse_color(const Surface<Real>& surface, const Seen& seen) const {
        const Real cosine = seen.scale * (on(On::diffuse_two_sided)  ? std::abs(seen.cosine)
                                          : on(On::diffuse_negative) ? seen.cosine
                                          : seen.faces               ? seen.cosine
                                                                     : Real(0));
        return seen.open * diffuse_factor(*surface.finish, cosine, surface.pigment) / seen.attenuation * seen.color;
    }

    C specular_color(const Surface<Real>& surface, const Seen& seen) const {
        const Finish& finish = *surface.finish;
        const bool uncut = on(On::highlight_uncut) || on(On::highlight_unlit_side) || on(On::diffuse_two_sided);
        const bool unshadowed = on(On::highlight_in_shadow) || on(On::highlight_unlit_side);
        if (!(finish.ks > 0 && (seen.faces || (uncut && seen.there)) && (seen.open > 0 || unshadowed))) {
            return {};
        }
        const Real strength = (unshadowed ? Real(1) : seen.open) * static_cast<Real>(finish.ks) *
                              highlight(surface, seen) /
                              (on(On::highlight_without_attenuation) ? Real(1) : seen.attenuation);
        C color = strength * (on(On::highlight_white) ? C{1, 1, 1} : seen.color);
        if (on(On::highlight_tinted)) {
            color = color * surface.pigment;
        }
        if (on(On::highlight_times_cosine)) {
            color = std::max(seen.cosine, Real(0)) * color;
        }
        return color;
    }

    C diffuse_factor(const Finish& finish, Real cosine, C pigment) const {
        if (on(On::diffuse_missing)) {
            return {};
        }
        const Real factor = on(On::diffuse_without_cosine) ? Real(cosine > 0 ? 1 : 0) : cosine;
        return static_cast<Real>(finish.kd) * factor * (on(On::diffuse_without_pigment) ? C{1, 1, 1} : pigment);
    }

    // Phong's max(0, r.v)^alpha, r the mirror direction of the lamp.
    Real highlight(const Surface<Real>& surface, const Seen& seen) const {
        if (on(On::highlight_missing)) {
            return 0;
        }
        const V& viewer = surface.to_viewer;
        Real base;
        if (on(On::blinn)) {
            base = dot(seen.normal, normalize(seen.to_lamp + viewer)) * surface.normal_length;
        } else {
            const bool unit = !on(On::lamp_vector_not_unit);
            const V lamp = unit ? seen.to_lamp : seen.scale / surface.normal_length * seen.to_lamp;
            const Real cosine = seen.scale * seen.cosine;
            const V r = 2 * cosine * surface.normal_length * seen.normal - lamp;
            base = dot(r, viewer) * (on(On::highlight_reflection_wrong) ? Real(-1) : Real(1));
        }
        if (on(On::highlight_two_sided)) {
            base = std::abs(base);
        }
        base = std::max(base, Real(0));
        // A cosine that is rounded above 1 has powers without bounds.
        const bool lengths_right = seen.scale == 1 && !on(On::direction_not_unit);
        base = lengths_right ? std::min(base, Real(1)) : base;
        return on(On::highlight_without_alpha) ? base : std::pow(base, static_cast<Real>(surface.finish->alpha));
    }

    // What a lamp's colour is divided by.
    Real attenuation_of(const Lamp& lamp, Real d) const {
        Real a = static_cast<Real>(lamp.attenuation[0]);
        Real b = static_cast<Real>(lamp.attenuation[1]);
        Real c = static_cast<Real>(lamp.attenuation[2]);
        if (on(On::attenuation_reversed)) {
            std::swap(a, c);
        } else if (on(On::attenuation_without_linear)) {
            b = 0;
        } else if (on(On::attenuation_quadratic_only)) {
            a = b = 0;
        } else if (on(On::attenuation_missing)) {
            a = 1;
            b = c = 0;
        } else if (on(On::attenuation_inverse_square)) {
            a = b = 0;
            c = 1;
        } else if (on(On::attenuation_squared_distance)) {
            d = d * d;
        }
        const Real sum = a + b * d + c * d * d;
        if (on(On::attenuation_clamped)) {
            return std::max(sum, Real(1));
        }
        return on(On::attenuation_multiplied) ? 1 / sum : sum;
    }

    // Which share of a lamp's light reaches the surface, 0 or 1; and what blocks it.
    Real light_through(const Surface<Real>& surface, std::size_t lamp, V to_lamp, Real distance, int& blocker) const {
        if (on(On::shadows_missing) || (on(On::shadows_first_lamp_only) && lamp > 0)) {
            return 1;
        }
        Ray<Real> ray = surface.start;
        ray.direction = to_lamp;
        ray.inside = dot(surface.outward, to_lamp) < 0;
        // A surface that the lamp lies on is not in its way.
        constexpr Real nearly = std::is_same_v<Real, float> ? Real(1 - 1e-5) : Real(1 - 1e-11);
        const Real limit = on(On::shadows_beyond_lamp) ? std::numeric_limits<Real>::infinity() : distance * nearly;
        Real open = 1;
        for (int i = 0; i < static_cast<int>(world_.bodies.size()); ++i) {
            if (on(On::own_side_casts_none) && i == surface.object) {
                continue;
            }
            const double kt = world_.finish_of(i).kt;
            if (kt > 0 && on(On::transparent_casts_none)) {
                continue;
            }
            if (!(meet(world_.bodies[std::size_t(i)], i, ray, on).t < limit)) {
                continue;
            }
            blocker = i;
            open *= kt > 0 && on(On::transparent_dims) ? static_cast<Real>(kt) : Real(0);
            if (!(open > 0)) {
                return 0;
            }
        }
        return open;
    }

    const World<Real>& world_;
    const Switches& on;
};

}  // namespace student
