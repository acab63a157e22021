#include "gpu_compute/divergence_test.h"

#include <vector>

#include "gpu_compute/shaders.h"

namespace strandcast::gpu {
namespace {

constexpr uint32_t kDivergenceStrands = 32;  // per workgroup, as in shaders/divergence.comp

/// A little less than the limit, so that rounding on the GPU lets no strand pass that the CPU would reset.
std::vector<float> squaredReachOf(const StrandModel& model) {
  std::vector<float> out = strandLengths(model);
  for (float& length : out) length *= length * kDivergedReach * kDivergedReach * (1 - 1e-5f);
  return out;
}

}  // namespace

DivergenceTest::DivergenceTest(const StrandModel& model)
    : strands_(static_cast<uint32_t>(model.strands())),
      squared_reach_(std::span<const float>(squaredReachOf(model))),
      found_(sizeof(uint32_t), nullptr, GL_DYNAMIC_STORAGE_BIT),
      result_(sizeof(uint32_t)) {}

void DivergenceTest::start(const gl::Buffer& guides, const gl::Buffer& offsets, ProgramCache& programs) {
  const gl::Program& program = program_.get(programs, "divergence.comp", shaders::kDivergenceComp);
  glClearNamedBufferData(found_.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  guides.bindStorage(0);
  offsets.bindStorage(1);
  squared_reach_.bindStorage(2);
  found_.bindStorage(3);
  glProgramUniform1ui(program.id(), 0, strands_);
  dispatch(program, strands_, kDivergenceStrands);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  result_.copyFrom(found_, 0, sizeof(uint32_t));
}

bool DivergenceTest::finish() {
  result_.wait();
  return result_.as<uint32_t>()[0] != 0;
}

}  // namespace strandcast::gpu
