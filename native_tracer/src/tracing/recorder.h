// Puts what the tracer does into a tree of rays.

#pragma once

#include <cstddef>

#include "tracing/hits.h"
#include "tracing/ray.h"
#include "tracing/ray_tree.h"
#include "tracing/scene.h"
#include "tracing/surface.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

class Recorder {
 public:
    static constexpr bool observes = true;

    explicit Recorder(RayTree& tree) : tree_(tree) {}

    // The group's rays are primary ones, about to be traced.
    template <typename Real>
    void primary(Group<Real>& group) {
        record(group, [](int) { return -1; }, RayKind::primary);
    }

    // `successors` follow from the rays of `group` in the same lanes.
    template <typename Real>
    void spawned(RayKind kind, const Group<Real>& group, Group<Real>& successors) {
        for_each(group, successors.active, [&](int, int index) { successor(index, kind) = Successor::traced; });
        record(successors, [&](int lane) { return group.record[lane]; }, kind);
    }

    template <typename... Arguments>
    void pigment(const Arguments&...) {}

    template <typename Real>
    void surface(const Group<Real>& group, const Scene<Real>& scene, const Hits<Real>& hits,
                 const Surface<Real>& surface) {
        for_each(group, surface.hit, [&](int lane, int index) {
            RayRecord& record = tree_[index];
            record.t = static_cast<double>(hits.t[lane]);
            record.object = hits.object[lane];
            record.plane = scene.shapes.visit(scene.objects[static_cast<std::size_t>(record.object)].shape,
                                              [&](const auto& shape) { return shape.piece(hits.primitive[lane]); });
            record.inside = hits.inside[lane];
            record.point = triple(lane_of(surface.point, lane));
            record.normal = triple(lane_of(surface.outward, lane));
            record.pigment = triple(lane_of(surface.pigment, lane));
        });
    }

    template <typename Real>
    void light(const Group<Real>& group, std::size_t light, const Surface<Real>& surface, Mask<Real> lit,
               Indices<Real> occluder, Lanes<Real> cosine, Lanes<Real> attenuation, const Color<Lanes<Real>>& diffuse,
               const Color<Lanes<Real>>& specular) {
        const Mask<Real> answers = (surface.kd > Lanes<Real>(0)) | (surface.ks > Lanes<Real>(0));
        for_each(group, surface.hit & answers, [&](int lane, int index) {
            LightRecord record{static_cast<int>(light),
                               static_cast<double>(cosine[lane]),
                               static_cast<double>(attenuation[lane]),
                               occluder[lane],
                               {},
                               {}};
            if (lit[lane]) {
                record.diffuse = triple(lane_of(diffuse, lane));
                record.specular = triple(lane_of(specular, lane));
            }
            tree_.add_light(index, record);
        });
    }

    // Of the successors that are `wanted`, those that are not both weighty and shallow are not traced.
    template <typename Real>
    void dropped(const Group<Real>& group, RayKind kind, Mask<Real> wanted, Mask<Real> weighty, Mask<Real> shallow) {
        for_each(group, wanted & ~(weighty & shallow), [&](int lane, int index) {
            successor(index, kind) = weighty[lane] ? Successor::too_deep : Successor::below_cutoff;
        });
    }

    template <typename Real>
    void total_reflection(const Group<Real>& group, Mask<Real> total) {
        for_each(group, total, [&](int, int index) { tree_[index].total_reflection = true; });
    }

    // The rays' colours, without those of their successors.
    template <typename Real>
    void color(const Group<Real>& group, const Color<Lanes<Real>>& color) {
        for_each(group, group.active, [&](int lane, int index) { tree_[index].local = triple(lane_of(color, lane)); });
    }

 private:
    // Calls visit(lane, record) for the group's rays that are among `rays`.
    template <typename Real, typename Visit>
    void for_each(const Group<Real>& group, Mask<Real> rays, Visit visit) {
        for (int lane = 0; lane < lane_count<Real>; ++lane) {
            if (group.active[lane] && rays[lane]) {
                visit(lane, group.record[lane]);
            }
        }
    }

    // Adds a record for each ray of the group; parent_of(lane) is its parent's.
    template <typename Real, typename ParentOf>
    void record(Group<Real>& group, ParentOf parent_of, RayKind kind) {
        group.record = Indices<Real>::gather([&](int lane) {
            if (!group.active[lane]) {
                return -1;
            }
            const int index = tree_.add();
            RayRecord& record = tree_[index];
            record.kind = kind;
            record.parent = parent_of(lane);
            record.depth = group.depth[lane];
            record.weight = static_cast<double>(group.weight[lane]);
            record.origin = triple(lane_of(group.rays.origin, lane));
            record.direction = triple(lane_of(group.rays.direction, lane));
            record.time = static_cast<double>(group.rays.time[lane]);
            return index;
        });
    }

    Successor& successor(int index, RayKind kind) {
        RayRecord& record = tree_[index];
        return kind == RayKind::reflected ? record.reflected : record.transmitted;
    }

    template <typename Real>
    static Triple triple(const Vector<Real>& v) {
        return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
    }

    RayTree& tree_;
};

}  // namespace whitted::WHITTED_ISA
