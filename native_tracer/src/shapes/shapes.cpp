// Shapes whose code is long, compiled apart from those that all scenes have: there it would leave the compiler no room
// to put functions into one another. Compiled once for each instruction set; see isa.h.

#include "shapes/shapes.h"

namespace whitted::WHITTED_ISA {

template class Quadric<float>;
template class Quadric<double>;
template class Csg<float>;
template class Csg<double>;
template class Moving<float>;
template class Moving<double>;

}  // namespace whitted::WHITTED_ISA
