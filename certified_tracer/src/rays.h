// Rays, the places where they meet surfaces, and which signs are certain.

#pragma once

#include <array>

#include "double_interval.h"
#include "prepared.h"
#include "undecided.h"

namespace certified {

// Signs that are certain. On the last rung a number that is 0 to some 80 digits counts as 0, as the format's rule for
// ties wants it: "equal but for roundings". One that is 0 to some 20 digits there, and known no better, is degenerate.
template <typename End>
class Judge {
 public:
    using I = Interval<End>;

    Judge(bool last, bool ties) : last_(last), ties_(ties) {}

    int sign(const I& x, Reason reason) {
        if (x.positive()) {
            return 1;
        }
        if (x.negative()) {
            return -1;
        }
        if (x.is_zero()) {
            return 0;
        }
        if (last_ && within(x, tie) && ties_) {
            tied = true;
            return 0;
        }
        degenerate |= last_ && within(x, nearly);
        throw Undecided{reason};
    }

    bool tied = false, degenerate = false;  // such a number was met

 private:
    static constexpr double tie = 0x1p-270, nearly = 0x1p-66;

    static bool within(const I& x, double size) { return x.high_double() < size && x.low_double() > -size; }

    bool last_, ties_;
};

template <typename End>
struct Ray {
    using I = Interval<End>;

    Vector<I> origin, direction;
    // What it starts on, and whether it goes into that; or that it starts at the eye.
    int body = -1, surface = -1;
    bool inside = false;
    bool from_eye = false;
    int to_light = -1;  // where its direction ends, if at a light
};

template <typename End>
struct Crossing {
    Interval<End> t;
    int surface;
};

// Whether a ray is within a leaf behind its start, and where it passes the leaf's surface: twice at most.
template <typename End>
struct Passage {
    bool inside = false;
    int count = 0;
    std::array<Crossing<End>, 2> crossings;
    bool last_sure = true;  // it is, which surface the last of them is on

    void add(const Interval<End>& t, int surface) { crossings[static_cast<std::size_t>(count++)] = {t, surface}; }
};

template <typename End>
struct Met {
    Interval<End> t;
    int body, surface;
    bool inside;  // the body is met from within
    bool behind;  // the surface is met from the side that its normal leaves
};

}  // namespace certified
