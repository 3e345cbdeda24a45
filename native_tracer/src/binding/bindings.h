// The parts of the Python module native_tracer._core.

#pragma once

#include <nanobind/nanobind.h>

void bind_scene(nanobind::module_& module);
void bind_render(nanobind::module_& module);
void bind_halfspaces(nanobind::module_& module);
void bind_bvh(nanobind::module_& module);
void bind_incidence(nanobind::module_& module);
void bind_memory(nanobind::module_& module);
void bind_scene_file(nanobind::module_& module);
void bind_sampler(nanobind::module_& module);
