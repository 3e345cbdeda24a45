// The camera: a pinhole, or a thin lens.

#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tracing/description.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/sampler.h"
#include "tracing/triple.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

//     forward = normalize(look_at - eye), right = normalize(forward x up), up' = right x forward
//
// The file's `up` is a vector that only has to lie on the right side; up' is orthogonal to the view direction.
template <typename Real>
class Camera {
 public:
    Camera(const CameraDescription& camera, int width, int height)
        : eye_(vector_of<Real>(camera.eye)),
          eye_error_(input_error_of_point<Real>(camera.eye)),
          spread_(least_spread<Real> + (eye_error_ + input_error_of_point<Real>(camera.look_at)) /
                                           length(vector_of<Real>(direction(camera.eye, camera.look_at)))),
          forward_(normalize(vector_of<Real>(in_range(direction(camera.eye, camera.look_at))))),
          right_(normalize(cross(forward_, vector_of<Real>(in_range(camera.up))))),
          up_(cross(right_, forward_)),
          width_(static_cast<Real>(width)),
          height_(static_cast<Real>(height)),
          scale_(std::tan(static_cast<Real>(camera.fovy) * std::numbers::pi_v<Real> / 360) / height_),
          aperture_(static_cast<Real>(camera.aperture)),
          lens_(static_cast<Real>(camera.aperture / std::max(camera.aperture, camera.focal))),
          focal_(static_cast<Real>(camera.focal / std::max(camera.aperture, camera.focal))) {}

    const Vector<Real>& eye() const { return eye_; }

    // How far the eye and directions may be off, see rounding.h.
    Real eye_error() const { return eye_error_; }
    Real spread() const { return std::min(spread_, most_camera_blur<Real>); }

    // Unit directions through points of the picture, in pixels from its top-left corner. On the plane at distance 1 the
    // window is 2 tan(fovy/2) high, and as wide as square pixels make it.
    Vector<Lanes<Real>> directions(Lanes<Real> column, Lanes<Real> row) const {
        using L = Lanes<Real>;
        const L x = (L(2) * column - L(width_)) * L(scale_);
        const L y = (L(height_) - L(2) * row) * L(scale_);
        return normalize(Vector<L>(forward_) + x * Vector<L>(right_) + y * Vector<L>(up_));
    }

    bool has_lens() const { return aperture_ > 0; }

    // Moves rays from the eye to points of the lens, given on the unit disc: they meet where they would on the plane in
    // focus.
    void move_to_lens(Rays<Real>& rays, const PlanePoint<Real>& point) const {
        using L = Lanes<Real>;
        const Vector<L> across = point.x * Vector<L>(right_) + point.y * Vector<L>(up_);
        const L cosine = dot(rays.direction, Vector<L>(forward_));
        rays.origin = rays.origin + L(aperture_) * across;
        rays.direction = normalize(L(focal_) * rays.direction - (cosine * L(lens_)) * across);
        rays.reach = max_norm(rays.origin);
        rays.t_min = L(eye_error_) + L(8 * tie_epsilon<Real>) * (rays.reach + L(aperture_));
        // The nearer the plane in focus, in radii of the lens, the more a direction changes with its two ends.
        rays.spread = min(L(4 * spread_ / focal_), L(most_camera_blur<Real>));
    }

 private:
    Vector<Real> eye_;
    Real eye_error_, spread_;
    Vector<Real> forward_, right_, up_;
    Real width_, height_;
    Real scale_;  // half a pixel, on the plane at distance 1
    Real aperture_;
    Real lens_, focal_;  // the lens's radius and the distance of what is in focus, over the larger of the two
};

}  // namespace whitted::WHITTED_ISA
