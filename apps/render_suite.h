#pragma once
#include "validation/suite.h"

namespace strandcast {

/// "render": what the renderer's shaders make against slower exact paths: grown hair against the CPU in
/// double precision. Does not look at the laboratory's backend. Throws Error where there is no OpenGL 4.5.
const Suite& renderSuite();

}  // namespace strandcast
