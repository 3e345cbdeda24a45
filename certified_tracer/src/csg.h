// Constructive solid geometry: where a ray that meets leaves of a body meets the body, at the first place where the
// value of the body's expression changes.

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "rays.h"
#include "scene.h"
#include "surfaces.h"
#include "undecided.h"

namespace certified {

// Whether what lies in these leaves of a body, a bit each, lies in the body.
inline bool contains(const Body& body, std::uint64_t bits) {
    std::uint64_t stack = 0;  // the last value lowest
    for (const int step : body.program) {
        if (step >= 0) {
            stack = stack << 1 | (bits >> step & 1);
            continue;
        }
        const std::uint64_t right = stack & 1, left = stack >> 1 & 1;
        const std::uint64_t value = step == Body::unite      ? left | right
                                    : step == Body::subtract ? left & ~right
                                                             : left & right;
        stack = (stack >> 2) << 1 | (value & 1);
    }
    return stack & 1;
}

// The leaves, a bit each, with which the body can only shrink.
inline std::uint64_t subtracted(const Body& body) {
    std::uint64_t stack = 0, leaves = 0;  // of the operands that are left to be read, backwards
    for (std::size_t i = body.program.size(); i-- > 0;) {
        const int step = body.program[i];
        const std::uint64_t turned = stack & 1;
        if (step >= 0) {
            leaves |= turned << step;
            stack >>= 1;
        } else {
            stack = stack << 1 | (turned ^ std::uint64_t(step == Body::subtract));
        }
    }
    return leaves;
}

// A ray's way through the leaves of a body.
template <typename End>
class CsgWay {
 public:
    void clear() {
        inside_ = 0;
        events_.clear();
    }

    // The passage through one of the body's leaves.
    void add(const Passage<End>& passage, std::size_t leaf) {
        inside_ |= std::uint64_t(passage.inside) << leaf;
        for (int i = 0; i < passage.count; ++i) {
            const bool sure = i == passage.count - 1 ? passage.last_sure : true;
            events_.push_back({passage.crossings[static_cast<std::size_t>(i)], leaf, sure});
        }
    }

    // Whether the ray is in the body at its start, by what is known of the leaves.
    bool starts_inside(const Body& body) const { return contains(body, inside_); }

    // Where the body is met first, if it is; `index` is its own. To be called once. Throws Undecided.
    bool meet(const Body& body, int index, const Surfaces<End>& surfaces, Met<End>& met) {
        std::sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) {
            const double one = a.crossing.t.high_double(), other = b.crossing.t.high_double();
            return one != other ? one < other : a.crossing.surface < b.crossing.surface;
        });
        std::uint64_t inside = inside_;
        const bool before = !events_.empty() && starts_inside(body);
        for (std::size_t first = 0; first < events_.size();) {
            const std::size_t last = end_of_tie(first, surfaces);
            std::size_t named = first;
            const std::uint64_t inside_before = inside;
            for (std::size_t k = first; k < last; ++k) {
                inside ^= std::uint64_t(1) << events_[k].leaf;
                named = events_[k].crossing.surface < events_[named].crossing.surface ? k : named;
            }
            if (contains(body, inside) != before) {
                const Event& event = events_[named];
                if (!event.sure) {
                    throw Undecided{Reason::plane};
                }
                const bool behind = (inside_before >> event.leaf & 1) != 0;
                met = {event.crossing.t, index, event.crossing.surface, before, behind};
                return true;
            }
            first = last;
        }
        return false;
    }

 private:
    // A leaf is entered or left.
    struct Event {
        Crossing<End> crossing;
        std::size_t leaf;  // of the body's
        bool sure;         // which surface it is
    };

    // The end of the events that happen at once with the first of them.
    std::size_t end_of_tie(std::size_t first, const Surfaces<End>& surfaces) const {
        const Crossing<End>& crossing = events_[first].crossing;
        std::size_t end = first + 1;
        while (end < events_.size() && surfaces.order(crossing, events_[end].crossing, Reason::hit) >= 0) {
            ++end;
        }
        // What comes later may still begin before what is sorted last here.
        for (std::size_t k = end; k < events_.size(); ++k) {
            if (events_[k].crossing.t.low() <= crossing.t.high() &&
                surfaces.order(crossing, events_[k].crossing, Reason::hit) >= 0) {
                throw Undecided{Reason::hit};
            }
        }
        return end;
    }

    std::uint64_t inside_ = 0;  // of which leaves the ray is at its start, a bit each
    std::vector<Event> events_;
};

}  // namespace certified
