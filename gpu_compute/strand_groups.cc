#include "gpu_compute/strand_groups.h"

#include <algorithm>
#include <numeric>

namespace strandcast::gpu {
namespace {

constexpr GLuint kMaxGroupsPerAxis = 65535;

}  // namespace

const gl::Program& ProgramCache::get(const char* name, const char* text, const std::string& defines) {
  const std::string key = std::string(name) + "\n" + defines;
  auto found = programs_.find(key);
  if (found == programs_.end())
    found = programs_.emplace(key, gl::Program(name, {{GL_COMPUTE_SHADER, text, defines}})).first;
  return found->second;
}

StrandGroups::StrandGroups(std::span<const uint32_t> keys) : order_(keys.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  std::stable_sort(order_.begin(), order_.end(), [&](uint32_t a, uint32_t b) { return keys[a] < keys[b]; });
  for (uint32_t i = 0; i < order_.size(); ++i) {
    const uint32_t own = keys[order_[i]];
    if (groups_.empty() || groups_.back().key != own) groups_.push_back({own, i, 0});
    ++groups_.back().count;
  }
}

void dispatch(const gl::Program& program, uint32_t strands, uint32_t per_workgroup) {
  program.use();
  const GLuint workgroups = (strands + per_workgroup - 1) / per_workgroup;
  const GLuint wide = std::min(workgroups, kMaxGroupsPerAxis);
  glDispatchCompute(wide, (workgroups + wide - 1) / wide, 1);
}

}  // namespace strandcast::gpu
