#include "core/error.h"
#include "gl/buffer.h"
#include "gl/context.h"
#include "gl/program.h"
#include "tests/conformance/kernel_conformance.h"
#include "tests/conformance/kernel_shaders.h"

namespace strandcast {

KernelInstantiation glslInstantiation() {
  std::shared_ptr<gl::HeadlessContext> context;
  try {
    context = std::make_shared<gl::HeadlessContext>();
  } catch (const Error& error) {
    return {error.what(), {}};
  }
  auto run = [context](int kernel, const float* in, float* out, size_t count) {
    context->makeCurrent();
    const gl::Program program("kernel_cases.comp", {{GL_COMPUTE_SHADER, shaders::kKernelCasesComp}});
    const gl::Buffer inputs(std::span<const float>(in, kKernelInputs * count));
    const gl::Buffer outputs(kKernelOutputs * count * sizeof(float), nullptr, GL_DYNAMIC_STORAGE_BIT);
    inputs.bindStorage(0);
    outputs.bindStorage(1);
    program.set("kernel", kernel);
    program.set("count", static_cast<int>(count));
    program.use();
    glDispatchCompute(static_cast<GLuint>((count + 63) / 64), 1, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(outputs.id(), 0, static_cast<GLsizeiptr>(kKernelOutputs * count * sizeof(float)),
                            out);
  };
  return {"GLSL on " + context->renderer(), run};
}

}  // namespace strandcast
