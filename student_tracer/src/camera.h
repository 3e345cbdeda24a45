// From a pixel to its ray.

#pragma once

#include <cmath>
#include <numbers>

#include "deviations.h"
#include "scene.h"
#include "vector.h"

namespace student {

// A point of the picture that the scene asks for, in pixels from its top left corner.
struct Place {
    double column, row;
};

// A picture's width and height.
struct Size {
    int width, height;
};

// The size of the picture that the scene is drawn in, of which one of the given size is made.
inline Size drawn_size(Size size, const Switches& on) {
    return on(On::transposed) || on(On::header_swapped) ? Size{size.height, size.width} : size;
}

// Which place pixel (x, y) of a picture of that size shows.
inline Place place_of(int x, int y, Size size, const Switches& on) {
    const auto [width, height] = drawn_size(size, on);
    const long long index = static_cast<long long>(y) * size.width + x;
    if (on(On::transposed)) {
        std::swap(x, y);
    } else if (on(On::header_swapped)) {
        x = static_cast<int>(index % width);
        y = static_cast<int>(index / width);
    } else if (on(On::column_major)) {
        x = static_cast<int>(index / height);
        y = static_cast<int>(index % height);
    }
    if (on(On::mirrored)) {
        x = width - 1 - x;
    }
    if (on(On::upside_down)) {
        y = height - 1 - y;
    }
    Place place{double(x), double(y)};
    if (on(On::pixel_center)) {
        place.column += 0.5;
        place.row += 0.5;
    } else if (on(On::pixel_ends)) {
        place.column *= width > 1 ? width / (width - 1.0) : 1;
        place.row *= height > 1 ? height / (height - 1.0) : 1;
    } else {
        place.column += on(On::pixel_top_right) || on(On::pixel_bottom_right) ? 1 : 0;
        place.row += on(On::pixel_bottom_left) || on(On::pixel_bottom_right) ? 1 : 0;
    }
    return place;
}

// The camera, made ready for a picture of that size: the directions of its rays.
template <typename Real>
class View {
 public:
    View(const Camera& camera, Size size, const Switches& on)
        : width_(static_cast<Real>(size.width)), height_(static_cast<Real>(size.height)) {
        const Vector<Real> eye = vector_of<Real>(camera.eye);
        const Vector<Real> look_at = vector_of<Real>(camera.look_at);
        Vector<Real> up = vector_of<Real>(camera.up);
        if (on(On::up_is_point)) {
            up = up - eye;
        } else if (on(On::up_ignored)) {
            up = {0, 1, 0};
        }
        forward_ = on(On::look_at_is_direction) ? look_at : look_at - eye;
        if (!on(On::view_not_unit)) {
            forward_ = normalize(forward_);
        }
        right_ = on(On::left_handed) ? cross(up, forward_) : cross(forward_, up);
        if (!on(On::right_not_unit)) {
            right_ = normalize(right_);
        }
        up_ = on(On::left_handed) ? cross(forward_, right_) : cross(right_, forward_);
        if (on(On::up_not_orthogonal)) {
            up_ = normalize(up);
        } else if (on(On::view_not_unit)) {
            up_ = normalize(up_);
        }
        if (on(On::window_upside_down)) {
            up_ = -up_;
        }
        set_scale(static_cast<Real>(camera.fovy), on);
    }

    // Not normalized.
    Vector<Real> direction(const Place& place) const {
        const Real x = (2 * static_cast<Real>(place.column) - width_) * x_scale_;
        const Real y = (height_ - 2 * static_cast<Real>(place.row)) * y_scale_;
        return forward_ + x * right_ + y * up_;
    }

 private:
    void set_scale(Real fovy, const Switches& on) {
        const Real angle = fovy * std::numbers::pi_v<Real> / 360;  // half of it, in radians
        Real half = std::tan(angle);                               // of the window's height, at distance 1
        if (on(On::fovy_whole)) {
            half = std::tan(2 * angle);
        } else if (on(On::fovy_quarter)) {
            half = std::tan(angle / 2);
        } else if (on(On::window_half)) {
            half = half / 2;
        } else if (on(On::fovy_radians)) {
            half = std::tan(fovy / 2);
        } else if (on(On::fovy_sin)) {
            half = std::sin(angle);
        } else if (on(On::fovy_arc)) {
            half = angle;
        }
        x_scale_ = y_scale_ = half / height_;
        if (on(On::fovy_horizontal)) {
            x_scale_ = y_scale_ = half / width_;
        } else if (on(On::aspect_ignored)) {
            x_scale_ = half / width_;
        } else if (on(On::aspect_inverted)) {
            x_scale_ = half * height_ / (width_ * width_);
        }
    }

    Vector<Real> forward_, right_, up_;
    Real width_, height_;
    Real x_scale_, y_scale_;  // half a pixel, at distance 1
};

}  // namespace student
