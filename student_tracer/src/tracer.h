// A ray tracer as a student writes it: one ray after the other, one function for each formula of the statement, and in
// each the ways in which it is got wrong. With no switch set it draws what the statement asks for.
//
// It shares no code with native_tracer, so that it is an opinion of its own. It is written for reading, not for speed.

#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "camera.h"
#include "pigment.h"
#include "record.h"
#include "scene.h"
#include "shapes.h"
#include "vector.h"

namespace student {

template <typename Real>
class Tracer {
 public:
    using V = Vector<Real>;
    using C = Color<Real>;

    Tracer(const Scene& scene, Size size, const Switches& switches)
        : scene_(scene),
          on(switches),
          size_(size),
          view_(scene.camera, drawn_size(size, switches), switches),
          lamps_(scene.lamps),
          ambient_(vector_of<Real>(scene.ambient)),
          background_(vector_of<Real>(scene.background)),
          cutoff_(static_cast<Real>(scene.cutoff)),
          max_depth_(scene.max_depth) {
        for (const Object& object : scene.objects) {
            bodies_.emplace_back(object, on);
        }
        set_lights();
        set_depth();
        epsilon_ = on(On::epsilon_thousandth)  ? Real(1e-3)
                   : on(On::epsilon_hundredth) ? Real(1e-2)
                   : on(On::epsilon_tenth)     ? Real(1e-1)
                   : on(On::epsilon_none)      ? Real(0)
                                               : Real(-1);
    }

    // The colour of pixel (x, y), neither clamped nor rounded; its rays are added to `record`, if there is one.
    C pixel(int x, int y, Record* record = nullptr) const {
        const V direction = view_.direction(place_of(x, y, size_, on));
        const V eye = vector_of<Real>(scene_.camera.eye);
        Ray<Real> ray{eye, normalize(direction), rounding(eye, 0)};
        return trace(ray, on(On::direction_not_unit) ? length(direction) : Real(1), 1, 0, record, -1, Kind::primary);
    }

 private:
    // A surface that a ray has hit.
    struct Surface {
        V point, outward, normal;
        Real normal_length;  // 1, but for one mistake
        V to_viewer;
        C pigment;
        const Finish* finish;
        int object;
        Ray<Real> start;  // what rays that leave it begin with
    };

    // ---- A ray ------------------------------------------------------------------------------------------------------

    // A ray's colour: local + kr reflected + kt transmitted. `viewer` is the length of the vector to the viewer.
    C trace(const Ray<Real>& ray, Real viewer, Real weight, int depth, Record* record, int parent, Kind kind) const {
        const Hit<Real> hit = nearest_hit(ray);
        const int index = record ? record->add(parent, kind, depth, double(weight), ray) : -1;
        if (hit.object < 0) {
            const C color = depth > 0 && on(On::background_primary_only) ? C{} : background_;
            if (record) {
                record->rays[std::size_t(index)].local = triple(color);
            }
            return color;
        }
        const Surface surface = surface_at(ray, hit, viewer);
        if (record) {
            record->hit(index, hit, surface.point, surface.outward, surface.pigment,
                        bodies_[std::size_t(hit.object)].round);
        }
        const Finish& finish = *surface.finish;
        C color = local_color(surface, record, index);
        if (on(On::local_scaled)) {
            color = std::max(Real(0), Real(1 - finish.kr - finish.kt)) * color;
        }
        if (record) {
            record->rays[std::size_t(index)].local = triple(color);
        }
        // A factor of 1 does not make the tree of rays larger: `weight` decides that, and is as it was.
        const Real kr = factor(finish.kr, finish.kt, on(On::kr_ignored) || (on(On::kr_inside_ignored) && hit.inside));
        const Real kt = factor(finish.kt, finish.kr, on(On::kt_ignored));
        if (kr > 0) {
            const C tint = on(On::mirrored_tinted) ? surface.pigment : C{1, 1, 1};
            const Real counted = on(On::kr_full) ? 1 : on(On::ks_for_kr) ? static_cast<Real>(finish.ks) : kr;
            color +=
                counted * tint * follow(mirrored(ray, surface), kr * weight, depth, record, index, Kind::reflected);
        }
        if (kt > 0) {
            const C tint = on(On::transmitted_tinted) ? surface.pigment : C{1, 1, 1};
            const Real counted = on(On::kt_full) ? 1 : kt;
            bool dark = false, total = false;
            const Ray<Real> next = transmitted(ray, hit, surface, dark, total);
            if (record) {
                record->rays[std::size_t(index)].total_reflection = total;
            }
            if (!dark) {
                color += counted * tint * follow(next, kt * weight, depth, record, index, Kind::transmitted);
            }
        }
        return on(On::clamped_per_ray) ? clamped(color) : color;
    }

    // kr or kt of a finish, of which `other` is the other one.
    Real factor(double own, double other, bool ignored) const {
        return ignored ? Real(0) : static_cast<Real>(on(On::kr_kt_exchanged) ? other : own);
    }

    // The colour that a secondary ray brings, if it is followed.
    C follow(const Ray<Real>& ray, Real weight, int depth, Record* record, int parent, Kind kind) const {
        const bool light = weight < cutoff_;
        if (light || depth >= max_depth_) {
            if (record) {
                record->drop(parent, kind, light);
            }
            return on(On::deepest_is_background) ? background_ : C{};
        }
        return trace(ray, 1, weight, depth + 1, record, parent, kind);
    }

    Hit<Real> nearest_hit(const Ray<Real>& ray) const {
        Hit<Real> nearest;
        for (int i = 0; i < static_cast<int>(bodies_.size()); ++i) {
            const Hit<Real> hit = meet(bodies_[std::size_t(i)], i, ray, on);
            if (hit.object >= 0 && (hit.t < nearest.t || on(On::last_object_wins))) {
                nearest = hit;
                if (on(On::first_object_wins)) {
                    break;
                }
            }
        }
        return nearest;
    }

    Surface surface_at(const Ray<Real>& ray, const Hit<Real>& hit, Real viewer) const {
        const Body<Real>& body = bodies_[std::size_t(hit.object)];
        const Object& object = scene_.objects[std::size_t(hit.object)];
        Surface surface;
        surface.point = ray.origin + hit.t * ray.direction;
        surface.normal_length = 1;
        if (body.round) {
            const V offset = surface.point - body.center;
            surface.outward = normalize(offset);
            // Back onto the sphere, of which rounding has taken it.
            surface.point = on(On::radius_not_squared) ? surface.point : body.center + body.radius * surface.outward;
            surface.normal_length = on(On::sphere_normal_not_unit) ? length(offset) : Real(1);
        } else {
            const auto& plane = body.planes[std::size_t(hit.plane)];
            surface.outward = plane.normal;
            surface.point = surface.point - (dot(plane.normal, surface.point) + plane.offset) * plane.normal;
            surface.normal_length = on(On::plane_normal_not_unit) ? plane.length : Real(1);
        }
        surface.normal = hit.inside && !on(On::normal_not_turned) ? -surface.outward : surface.outward;
        surface.to_viewer = -viewer * ray.direction;
        surface.pigment = color_at(scene_.pigments[std::size_t(object.pigment)], surface.point, on);
        surface.finish = &scene_.finishes[std::size_t(object.finish)];
        surface.object = hit.object;
        surface.start = {surface.point, {}, rounding(surface.point, hit.t), hit.object, hit.plane, hit.inside};
        if (epsilon_ >= 0) {  // a program that knows nothing of the surface, and keeps a distance
            surface.start.t_min = epsilon_;
            surface.start.object = -1;
        }
        return surface;
    }

    // A bound of the rounding error of a point found at distance t.
    static Real rounding(V point, Real t) { return 32 * std::numeric_limits<Real>::epsilon() * (reach(point) + t); }

    // ---- Light ------------------------------------------------------------------------------------------------------

    // ka ambient C + sum over the lamps in sight of  lamp / (a + b d + c d^2) (kd C (n.l) + ks highlight^alpha)
    C local_color(const Surface& surface, Record* record, int index) const {
        const Finish& finish = *surface.finish;
        C color{};
        bool some_shadow = false;
        if (finish.kd > 0 || finish.ks > 0) {
            for (std::size_t i = 0; i < lamps_.size(); ++i) {
                bool shadowed = false;
                color += lamp_color(surface, i, shadowed, record, index);
                some_shadow |= shadowed;
                if (shadowed && on(On::shadow_stops_lamps)) {
                    break;
                }
            }
        }
        return some_shadow && on(On::ambient_shadowed) ? color : ambient_color(surface) + color;
    }

    C ambient_color(const Surface& surface) const {
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
            k *= static_cast<Real>(lamps_.size());
        }
        return k * ambient_ * pigment;
    }

    C lamp_color(const Surface& surface, std::size_t i, bool& shadowed, Record* record, int index) const {
        const Lamp& lamp = lamps_[i];
        const Finish& finish = *surface.finish;
        const V path = vector_of<Real>(lamp.position) - surface.point;
        const Real distance = length(path);
        const V to_lamp = path / distance;
        const V normal = on(On::shading_normal_not_turned) ? surface.outward : surface.normal;
        Real cosine = dot(normal, to_lamp);
        // A surface is not lit along itself, nor by a lamp at the very point.
        constexpr Real along = std::is_same_v<Real, float> ? Real(1e-6) : Real(1e-9);
        const bool there = distance > along * reach(surface.point);
        const bool faces = cosine > along && there;
        const bool unlit_side = on(On::diffuse_two_sided) || on(On::diffuse_negative) || on(On::highlight_uncut) ||
                                on(On::highlight_unlit_side);
        if (!faces && !record && !(unlit_side && there)) {
            return {};
        }
        int blocker = -1;
        const Real open = faces || (unlit_side && there) ? light_through(surface, i, to_lamp, distance, blocker) : 0;
        shadowed = open < 1 && (faces || on(On::diffuse_two_sided));
        const C color = on(On::lamp_color_ignored) ? C{1, 1, 1} : vector_of<Real>(lamp.color);
        const Real attenuation = attenuation_of(lamp, distance);

        const Real scale = surface.normal_length * (on(On::lamp_vector_not_unit) ? distance : Real(1));
        const Real lit_cosine = scale * (on(On::diffuse_two_sided)  ? std::abs(cosine)
                                         : on(On::diffuse_negative) ? cosine
                                         : faces                    ? cosine
                                                                    : Real(0));
        C diffuse = open * diffuse_factor(finish, lit_cosine, surface.pigment) / attenuation * color;

        const bool uncut = on(On::highlight_uncut) || on(On::highlight_unlit_side) || on(On::diffuse_two_sided);
        const bool unshadowed = on(On::highlight_in_shadow) || on(On::highlight_unlit_side);
        C specular{};
        if (finish.ks > 0 && (faces || (uncut && there)) && (open > 0 || unshadowed)) {
            const Real strength = (unshadowed ? Real(1) : open) * static_cast<Real>(finish.ks) *
                                  highlight(surface, normal, scale, to_lamp, scale * cosine) /
                                  (on(On::highlight_without_attenuation) ? Real(1) : attenuation);
            specular = strength * (on(On::highlight_white) ? C{1, 1, 1} : color);
            if (on(On::highlight_tinted)) {
                specular = specular * surface.pigment;
            }
            if (on(On::highlight_times_cosine)) {
                specular = std::max(cosine, Real(0)) * specular;
            }
        }
        if (on(On::clamped_per_lamp)) {
            const C sum = clamped(diffuse + specular);
            specular = sum - diffuse;
        }
        if (record) {
            record->light(index, number_of(i), double(cosine), double(attenuation), blocker, diffuse, specular);
        }
        return diffuse + specular;
    }

    C diffuse_factor(const Finish& finish, Real cosine, C pigment) const {
        if (on(On::diffuse_missing)) {
            return {};
        }
        const Real factor = on(On::diffuse_without_cosine) ? Real(cosine > 0 ? 1 : 0) : cosine;
        return static_cast<Real>(finish.kd) * factor * (on(On::diffuse_without_pigment) ? C{1, 1, 1} : pigment);
    }

    // Phong's max(0, r.v)^alpha, r the mirror direction of the lamp. `scale` is 1 but for vectors of a wrong length.
    Real highlight(const Surface& surface, V normal, Real scale, V to_lamp, Real cosine) const {
        if (on(On::highlight_missing)) {
            return 0;
        }
        const V& viewer = surface.to_viewer;
        Real base;
        if (on(On::blinn)) {
            base = dot(normal, normalize(to_lamp + viewer)) * surface.normal_length;
        } else {
            const V lamp = on(On::lamp_vector_not_unit) ? scale / surface.normal_length * to_lamp : to_lamp;
            const V r = 2 * cosine * surface.normal_length * normal - lamp;
            base = dot(r, viewer) * (on(On::highlight_reflection_wrong) ? Real(-1) : Real(1));
        }
        if (on(On::highlight_two_sided)) {
            base = std::abs(base);
        }
        base = std::max(base, Real(0));
        // A cosine that is rounded above 1 has powers without bounds.
        const bool lengths_right = scale == 1 && !on(On::direction_not_unit);
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
    Real light_through(const Surface& surface, std::size_t lamp, V to_lamp, Real distance, int& blocker) const {
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
        for (int i = 0; i < static_cast<int>(bodies_.size()); ++i) {
            if (on(On::own_side_casts_none) && i == surface.object) {
                continue;
            }
            const double kt = scene_.finishes[std::size_t(scene_.objects[std::size_t(i)].finish)].kt;
            if (kt > 0 && on(On::transparent_casts_none)) {
                continue;
            }
            if (!(meet(bodies_[std::size_t(i)], i, ray, on).t < limit)) {
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

    // ---- Secondary rays ---------------------------------------------------------------------------------------------

    Ray<Real> mirrored(const Ray<Real>& ray, const Surface& surface) const {
        Ray<Real> next = surface.start;
        const V& n = surface.normal;
        next.direction = normalize(ray.direction - 2 * dot(ray.direction, n) * n);
        return next;
    }

    // Snell's law; where it has no answer, the transmitted ray follows the mirror direction.
    Ray<Real> transmitted(const Ray<Real>& ray, const Hit<Real>& hit, const Surface& surface, bool& dark,
                          bool& total) const {
        Ray<Real> next = surface.start;
        next.inside = !hit.inside;
        const V& n = surface.normal;
        const Real cosine = -dot(ray.direction, n);
        const Real eta = eta_of(*surface.finish, hit.inside);
        const Real cosine2 = (1 - eta) * (1 + eta) + eta * cosine * (eta * cosine);
        total = cosine2 < 0;
        if (on(On::ior_ignored) || (total && on(On::total_reflection_straight))) {
            next.direction = ray.direction;
        } else if (total && !on(On::total_reflection_along)) {
            dark = on(On::total_reflection_black);
            return mirrored(ray, surface);
        } else {
            next.direction =
                normalize(eta * ray.direction + (eta * cosine - std::sqrt(std::max(cosine2, Real(0)))) * n);
        }
        return next;
    }

    // The ratio of the index on the ray's side to the one on the other.
    Real eta_of(const Finish& finish, bool inside) const {
        double eta = finish.eta;  // n1/n2
        if (on(On::ior_inverted)) {
            eta = 1 / eta;
        } else if (on(On::ior_is_ratio)) {
            eta = finish.ior;
        } else if (on(On::ior_is_index)) {
            eta = 1 / finish.ior;
        }
        return static_cast<Real>(inside && !on(On::ior_not_inverted_inside) ? 1 / eta : eta);
    }

    // Where the file has a lamp, which may begin with the ambient light here.
    int number_of(std::size_t lamp) const {
        return static_cast<int>(lamp) - (on(On::ambient_is_lamp) && !scene_.ambient_lamp.empty() ? 1 : 0);
    }

    // ---- What the switches make of the scene --------------------------------------------------------------------------

    void set_lights() {
        if (on(On::ambient_from_lamp) && !lamps_.empty()) {
            ambient_ = vector_of<Real>(lamps_.front().color);
        }
        if (on(On::background_black)) {
            background_ = {0, 0, 0};
        } else if (on(On::background_white)) {
            background_ = {1, 1, 1};
        } else if (on(On::background_grey)) {
            background_ = {Real(0.5), Real(0.5), Real(0.5)};
        } else if (on(On::background_lamp) && !lamps_.empty()) {
            background_ = vector_of<Real>(lamps_.front().color);
        }
        if (on(On::first_lamp_only) && lamps_.size() > 1) {
            lamps_.erase(lamps_.begin() + 1, lamps_.end());
        } else if (on(On::last_lamp_missing) && !lamps_.empty()) {
            lamps_.pop_back();
        }
        if (on(On::ambient_is_lamp)) {
            lamps_.insert(lamps_.begin(), scene_.ambient_lamp.begin(), scene_.ambient_lamp.end());
        }
    }

    void set_depth() {
        constexpr On depths[] = {On::depth_0, On::depth_1, On::depth_2, On::depth_3,
                                 On::depth_4, On::depth_5, On::depth_6};
        for (int depth = 0; depth < static_cast<int>(std::size(depths)); ++depth) {
            if (on(depths[depth])) {
                max_depth_ = depth;
                cutoff_ = 0;
            }
        }
        if (on(On::cutoff_lower)) {
            cutoff_ /= 16;
        }
    }

    const Scene& scene_;
    const Switches& on;
    Size size_;
    View<Real> view_;
    std::vector<Lamp> lamps_;
    C ambient_, background_;
    Real cutoff_;
    int max_depth_;
    Real epsilon_;  // fixed distance in which hits are ignored, negative: what a ray starts on is known instead
    std::vector<Body<Real>> bodies_;
};

}  // namespace student
