// How the processor rounds.

#pragma once

#include <cfenv>

namespace certified {

// The processor rounds upward while there is one.
class Upward {
 public:
    Upward() : before_(std::fegetround()) { std::fesetround(FE_UPWARD); }
    ~Upward() { std::fesetround(before_); }
    Upward(const Upward&) = delete;
    Upward& operator=(const Upward&) = delete;

 private:
    int before_;
};

}  // namespace certified
