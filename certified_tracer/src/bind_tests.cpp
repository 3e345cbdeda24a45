// What tests ask of parts.

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <stdexcept>
#include <string>

#include "elementary.h"
#include "given.h"
#include "plain.h"
#include "prepared.h"
#include "upward.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace certified {

namespace {

template <typename End>
std::pair<double, double> miss_of(const std::string& function, const std::vector<Number>& given, const Number& truth) {
    using I = Interval<End>;
    std::vector<I> x;
    for (const Number& one : given) {
        x.push_back(enclosed<End>(one));
    }
    I value;
    if (function == "tan_half") {
        value = tangent_of_half(x.at(0));
    } else if (function == "exp") {
        value = exp(x.at(0));
    } else if (function == "log") {
        value = log(x.at(0));
    } else if (function == "power") {
        value = power(x.at(0), x.at(1));
    } else if (function == "sqrt") {
        value = sqrt(x.at(0));
    } else if (function == "square") {
        value = square(x.at(0));
    } else if (function == "+") {
        value = x.at(0) + x.at(1);
    } else if (function == "-") {
        value = x.at(0) - x.at(1);
    } else if (function == "*") {
        value = x.at(0) * x.at(1);
    } else if (function == "/") {
        value = x.at(0) / x.at(1);
    } else {
        throw std::invalid_argument("there is no function " + function);
    }
    const I miss = value - enclosed<End>(truth);
    return {miss.low_double(), miss.high_double()};
}

std::pair<double, double> miss(const std::string& function, const std::vector<Given>& given, const Given& truth,
                               int rung) {
    const std::vector<Number> arguments = numbers(given);
    const Upward upward;
    try {
        return rung == 0   ? miss_of<double>(function, arguments, number(truth))
               : rung == 1 ? miss_of<Wide<2>>(function, arguments, number(truth))
               : rung == 2 ? miss_of<Wide<4>>(function, arguments, number(truth))
                           : miss_of<Wide<8>>(function, arguments, number(truth));
    } catch (const Undecided&) {
        throw std::domain_error("undecided");
    }
}

PlainRay plain_ray(const GivenTriple& origin, const GivenTriple& direction) {
    return {enclosed<double>(numbers(origin)), enclosed<double>(numbers(direction))};
}

std::optional<std::vector<std::size_t>> sift(const std::vector<GivenFour>& planes, const GivenTriple& origin,
                                             const GivenTriple& direction, bool entries, double end) {
    const Upward upward;
    PlainPlanes plain;
    for (const GivenFour& given : planes) {
        const auto [a, b, c, d] = numbers(given);
        const auto normal = enclosed<double>(Triple{a, b, c});
        const Interval<double> length = sqrt(length2(normal));
        plain.add(normalized(normal), enclosed<double>(d) / length);
    }
    PlainPlanes::Sieve sieve;
    if (!plain.sift(plain_ray(origin, direction), end, entries, sieve)) {
        return {};
    }
    return sieve.left;
}

bool misses_ball(const GivenTriple& center, const Given& radius, const GivenTriple& origin,
                 const GivenTriple& direction, double end) {
    const Upward upward;
    const PlainSphere sphere(enclosed<double>(numbers(center)), enclosed<double>(number(radius)));
    return sphere.is_missed(plain_ray(origin, direction), end);
}

std::optional<double> meets_box(const std::array<double, 3>& low, const std::array<double, 3>& high,
                                const GivenTriple& origin, const GivenTriple& direction, double end) {
    const Upward upward;
    double near;
    return may_meet(plain_ray(origin, direction), low, high, end, near) ? std::optional(near) : std::nullopt;
}

}  // namespace

void bind_tests(nb::module_& module) {
    module.def("miss", &miss, "function"_a, "arguments"_a, "truth"_a, "rung"_a,
               "Low and high end of what a function's interval, less its true value, comes to.");
    module.def("sift", &sift, "planes"_a, "origin"_a, "direction"_a, "entries"_a, "end"_a,
               "Those of a polyhedron's planes that may be where a ray enters or leaves; none where it misses it.");
    module.def("misses_ball", &misses_ball, "center"_a, "radius"_a, "origin"_a, "direction"_a, "end"_a,
               "Whether a ray certainly does not come to a ball's surface before some distance.");
    module.def("meets_box", &meets_box, "low"_a, "high"_a, "origin"_a, "direction"_a, "end"_a,
               "A distance before which a ray does not meet a box; none where it certainly misses it.");
}

}  // namespace certified
