// Numbers as Python gives them: pairs of doubles that add up to one, and of how far it may be off.

#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "scene.h"

namespace certified {

using Given = std::pair<std::vector<double>, double>;
using GivenTriple = std::array<Given, 3>;
using GivenFour = std::array<Given, 4>;

inline Number number(const Given& given) {
    if (given.first.empty()) {
        throw std::invalid_argument("a number has a double at least");
    }
    return {given.first, given.second};
}

template <std::size_t count>
std::array<Number, count> numbers(const std::array<Given, count>& given) {
    std::array<Number, count> result;
    for (std::size_t i = 0; i < count; ++i) {
        result[i] = number(given[i]);
    }
    return result;
}

inline std::vector<Number> numbers(const std::vector<Given>& given) {
    std::vector<Number> result;
    for (const Given& one : given) {
        result.push_back(number(one));
    }
    return result;
}

void bind_tests(nanobind::module_& module);

}  // namespace certified
