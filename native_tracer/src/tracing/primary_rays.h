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

// The rays of a rectangle of pixels: block by block, in each some or all places of a grid of grid x grid rays a pixel,
// one place of it after the other. Within a block pixels follow one another so that any group of 4, 8, 16 is about a
// square: its rays meet the same things for longer than those of a row would. Morton, "A Computer Oriented Geodetic
// Data Base; and a New Technique in File Sequencing", IBM, 1966.
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
          left_(tile.left),
          top_(tile.top) {
        find_pixels();
    }

    bool done() const { return top_ >= tile_.bottom; }
    bool begins_block() const { return index_ == 0 && sample_ == 0; }

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

    // The next rays of the block, as many as there are lanes and pixels left.
    Group<Real> next() {
        using L = Lanes<Real>;
        L columns, rows;
        load(columns_.data() + index_, columns);
        load(rows_.data() + index_, rows);
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
        load(pixels_.data() + index_, group.pixel);
        group.record = -1;
        group.sample = place;
        group.path = static_cast<int>(primary_path);
        group.active = Mask<Real>::first(count_ - index_);
        advance();
        return group;
    }

 private:
    static constexpr int block_size = 8;

    void advance() {
        index_ += lane_count<Real>;
        if (index_ < count_) {
            return;
        }
        index_ = 0;
        if (++sample_ == samples_) {
            sample_ = 0;
            next_block();
            find_pixels();
        }
    }

    void next_block() {
        left_ += block_size;
        if (left_ >= tile_.right) {
            left_ = tile_.left;
            top_ += block_size;
        }
    }

    // Goes to the next block that has any of the pixels wanted, if this has none, and finds them.
    void find_pixels() {
        for (; !done(); next_block()) {
            count_ = 0;
            for (unsigned number = 0; number < block_size * block_size; ++number) {
                const int column = left_ + even_bits(number);
                const int row = top_ + even_bits(number >> 1);
                if (column < tile_.right && row < tile_.bottom && is_wanted(column, row)) {
                    const auto at = static_cast<std::size_t>(count_++);
                    columns_[at] = static_cast<Real>(part_.left + column);
                    rows_[at] = static_cast<Real>(part_.top + row);
                    pixels_[at] = (row - tile_.top) * (tile_.right - tile_.left) + (column - tile_.left);
                }
            }
            if (count_ > 0) {
                return;
            }
        }
    }

    // Of a number of six bits.
    static int even_bits(unsigned number) {
        return static_cast<int>((number & 1U) | (number >> 1 & 2U) | (number >> 2 & 4U));
    }

    bool is_wanted(int column, int row) const {
        return mask_ == nullptr || mask_[static_cast<std::size_t>(row) * static_cast<std::size_t>(part_.width) +
                                         static_cast<std::size_t>(column)] != 0;
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
    // Of the block's pixels that are wanted, and with room for a whole group behind the last.
    static constexpr std::size_t room = block_size * block_size + lane_count<Real>;
    std::array<Real, room> columns_{}, rows_{};
    std::array<typename Indices<Real>::Integer, room> pixels_{};
    int count_ = 0;   // how many these are
    int left_, top_;  // of the block
    int index_ = 0;
    int sample_ = 0;  // how many of the places come before
};

}  // namespace whitted::WHITTED_ISA
