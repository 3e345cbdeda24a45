// Whitted's recursive shading, with the recursion turned into a stack of pending rays.
//
//     colour = ka ambient C
//            + sum over lights in sight with n.l > 0 of  light / (a + b d + c d^2) (kd C (n.l) + ks highlight^alpha)
//            + kr colour(reflected ray) + kt colour(transmitted ray)
//
// A pixel is a sum over its tree of rays: each adds its local colour, times its weight, the product of the kr and kt on
// the way to it. So a ray needs nothing from its successors, and may be traced whenever it suits: rays wait on a stack
// and are taken from it in batches, whatever pixel they belong to, so that all lanes of a register are busy. The stack
// stays short however large the trees are, for the deepest rays lie on top.
//
// Whitted, "An Improved Illumination Model for Shaded Display", Communications of the ACM 23(6), 1980.

#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "tracing/description.h"
#include "tracing/hits.h"
#include "tracing/light.h"
#include "tracing/nearest_hit.h"
#include "tracing/observer.h"
#include "tracing/occlusion.h"
#include "tracing/pigment.h"
#include "tracing/ray.h"
#include "tracing/ray_tree.h"
#include "tracing/rounding.h"
#include "tracing/sampler.h"
#include "tracing/scene.h"
#include "tracing/surface.h"
#include "tracing/turn.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real, typename Observer>
class Tracer {
 public:
    using L = Lanes<Real>;
    // The rays of a pixel are summed in double at least.
    using Sum = std::conditional_t<std::is_same_v<Real, long double>, long double, double>;

    Tracer(const Scene<Real>& scene, const RenderSettings& settings, Observer& observer)
        : scene_(scene),
          observer_(observer),
          cutoff_(static_cast<Real>(settings.cutoff)),
          max_depth_(settings.max_depth),
          blinn_(settings.blinn),
          seed_(settings.seed),
          independent_(settings.independent),
          reflected_(scene.sampled),
          transmitted_(scene.sampled),
          batch_(scene.sampled) {}

    // Traces `primary_rays` with all that follow from them, and adds their colours to sums[pixel]. Returns false if it
    // was stopped before the end.
    template <typename PrimaryRays>
    bool trace(PrimaryRays primary_rays, Color<Sum>* sums, RayCounts& counts, const std::atomic<bool>& stop);

    // Whether the depth limit dropped a ray of a pixel that was traced last.
    bool too_deep(std::size_t pixel) const { return pixel < pixels_.size() && pixels_[pixel].too_deep; }

 private:
    // The batch, not the number of lanes, decides which rays are traced next, so that the rays of a pixel are summed in
    // the same order on every processor.
    static constexpr std::size_t batch_size = 64;

    struct PixelState {
        bool too_deep = false;
    };

    void trace_group(const Group<Real>& group, const View<Real>* view = nullptr);
    void set_time(Group<Real>& group) const;
    PlanePoint<Real> sample(const Group<Real>& group, std::uint32_t use) const;
    PlanePoint<Real> sample(const Group<Real>& group, Indices<Real> path, std::uint32_t use) const;
    Vector<L> to_disc(const Group<Real>& group, std::size_t light, const Vector<L>& center, L& error) const;
    Color<L> local_color(const Group<Real>& group, const Hits<Real>& hits, const Surface<Real>& surface);
    L highlight(const Rays<Real>& rays, const Hits<Real>& hits, const Surface<Real>& surface, const Vector<L>& to_light,
                L cosine, Mask<Real> wanted) const;
    void follow(const Group<Real>& group, const Hits<Real>& hits, const Surface<Real>& surface);
    [[gnu::noinline]] void spread_out(const Group<Real>& group, const Hits<Real>& hits, const Surface<Real>& surface,
                                      std::uint32_t use, Turn<Real>& turn) const;
    Mask<Real> worthwhile(const Group<Real>& group, RayKind kind, Mask<Real> hit, L weight);

    const Scene<Real>& scene_;
    Observer& observer_;
    const Real cutoff_;
    const int max_depth_;
    const bool blinn_;
    const std::uint32_t seed_;
    const bool independent_;

    // Successors of the rays that are traced, and those that are traced. Kinds wait apart: in which order rays are
    // traced must not depend on the number of lanes.
    RayStack<Real> reflected_, transmitted_, batch_;
    Color<Sum>* sums_ = nullptr;
    RayCounts* counts_ = nullptr;
    std::vector<PixelKey> pixel_keys_;  // in scenes that are sampled
    std::vector<PixelState> pixels_;    // up to the last one of which the depth limit dropped a ray
};

template <typename Real, typename Observer>
template <typename PrimaryRays>
bool Tracer<Real, Observer>::trace(PrimaryRays primary_rays, Color<Sum>* sums, RayCounts& counts,
                                   const std::atomic<bool>& stop) {
    sums_ = sums;
    counts_ = &counts;
    reflected_.clear();
    transmitted_.clear();
    pixels_.clear();
    if (scene_.sampled) {
        primary_rays.fill_pixel_keys(seed_, pixel_keys_);
    }
    while (!stop.load(std::memory_order_relaxed)) {
        if (reflected_.size() + transmitted_.size() < batch_size && !primary_rays.done()) {
            // Whole blocks of pixels, for where one is cut depends on the number of lanes.
            std::size_t traced = 0;
            do {
                Group<Real> group = primary_rays.next();
                set_time(group);
                if (primary_rays.have_lens()) [[unlikely]] {
                    const PlanePoint<Real> square = sample(group, use::lens);
                    primary_rays.move_to_lens(group, disc_point(square.x, square.y));
                }
                observer_.primary(group);
                trace_group(group, &scene_.eye_view);
                traced += static_cast<std::size_t>(count(group.active));
            } while (!primary_rays.done() && (traced < batch_size || !primary_rays.begins_block()));
            counts.primary += traced;
        } else if (reflected_.size() + transmitted_.size() > 0) {
            batch_.clear();
            reflected_.move_last(batch_size, batch_);
            transmitted_.move_last(batch_size - batch_.size(), batch_);
            for (std::size_t first = 0; first < batch_.size(); first += lane_count<Real>) {
                Group<Real> group = batch_.group(first);
                set_time(group);
                trace_group(group);
            }
        } else {
            counts.pixels_too_deep += static_cast<std::uint64_t>(
                std::count_if(pixels_.begin(), pixels_.end(), [](const PixelState& pixel) { return pixel.too_deep; }));
            return true;
        }
    }
    return false;
}

// Traces a ray in each lane, and leaves those that follow from them on the stack.
template <typename Real, typename Observer>
void Tracer<Real, Observer>::trace_group(const Group<Real>& group, const View<Real>* view) {
    const Hits<Real> hits = nearest_hit(scene_, group.rays, group.active, view);
    Color<L> color(scene_.background);
    if (any(group.active & (hits.object >= 0))) {
        const Surface<Real> surface = surface_at(scene_, group.rays, hits, observer_);
        observer_.surface(group, scene_, hits, surface);
        color = select(surface.hit, local_color(group, hits, surface), color);
        follow(group, hits, surface);
    }
    observer_.color(group, color);
    const Color<L> weighted = group.weight * color;
    for (unsigned lanes = group.active.bits(); lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes);
        sums_[group.pixel[lane]] += Color<Sum>(lane_of(weighted, lane));
    }
}

// A ray has the time of the primary ray that it follows from.
template <typename Real, typename Observer>
void Tracer<Real, Observer>::set_time(Group<Real>& group) const {
    if (scene_.moves) [[unlikely]] {
        group.rays.time = sample(group, Indices<Real>(static_cast<int>(primary_path)), use::time).x;
    }
}

// ---- Local colour -------------------------------------------------------------------------------------------------

template <typename Real, typename Observer>
auto Tracer<Real, Observer>::local_color(const Group<Real>& group, const Hits<Real>& hits, const Surface<Real>& surface)
    -> Color<L> {
    const L zero = Real(0);
    const L one = Real(1);
    Color<L> color = surface.ka * Color<L>(scene_.ambient) * surface.pigment;
    const Mask<Real> answers = group.active & surface.hit & ((surface.kd > zero) | (surface.ks > zero));
    if (!any(answers)) {
        return color;
    }
    // Shadow rays start on the viewer's side of the surface, as the reflected ray does.
    const L reach = max_norm(surface.point);
    Rays<Real> shadow_rays{surface.point, surface.normal,        surface.error, hits.object,    hits.primitive,
                           hits.inside,   L(least_spread<Real>), reach,         group.rays.time};
    const L point_error = L(8 * tie_epsilon<Real>) * reach;
    for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
        const Light<Real>& light = scene_.lights[i];
        Vector<L> path = Vector<L>(light.position) - surface.point;
        L error = surface.error;
        if (!light.is_point()) [[unlikely]] {
            path = to_disc(group, i, path, error);
        }
        const L distance = length(path);
        const L nearness = one / distance;
        const Vector<L> to_light = path * nearness;
        const L cosine = dot(surface.normal, to_light);
        // A surface is not lit along itself, nor by a light at the very point.
        const Mask<Real> faces =
            answers & (cosine > L(least_spread<Real>)) & (distance > point_error) & ~light.grazes(hits.primitive);

        Indices<Real> occluder = -1;
        if (any(faces)) {
            counts_->shadow += static_cast<std::uint64_t>(count(faces));
            shadow_rays.direction = to_light;
            // It leads to the light from wherever the point really is.
            shadow_rays.spread = min(L(least_spread<Real>) + error * nearness, L(most_blur<Real>));
            occluder = find_occluder(scene_, shadow_rays, light, distance, faces);
        }
        const Mask<Real> lit = faces & (occluder < 0);
        if (!Observer::observes && !any(lit)) {
            continue;
        }
        const L attenuation = L(light.a) + L(light.b) * distance + L(light.c) * distance * distance;
        const Color<L> intensity = Color<L>(light.color) * (one / attenuation);
        const Color<L> diffuse = surface.kd * cosine * surface.pigment * intensity;
        color = select(lit, color + diffuse, color);
        const Mask<Real> shines = lit & (surface.ks > zero);
        Color<L> specular{zero, zero, zero};
        if (any(shines)) {
            specular = surface.ks * highlight(group.rays, hits, surface, to_light, cosine, shines) * intensity;
            color = select(shines, color + specular, color);
        }
        observer_.light(group, i, surface, lit, occluder, cosine, attenuation, diffuse, specular);
    }
    return color;
}

// The rays' points of the unit square for one use.
template <typename Real, typename Observer>
PlanePoint<Real> Tracer<Real, Observer>::sample(const Group<Real>& group, std::uint32_t use) const {
    return sample(group, group.path, use);
}

// Those of the rays with such paths in the trees of a group's rays.
template <typename Real, typename Observer>
PlanePoint<Real> Tracer<Real, Observer>::sample(const Group<Real>& group, Indices<Real> path, std::uint32_t use) const {
    SampleNames<Real> names{};
    for (unsigned lanes = group.active.bits(); lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes);
        const auto at = static_cast<std::size_t>(lane);
        names.pixel_key[at] = pixel_keys_[static_cast<std::size_t>(group.pixel[lane])].value;
        names.number[at] = static_cast<std::uint32_t>(group.sample[lane]);
        names.path[at] = static_cast<std::uint32_t>(path[lane]);
        if (independent_) [[unlikely]] {
            make_independent(names.pixel_key[at], names.number[at]);
        }
    }
    return square_point(names, use);
}

// From a point to a point of a light, given the way to its centre: the disc lies across that way, and turns with it
// where the point is off. `error` is how far that may be, and becomes how far both ends may be off.
template <typename Real, typename Observer>
[[gnu::noinline]] auto Tracer<Real, Observer>::to_disc(const Group<Real>& group, std::size_t light,
                                                       const Vector<L>& center, L& error) const -> Vector<L> {
    const PlanePoint<Real> square = sample(group, use::first_light + static_cast<std::uint32_t>(light));
    const PlanePoint<Real> point = disc_point(square.x, square.y);
    const L nearness = L(1) / length(center);
    const Frame<Real> frame(center * nearness);
    const L radius = scene_.lights[light].radius;
    error = error + radius * (error * nearness + L(8 * tie_epsilon<Real>)) + L(scene_.lights[light].error);
    return center + (radius * point.x) * frame.tangent + (radius * point.y) * frame.bitangent;
}

// Phong's max(0, r.v)^alpha or Blinn's max(0, n.h)^alpha, for the rays in `wanted`.
template <typename Real, typename Observer>
auto Tracer<Real, Observer>::highlight(const Rays<Real>& rays, const Hits<Real>& hits, const Surface<Real>& surface,
                                       const Vector<L>& to_light, L cosine, Mask<Real> wanted) const -> L {
    const Vector<L> to_viewer = -rays.direction;
    const L base = blinn_ ? dot(surface.normal, normalize(to_light + to_viewer))
                          : dot(L(2) * cosine * surface.normal - to_light, to_viewer);
    L result = Real(0);
    for_each_distinct(hits.primitive, wanted, [&](int, int lane, Mask<Real> same) {
        // A cosine that is rounded above 1 has powers without bounds.
        result = select(same, power(min(max(base, L(Real(0))), L(Real(1))), surface.alpha[lane]), result);
    });
    return result;
}

// ---- Successors ---------------------------------------------------------------------------------------------------

template <typename Real, typename Observer>
void Tracer<Real, Observer>::follow(const Group<Real>& group, const Hits<Real>& hits, const Surface<Real>& surface) {
    const Mask<Real> hit = group.active & surface.hit;
    const L reflected_weight = group.weight * surface.kr;
    const L transmitted_weight = group.weight * surface.kt;
    const Mask<Real> reflects = worthwhile(group, RayKind::reflected, hit, reflected_weight);
    const Mask<Real> transmits = worthwhile(group, RayKind::transmitted, hit, transmitted_weight);
    if (!any(reflects | transmits)) {
        return;
    }
    // Both kinds start where the ray has hit, and differ in the rest.
    Group<Real> successors;
    successors.rays.origin = surface.point;
    successors.rays.t_min = surface.error;
    successors.rays.time = group.rays.time;
    successors.rays.object = hits.object;
    successors.rays.primitive = hits.primitive;
    successors.depth = group.depth + Indices<Real>(1);
    successors.pixel = group.pixel;
    successors.record = group.record;
    const auto push = [&](RayKind kind, Turn<Real> turn, L weight, Mask<Real> followed, RayStack<Real>& stack,
                          std::uint64_t& counter) {
        if (scene_.spreads) [[unlikely]] {
            const std::uint32_t use = kind == RayKind::reflected ? use::mirrored_cone : use::refracted_cone;
            spread_out(group, hits, surface, use, turn);
        }
        successors.rays.direction = turn.direction;
        successors.rays.spread = turn.spread;
        successors.rays.inside = turn.inside;
        successors.weight = weight;
        successors.active = followed;
        if (scene_.sampled) {
            successors.sample = group.sample;
            successors.path = Indices<Real>::gather([&](int lane) {
                const auto path = static_cast<std::uint32_t>(group.path[lane]);
                return static_cast<int>(kind == RayKind::reflected ? mirrored_path(path) : transmitted_path(path));
            });
        }
        observer_.spawned(kind, group, successors);
        stack.push(successors, followed);
        counter += static_cast<std::uint64_t>(count(followed));
    };
    const L cosine = -dot(group.rays.direction, surface.normal);
    const Turn<Real> mirrored = mirror(group.rays, hits, surface, cosine);
    if (any(reflects)) {
        push(RayKind::reflected, mirrored, reflected_weight, reflects, reflected_, counts_->reflected);
    }
    if (any(transmits)) {
        Mask<Real> total;
        const Turn<Real> refracted = refract(group.rays, hits, surface, cosine, mirrored, total);
        observer_.total_reflection(group, transmits & total);
        push(RayKind::transmitted, refracted, transmitted_weight, transmits, transmitted_, counts_->transmitted);
    }
    for_each_distinct(successors.depth, reflects | transmits,
                      [&](int depth, int, Mask<Real>) { counts_->deepest = std::max(counts_->deepest, depth); });
}

// Where the finish has a cone.
template <typename Real, typename Observer>
void Tracer<Real, Observer>::spread_out(const Group<Real>& group, const Hits<Real>& hits, const Surface<Real>& surface,
                                        std::uint32_t use, Turn<Real>& turn) const {
    const L versine = L::gather([&](int lane) {
        return hits.object[lane] < 0 ? Real(0)
                                     : scene_.objects[static_cast<std::size_t>(hits.object[lane])].finish.versine;
    });
    if (any(versine > L(Real(0)))) {
        spread_in_cone(surface, versine, sample(group, use), turn);
    }
}

// Which of the rays that would follow, with the given weights, are traced.
template <typename Real, typename Observer>
Mask<Real> Tracer<Real, Observer>::worthwhile(const Group<Real>& group, RayKind kind, Mask<Real> hit, L weight) {
    const Mask<Real> wanted = hit & (weight > L(0));
    if (!any(wanted)) {
        return wanted;
    }
    const Mask<Real> weighty = weight >= L(cutoff_);
    const Mask<Real> shallow = group.depth < Indices<Real>(max_depth_);
    observer_.dropped(group, kind, wanted, weighty, shallow);
    const Mask<Real> too_deep = wanted & weighty & ~shallow;
    if (any(too_deep)) [[unlikely]] {
        for (unsigned lanes = too_deep.bits(); lanes != 0; lanes &= lanes - 1) {
            const auto pixel = static_cast<std::size_t>(group.pixel[std::countr_zero(lanes)]);
            if (pixel >= pixels_.size()) {
                pixels_.resize(pixel + 1);
            }
            pixels_[pixel].too_deep = true;
        }
    }
    return wanted & weighty & shallow;
}

}  // namespace whitted::WHITTED_ISA
