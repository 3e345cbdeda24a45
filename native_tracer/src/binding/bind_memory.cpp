// A reserve of memory, so that running out of it can be told.
//
// Where not even an integer can be allocated, CPython 3.11 loops for ever: entering the handler of an exception
// may need one, and its failure enters the same handler again, in C, where no signal is seen. So the first allocation
// that fails gives the reserve back. It fails nevertheless, but what follows, up to the message, finds room.

#include <Python.h>

#include <cstddef>
#include <cstdlib>
#include <new>

#include "binding/bindings.h"

namespace {

constexpr std::size_t reserve_size = 8U << 20U;  // a few of Python's arenas of one MiB
void* reserve = nullptr;
PyMemAllocatorEx raw;  // what was there before

void* give_back_if_none(void* result) {
    if (result == nullptr && reserve != nullptr) {
        std::free(reserve);
        reserve = nullptr;
    }
    return result;
}

void* allocate(void* context, std::size_t size) { return give_back_if_none(raw.malloc(context, size)); }

void* allocate_zeros(void* context, std::size_t count, std::size_t size) {
    return give_back_if_none(raw.calloc(context, count, size));
}

void* reallocate(void* context, void* memory, std::size_t size) {
    return give_back_if_none(raw.realloc(context, memory, size));
}

void release(void* context, void* memory) { raw.free(context, memory); }

// C++ tries again once its handler has returned: this one does so only to throw.
void throw_with_room() {
    give_back_if_none(nullptr);
    throw std::bad_alloc();
}

// Python asks its raw allocator for whatever is large, and for whatever is small once its arenas are full.
void keep_reserve() {
    if (reserve != nullptr) {
        return;
    }
    reserve = std::malloc(reserve_size);
    if (raw.malloc == nullptr) {
        PyMem_GetAllocator(PYMEM_DOMAIN_RAW, &raw);
        PyMemAllocatorEx watched{raw.ctx, allocate, allocate_zeros, reallocate, release};
        PyMem_SetAllocator(PYMEM_DOMAIN_RAW, &watched);
        std::set_new_handler(throw_with_room);
    }
}

}  // namespace

void bind_memory(nanobind::module_& module) {
    module.def("keep_reserve", &keep_reserve, "Keep some memory for the time when there is no more.");
}
