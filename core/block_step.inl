// The step of a block of strands, for every solver. Included inside a namespace that has the lane vocabulary and the
// kernel text. The order of inclusion matters.
// clang-format off
#include "core/body_surface.inl"
#include "core/strand_sweep.inl"
#include "core/near_bodies.inl"
#include "core/gauss_seidel_sweep.inl"
#include "core/rod_sweep.inl"
// clang-format on
