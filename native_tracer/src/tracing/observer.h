// Who watches the tracer: nobody while a picture is rendered, a recorder when one pixel is to be explained, see
// recorder.h, and a signer where pixels are compared with their neighbours, see signer.h.
//
// The tracer is a template over its observer, so that both run the same code, and watching costs a rendering nothing.

#pragma once

#include "tracing/isa.h"

namespace whitted::WHITTED_ISA {

struct Unobserved {
    static constexpr bool observes = false;

    template <typename... Arguments>
    void primary(Arguments&...) {}
    template <typename... Arguments>
    void pigment(const Arguments&...) {}
    template <typename... Arguments>
    void surface(const Arguments&...) {}
    template <typename... Arguments>
    void light(const Arguments&...) {}
    template <typename... Arguments>
    void dropped(const Arguments&...) {}
    template <typename... Arguments>
    void total_reflection(const Arguments&...) {}
    template <typename... Arguments>
    void color(const Arguments&...) {}
    template <typename... Arguments>
    void spawned(Arguments&&...) {}
};

}  // namespace whitted::WHITTED_ISA
