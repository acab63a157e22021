#pragma once
#include "validation/suite.h"

namespace strandcast {

/// "render": the renderer's shaders against slower exact references, e.g. grown hair against the CPU in
/// double precision. Ignores the laboratory's backend. Throws Error where there is no OpenGL 4.5.
const Suite& renderSuite();

}  // namespace strandcast
