// Decides for one ray between places where it meets leaves of a csg that are the same but for rounding errors. All that
// happens there happens at once: a film that is no thicker than the errors is none.

#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "shapes/csg_expression.h"
#include "shapes/csg_passages.h"
#include "shapes/csg_plan.h"
#include "tracing/description.h"
#include "tracing/ray.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
class CsgEvents {
 public:
    // A leaf is met.
    struct Event {
        Real t;
        int leaf, primitive;
        bool enters;

        std::uint64_t bit() const { return std::uint64_t(1) << leaf; }
    };

    // The expression's value changes at distance t, where it was `before`: there the surface is met.
    struct Change {
        Real t;
        Event met;
        bool before;
    };

    CsgEvents(const CsgPassages<Real>& passages, const Rays<Real>& rays, int lane) {
        for (int i = 0; i < passages.count; ++i) {
            const auto& ends = passages.ends[i];
            const int leaf = passages.leaf[i];
            const bool inverted = ends.inverted[lane];
            bool in = inverted;
            const auto add = [&](Real t, int primitive, bool enters) {
                if (t <= rays.t_min[lane]) {
                    in = enters;
                } else if (std::isfinite(t)) {
                    events_[count_++] = {t, leaf, primitive, enters};
                }
            };
            if (ends.near[lane] < ends.far[lane]) {
                add(ends.near[lane], ends.near_primitive[lane], !inverted);
                add(ends.far[lane], ends.far_primitive[lane], inverted);
            }
            inside_ |= std::uint64_t(in) << leaf;
        }
        sort();
    }

    // error_of(event) is how far its distance may be off.
    template <typename ErrorOf>
    std::optional<Change> first_change(const CsgPlan& plan, ErrorOf error_of) const {
        std::uint64_t inside = inside_;
        for (int first = 0; first < count_;) {
            const int end = end_of_tie(first, error_of);
            const bool before = value_inside(plan, inside);
            std::uint64_t after = inside;
            Real t = events_[first].t;
            for (int k = first; k < end; ++k) {
                const std::uint64_t behind = after ^ events_[k].bit();
                t = value_inside(plan, behind) != value_inside(plan, after) ? events_[k].t : t;
                after = behind;
            }
            if (value_inside(plan, after) != before) {
                return Change{t, *first_met(plan, events_ + first, events_ + end, inside, after), before};
            }
            inside = after;
            first = end;
        }
        return std::nullopt;
    }

 private:
    // By distance, and the first leaf first.
    void sort() {
        for (int i = 1; i < count_; ++i) {
            for (int k = i; k > 0 && events_[k].t < events_[k - 1].t; --k) {
                const Event later = events_[k - 1];
                events_[k - 1] = events_[k];
                events_[k] = later;
            }
        }
    }

    // The end of the events that tie, each with the next.
    template <typename ErrorOf>
    int end_of_tie(int first, ErrorOf error_of) const {
        int end = first + 1;
        for (Real error = error_of(events_[first]); end < count_; ++end) {
            const Real next_error = error_of(events_[end]);
            if (!(events_[end].t - events_[end - 1].t <= error + next_error)) {
                break;
            }
            error = next_error;
        }
        return end;
    }

    // Of events at once, the first leaf's among those that make a difference: by themselves, or by being left out.
    static const Event* first_met(const CsgPlan& plan, const Event* begin, const Event* end, std::uint64_t before,
                                  std::uint64_t after) {
        const auto differs = [&](std::uint64_t inside, const Event& event) {
            return value_inside(plan, inside ^ event.bit()) != value_inside(plan, inside);
        };
        const Event* first = nullptr;
        for (const Event* event = begin; event != end; ++event) {
            const bool matters = differs(before, *event) || differs(after, *event);
            if (matters && (first == nullptr || event->primitive < first->primitive)) {
                first = event;
            }
        }
        return first == nullptr ? begin : first;
    }

    Event events_[2 * most_csg_leaves];
    int count_ = 0;
    std::uint64_t inside_ = 0;  // of which leaves the ray is at its start, a bit each
};

}  // namespace whitted::WHITTED_ISA
