// Shapes of several kinds, each kind in a list of its own.

#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// Where a shape is: in the list of its kind.
struct ShapeIndex {
    std::size_t kind, index;
};

// Neighbours in a list.
struct Range {
    int first = 0, end = 0;
};

template <typename Real, typename... Shape>
class ShapeLists {
 public:
    using Description = std::variant<typename Shape::Description...>;
    static constexpr std::size_t kinds = sizeof...(Shape);
    using Ranges = std::array<Range, kinds>;  // of each list
    using View = std::tuple<std::vector<typename Shape::Sight>...>;

    static int primitive_count(const Description& description) {
        return with_kind(description.index(), [&](auto kind) {
            return ShapeOf<kind()>::primitive_count(*std::get_if<kind()>(&description));
        });
    }

    // Adds a shape at the end of its list.
    ShapeIndex add(const Description& description, int object, int first_primitive) {
        return with_kind(description.index(), [&](auto kind) {
            auto& list = std::get<kind()>(lists_);
            list.emplace_back(*std::get_if<kind()>(&description), object, first_primitive);
            return ShapeIndex{kind(), list.size() - 1};
        });
    }

    // All that have been added behind these.
    Ranges added_behind(const Ranges& before) const {
        Ranges result;
        for_each_kind([&](auto kind) {
            result[kind()] = {before[kind()].end, static_cast<int>(std::get<kind()>(lists_).size())};
        });
        return result;
    }

    // visit(shape)
    template <typename Visit>
    [[gnu::always_inline]] decltype(auto) visit(ShapeIndex place, Visit visit) const {
        return with_kind(place.kind, [&](auto kind) __attribute__((always_inline)) -> decltype(auto) {
            return visit(std::get<kind()>(lists_)[place.index]);
        });
    }

    // A shape of which the kind is known.
    template <typename Kind>
    const Kind& at(ShapeIndex place) const {
        return std::get<std::vector<Kind>>(lists_)[place.index];
    }

    // visit(shape, description), for the description that the shape was made from.
    template <typename Visit>
    void visit(ShapeIndex place, const Description& description, Visit visit) const {
        with_kind(place.kind,
                  [&](auto kind) { visit(std::get<kind()>(lists_)[place.index], *std::get_if<kind()>(&description)); });
    }

    // Calls visit(shape) for the shapes in the ranges until it returns false, and returns false then.
    template <typename Visit>
    [[gnu::always_inline]] bool for_each(const Ranges& ranges, Visit visit) const {
        return for_each_numbered(
            ranges, [&](auto, int, const auto& shape) __attribute__((always_inline)) { return visit(shape); });
    }

    // Likewise visit(shape, sight); the view has a sight for each shape in the ranges.
    template <typename Visit>
    [[gnu::always_inline]] bool for_each(const Ranges& ranges, const View& view, Visit visit) const {
        return for_each_numbered(ranges, [&](auto kind, int index, const auto& shape) __attribute__((always_inline)) {
            return visit(shape, std::get<kind()>(view)[static_cast<std::size_t>(index)]);
        });
    }

    // The shapes in the ranges, which begin with the lists, as seen from a point, or from all points about it that are
    // no farther away than `extent`.
    View view_from(const Ranges& ranges, const Vector<Real>& point, Real extent = 0) const {
        View view;
        for_each_numbered(ranges, [&](auto kind, int, const auto& shape) {
            std::get<kind()>(view).emplace_back(shape, point, extent);
            return true;
        });
        return view;
    }

 private:
    template <std::size_t kind>
    using ShapeOf = std::tuple_element_t<kind, std::tuple<Shape...>>;
    template <std::size_t kind>
    using Kind = std::integral_constant<std::size_t, kind>;

    // Calls visit(kind) for all kinds, each a constant.
    template <typename Visit>
    [[gnu::always_inline]] static void for_each_kind(Visit visit) {
        [&]<std::size_t... kind>(std::index_sequence<kind...>)
            __attribute__((always_inline)) { (visit(Kind<kind>()), ...); }(std::index_sequence_for<Shape...>());
    }

    // visit(kind) for the kind of that number, a constant. Not std::visit, which the linker might take from a kernel of
    // newer instructions.
    template <std::size_t kind = 0, typename Visit>
    [[gnu::always_inline]] static decltype(auto) with_kind(std::size_t number, Visit visit) {
        if constexpr (kind + 1 < kinds) {
            if (number != kind) {
                return with_kind<kind + 1>(number, visit);
            }
        }
        return visit(Kind<kind>());
    }

    // Calls visit(kind, index, shape) until it returns false.
    template <typename Visit>
    [[gnu::always_inline]] bool for_each_numbered(const Ranges& ranges, Visit visit) const {
        const auto for_each_of = [&](auto kind) __attribute__((always_inline)) {
            const auto& list = std::get<kind()>(lists_);
            for (int index = ranges[kind()].first; index < ranges[kind()].end; ++index) {
                if (!visit(kind, index, list[static_cast<std::size_t>(index)])) {
                    return false;
                }
            }
            return true;
        };
        return [&]<std::size_t... kind>(std::index_sequence<kind...>) __attribute__((always_inline)) {
            return (for_each_of(Kind<kind>()) && ...);
        }(std::index_sequence_for<Shape...>());
    }

    std::tuple<std::vector<Shape>...> lists_;
};

}  // namespace whitted::WHITTED_ISA
