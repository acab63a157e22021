#include "tests/conformance/kernel_conformance.h"

namespace strandcast {

KernelInstantiation glslInstantiation() { return {"built without OpenGL", {}}; }

}  // namespace strandcast
