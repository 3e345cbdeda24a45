// Signs pixels: a word that tells what has been decided along a pixel's rays.
//
// Neighbouring pixels whose rays take the same way, meet the same pieces of surface and of pigment and are shadowed by
// the same lights have the same signature, and nearly always others have another. It is a sum over the tree of rays, so
// it does not matter in which order they are traced, and Mitsuba's integrator has the same,
// mitsuba_plugins/integrators/signature.py.

#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "tracing/hits.h"
#include "tracing/pigment.h"
#include "tracing/ray.h"
#include "tracing/ray_tree.h"
#include "tracing/sampler.h"
#include "tracing/scene.h"
#include "tracing/surface.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
class Signer {
 public:
    static constexpr bool observes = true;

    // Adds to signatures[pixel] what rays decide that weigh at least so much: what the others send back changes a
    // colour little, whatever it is.
    Signer(std::uint32_t* signatures, double least_weight)
        : signatures_(signatures), least_weight_(static_cast<Real>(least_weight)) {}

    // What a ray is known by is its path, see sampler.h.
    void primary(Group<Real>& group) { group.record = static_cast<int>(primary_path); }

    void spawned(RayKind kind, const Group<Real>& group, Group<Real>& successors) {
        successors.record = Indices<Real>::gather([&](int lane) {
            const std::uint32_t path = path_of(group, lane);
            return static_cast<int>(kind == RayKind::reflected ? mirrored_path(path) : transmitted_path(path));
        });
    }

    // The pigment that the lanes in `which` have met.
    void pigment(const Pigment<Real>& pigment, const Meeting<Real>& met, Mask<Real> which) {
        for (unsigned lanes = which.bits(); lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            cells_[lane] = cell_word(pigment, met, lane);
        }
    }

    void surface(const Group<Real>& group, const Scene<Real>& scene, const Hits<Real>& hits,
                 const Surface<Real>& surface) {
        for_each(group, surface.hit & (group.weight >= least_weight_), [&](int lane) {
            const int object = hits.object[lane];
            const int piece = scene.shapes.visit(scene.objects[static_cast<std::size_t>(object)].shape,
                                                 [&](const auto& shape) { return shape.piece(hits.primitive[lane]); });
            const std::uint32_t side = 2 * static_cast<std::uint32_t>(std::max(piece, 0)) + (hits.inside[lane] ? 1 : 0);
            const std::uint32_t met = combine(path_of(group, lane), static_cast<std::uint32_t>(object));
            return combine(combine(met, side), cells_[lane]);
        });
    }

    template <typename... Arguments>
    void light(const Group<Real>& group, std::size_t light, const Surface<Real>& surface, Mask<Real>,
               Indices<Real> occluder, const Arguments&...) {
        const Mask<Real> matters = group.weight * (surface.kd + surface.ks) >= least_weight_;
        for_each(group, surface.hit & matters & (occluder >= Indices<Real>(0)),
                 [&](int lane) { return combine(path_of(group, lane), ~static_cast<std::uint32_t>(light)); });
    }

    template <typename... Arguments>
    void dropped(const Arguments&...) {}
    template <typename... Arguments>
    void total_reflection(const Arguments&...) {}  // other rays follow
    template <typename... Arguments>
    void color(const Arguments&...) {}

 private:
    static std::uint32_t path_of(const Group<Real>& group, int lane) {
        return static_cast<std::uint32_t>(group.record[lane]);
    }

    // Adds word_of(lane) for the group's rays that are among `rays`.
    template <typename WordOf>
    void for_each(const Group<Real>& group, Mask<Real> rays, WordOf word_of) {
        for (unsigned lanes = (group.active & rays).bits(); lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            signatures_[group.pixel[lane]] += word_of(lane);
        }
    }

    std::uint32_t* signatures_;
    const Lanes<Real> least_weight_;
    std::uint32_t cells_[static_cast<std::size_t>(lane_count<Real>)] = {};
};

}  // namespace whitted::WHITTED_ISA
