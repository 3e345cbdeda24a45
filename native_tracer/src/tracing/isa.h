// The namespace of everything that is compiled once for each instruction set.
//
// kernel.cpp, shapes.cpp and the headers that they include, of tracing and of shapes, are compiled several times, for
// older and newer x86-64 processors, and the program picks one copy when it runs. Each copy lives in a namespace of its
// own: the linker keeps only one of several functions with the same name, and it must never keep an AVX2 one for a
// processor without. For the same reason the standard library's templates are used here with types of this namespace,
// or where they are surely inlined; check_symbols.cmake tells where they are not.

#pragma once

#ifndef WHITTED_ISA
#define WHITTED_ISA baseline
#endif
