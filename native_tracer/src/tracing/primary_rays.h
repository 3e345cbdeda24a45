// The rays that leave the eye.

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shapes/contact.h"
#include "tracing/camera.h"
#include "tracing/description.h"
#include "tracing/kernel.h"
#include "tracing/ray.h"
#include "tracing/sampler.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// The rays of a rectangle of pixels: row by row, in each some or all places of a grid of grid x grid rays a pixel, one
// place of it after the other.
template <typename Real>
class PrimaryRays {
 public:
    PrimaryRays(const Camera<Real>& camera, const EyeContact<Real>& contact, const RenderSettings& settings,
                const Tile& tile, const Places* places = nullptr, const unsigned char* mask = nullptr)
        : camera_(camera),
          contact_(contact),
          tile_(tile),
          grid_(settings.grid),
          places_(places),
          samples_(places ? static_cast<int>(places->size()) : grid_ * grid_),
          shift_(settings.corner ? Real(0.5) : Real(0)),
          reach_(max_norm(Vector<Lanes<Real>>(camera.eye()))),
          mask_(mask),
          part_(settings.part),
          count_(tile.right - tile.left),
          row_(tile.top) {
        if (mask_ != nullptr) {
            find_pixels();
        }
    }

    bool done() const { return row_ == tile_.bottom; }
    bool begins_row() const { return index_ == 0 && sample_ == 0; }

    // The key of each pixel's samples, see sampler.h, in the order of their numbers.
    void fill_pixel_keys(std::uint32_t seed, std::vector<PixelKey>& keys) const {
        keys.clear();
        for (int row = tile_.top; row < tile_.bottom; ++row) {
            for (int column = tile_.left; column < tile_.right; ++column) {
                keys.push_back({pixel_key(seed, static_cast<std::uint32_t>(part_.left + column),
                                          static_cast<std::uint32_t>(part_.top + row))});
            }
        }
    }

    bool have_lens() const { return camera_.has_lens(); }

    // Moves rays from the eye to points of the lens, given on the unit disc.
    void move_to_lens(Group<Real>& group, const PlanePoint<Real>& point) const {
        camera_.move_to_lens(group.rays, point);
    }

    // The next rays of the row, as many as there are lanes and pixels left.
    Group<Real> next() {
        using L = Lanes<Real>;
        const L columns = mask_ != nullptr
                              ? L::gather([&](int lane) { return static_cast<Real>(part_.left + masked_column(lane)); })
                              : L(static_cast<Real>(part_.left + tile_.left + index_)) + L::numbers();
        const L rows = static_cast<Real>(part_.top + row_);
        const int place = places_ ? (*places_)[static_cast<std::size_t>(sample_)] : sample_;
        Group<Real> group;
        group.rays.origin = Vector<L>(camera_.eye());
        group.rays.direction = camera_.directions(columns + L(offset(place % grid_)), rows + L(offset(place / grid_)));
        group.rays.t_min = camera_.eye_error();
        group.rays.object = contact_.object;
        group.rays.primitive = contact_.primitive;
        group.rays.inside = contact_.leads_inside(group.rays.direction, camera_.eye_error(), camera_.spread());
        group.rays.spread = camera_.spread();
        group.rays.reach = reach_;
        group.weight = Real(1);
        group.depth = 0;
        const int first_pixel = (row_ - tile_.top) * (tile_.right - tile_.left);
        group.pixel =
            Indices<Real>(first_pixel) +
            (mask_ != nullptr ? Indices<Real>::gather([&](int lane) { return masked_column(lane) - tile_.left; })
                              : Indices<Real>(index_) + Indices<Real>::numbers());
        group.record = -1;
        group.sample = place;
        group.path = static_cast<int>(primary_path);
        group.active = Mask<Real>::first(count_ - index_);
        advance();
        return group;
    }

 private:
    void advance() {
        index_ += lane_count<Real>;
        if (index_ < count_) {
            return;
        }
        index_ = 0;
        if (++sample_ == samples_) {
            sample_ = 0;
            ++row_;
            if (mask_ != nullptr) {
                find_pixels();
            }
        }
    }

    // Goes to the next row that has any of the pixels wanted, if this has none, and finds them.
    void find_pixels() {
        for (; row_ != tile_.bottom; ++row_) {
            const unsigned char* row = mask_ + static_cast<std::size_t>(row_) * static_cast<std::size_t>(part_.width);
            count_ = 0;
            for (int column = tile_.left; column < tile_.right; ++column) {
                if (row[column] != 0) {
                    columns_[static_cast<std::size_t>(count_++)] = column;
                }
            }
            if (count_ > 0) {
                return;
            }
        }
    }

    int masked_column(int lane) const {
        return columns_[static_cast<std::size_t>(std::min(index_ + lane, count_ - 1))];
    }

    // Of a place in the grid from its pixel's top-left corner, across or down.
    Real offset(int place) const { return (static_cast<Real>(place) + Real(0.5)) / static_cast<Real>(grid_) - shift_; }

    const Camera<Real>& camera_;
    const EyeContact<Real>& contact_;
    const Tile tile_;
    const int grid_;
    const Places* const places_;  // null: all, in the order of their numbers
    const int samples_;
    const Real shift_;
    const Lanes<Real> reach_;          // of the eye
    const unsigned char* const mask_;  // of the part, 1 where a pixel is wanted; null: all are
    const PicturePart part_;
    std::array<int, tile_width> columns_;  // of the pixels that are wanted in the row, if not all are
    int count_;                            // how many these are
    int row_, index_ = 0;
    int sample_ = 0;  // how many of the places come before
};

}  // namespace whitted::WHITTED_ISA
