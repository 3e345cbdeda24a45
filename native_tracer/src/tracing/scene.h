// What rays meet: a scene, prepared for one precision. traversal.h says where they cross it, nearest_hit.h what they
// hit first, and occlusion.h what is in their way to a light.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <variant>
#include <vector>

#include "search/search.h"
#include "shapes/contact.h"
#include "shapes/shape_lists.h"
#include "shapes/shapes.h"
#include "tracing/description.h"
#include "tracing/light.h"
#include "tracing/pigment.h"
#include "tracing/rounding.h"
#include "tracing/tree.h"
#include "tracing/triple.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct Finish {
    Real ka, kd, ks, alpha, kr, kt;
    Real eta;      // n1/n2, outside over inside
    Real versine;  // 1 - cos of half the angle of the cone in which rays are spread
};

template <typename Real>
struct Object {
    Finish<Real> finish;
    const Pigment<Real>* pigment;
    int first_primitive;
    ShapeIndex shape;
    bool moves = false;
};

template <typename Real>
struct Scene {
    Color<Real> ambient, background;
    bool sampled = false;  // something is random
    bool moves = false;    // rays have a time
    bool spreads = false;  // some finish spreads rays
    View<Real> eye_view;
    EyeContact<Real> eye_contact;  // of a camera without a lens
    std::vector<Light<Real>> lights;
    std::vector<Pigment<Real>> pigments;
    std::vector<Object<Real>> objects;
    // Those outside the tree come first, the rest in the order of its leaves.
    Shapes<Real> shapes;
    typename Shapes<Real>::Ranges apart;
    Tree<Real> tree;

    Scene(const SceneDescription& description, const SearchPlan& plan);
    Scene(const Scene&) = delete;  // objects point to pigments

 private:
    void add_objects(const SceneDescription& description);
    void add_shapes(const SceneDescription& description, const SearchPlan& plan);
    void add_eye(const SceneDescription& description);
    void add_light(const SceneDescription& description, const LightDescription& light);
    std::vector<Contact<Real>> contacts_of(const SceneDescription& description, const Triple& point) const;
};

// ---- Preparation --------------------------------------------------------------------------------------------------

template <typename Real>
Scene<Real>::Scene(const SceneDescription& description, const SearchPlan& plan)
    : ambient(vector_of<Real>(description.ambient)), background(vector_of<Real>(description.background)), tree(plan) {
    for (const PigmentDescription& pigment : description.pigments) {
        pigments.push_back(pigment_of<Real>(pigment));
    }
    add_objects(description);
    add_shapes(description, plan);
    sampled |= moves;
    add_eye(description);
    for (const LightDescription& light : description.lights) {
        add_light(description, light);
    }
}

template <typename Real>
void Scene<Real>::add_objects(const SceneDescription& description) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    objects.reserve(description.objects.size());
    int primitive = 0;
    for (const ObjectDescription& object : description.objects) {
        const FinishDescription& f = description.finishes[static_cast<std::size_t>(object.finish)];
        const double sine = std::sin(f.cone * std::numbers::pi / 360);
        objects.push_back({{real(f.ka), real(f.kd), real(f.ks), real(f.alpha), real(f.kr), real(f.kt), real(f.eta),
                            real(2 * sine * sine)},
                           &pigments[static_cast<std::size_t>(object.pigment)],
                           primitive,
                           {}});
        primitive += Shapes<Real>::primitive_count(object.shape);
        spreads |= f.cone > 0;
    }
    sampled |= spreads;
}

// Primitives are numbered in the order of the file, shapes are kept in that of the search.
template <typename Real>
void Scene<Real>::add_shapes(const SceneDescription& description, const SearchPlan& plan) {
    const auto add = [&](int number) {
        const auto index = static_cast<std::size_t>(number);
        Object<Real>& object = objects[index];
        const ShapeDescription& shape = description.objects[index].shape;
        object.shape = shapes.add(shape, number, object.first_primitive);
        object.moves = std::get_if<MovingDescription>(&shape) != nullptr;
        moves |= object.moves;
    };
    for (const int object : plan.apart) {
        add(object);
    }
    apart = shapes.added_behind({});
    typename Shapes<Real>::Ranges last = apart;
    for (std::size_t i = 0; i < plan.tree.nodes.size(); ++i) {
        const BvhNode& node = plan.tree.nodes[i];
        if (node.children == 0) {
            for (std::size_t k = node.first; k < node.first + node.count; ++k) {
                add(static_cast<int>(plan.tree.order[k]));
            }
            last = shapes.added_behind(last);
            tree.put_leaf(i, last);
        }
    }
    tree.finish(plan, [&](std::uint32_t item) { return objects[item].shape; });
}

template <typename Real>
void Scene<Real>::add_eye(const SceneDescription& description) {
    const Triple& eye = description.camera.eye;
    eye_view = shapes.view_from(apart, vector_of<Real>(eye), static_cast<Real>(description.camera.aperture));
    if (description.camera.aperture > 0) {
        sampled = true;
        return;
    }
    for (const Contact<Real>& contact : contacts_of(description, eye)) {
        if (eye_contact.object < 0 && contact.on_body) {
            eye_contact.object = contact.object;
            eye_contact.primitive = contact.primitive;
            eye_contact.body = contact.body;
            eye_contact.curvature = contact.curvature;
            eye_contact.turn = contact.turn;
        }
        if (contact.body >= 0 && contact.body == eye_contact.body) {
            eye_contact.outward.push_back(contact.outward);
        }
    }
}

template <typename Real>
void Scene<Real>::add_light(const SceneDescription& description, const LightDescription& light) {
    const Vector<Real> position = vector_of<Real>(light.position);
    const Color<Real> fading = vector_of<Real>(light.attenuation);
    const bool point = light.radius == 0;
    lights.push_back(
        {position, vector_of<Real>(light.color), fading.x, fading.y, fading.z, static_cast<Real>(light.radius),
         8 * tie_epsilon<Real> * std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)}),
         shapes.view_from(apart, position, static_cast<Real>(light.radius)),
         point ? contacts_of(description, light.position) : std::vector<Contact<Real>>{}});
    for (const Object<Real>& object : objects) {
        lights.back().outside.push_back(shapes.visit(object.shape, [&](const auto& shape) {
            if constexpr (requires { shape.distance_outside(position); }) {
                return shape.distance_outside(position) - lights.back().radius;
            } else {
                return Real(0);
            }
        }));
    }
    sampled |= !point;
}

template <typename Real>
std::vector<Contact<Real>> Scene<Real>::contacts_of(const SceneDescription& description, const Triple& point) const {
    std::vector<Contact<Real>> contacts;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        shapes.visit(objects[i].shape, description.objects[i].shape, [&](const auto& shape, const auto& described) {
            shape.for_each_contact(described, point,
                                   [&](const Contact<Real>& contact) { contacts.push_back(contact); });
        });
    }
    return contacts;
}

}  // namespace whitted::WHITTED_ISA
