#include "gpu_compute/gauss_seidel_strands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <map>

#include "core/strand_block.h"
#include "gpu_compute/shaders.h"

namespace strandcast::gpu {
namespace {

using Vec4 = std::array<float, 4>;

std::vector<Vec4> packRestEdges(const StrandModel& model) {
  std::vector<Vec4> packed(model.vertices());
  std::array<Vec3, kMaxVerticesPerStrand> edges;
  for (size_t s = 0; s < model.strands(); ++s) {
    const uint32_t first = model.offsets[s];
    const std::span<const Vec3> rest(model.rest_local.data() + first, model.verticesOf(s));
    restEdges(rest, edges);
    for (size_t i = 0; i < rest.size(); ++i) {
      const float length = i + 1 < rest.size() ? (rest[i + 1] - rest[i]).norm() : 0.0f;
      packed[first + i] = {edges[i].x(), edges[i].y(), edges[i].z(), length};
    }
  }
  return packed;
}

std::vector<uint32_t> threadsPerStrand(const StrandModel& model, bool compiles_slowly) {
  std::vector<uint32_t> threads(model.strands());
  std::map<uint32_t, size_t> count;
  for (size_t s = 0; s < threads.size(); ++s)
    ++count[threads[s] = std::max(4u, std::bit_ceil(static_cast<uint32_t>(model.verticesOf(s))))];
  for (uint32_t& own : threads)
    if (compiles_slowly && count[own] < kMinVariantStrands) own = std::max(own, kWorkgroup);
  return threads;
}

}  // namespace

GaussSeidelStrands::GaussSeidelStrands(const StrandModel& model, bool compiles_slowly)
    : groups_(threadsPerStrand(model, compiles_slowly)),
      order_(groups_.order()),
      rest_edge_(std::span<const Vec4>(packRestEdges(model))) {}

void GaussSeidelStrands::step(int groomed, bool accelerated, bool bends, ProgramCache& programs) {
  auto workgroup = [](const StrandGroup& group) { return std::max(kWorkgroup, group.key); };
  std::vector<const gl::Program*>& mine =
      programs_[(groomed > 0 ? 1 : 0) + (accelerated ? 2 : 0) + (bends ? 4 : 0)];
  if (mine.empty())
    for (const StrandGroup& group : groups_.groups())
      mine.push_back(&programs.get(
          "gauss_seidel.comp", shaders::kGaussSeidelComp,
          fmt::format("#define THREADS {}\n#define WORKGROUP {}\n#define GROOMED {}\n#define ACCELERATED {}\n"
                      "#define SHAPE_KINDS {}\n",
                      group.key, workgroup(group), groomed, accelerated ? 1 : 0, bends ? 2 : 1)));
  rest_edge_.bindStorage(3);
  order_.bindStorage(5);
  for (size_t g = 0; g < mine.size(); ++g) {
    const StrandGroup& group = groups_.groups()[g];
    glProgramUniform1ui(mine[g]->id(), 0, group.first);
    glProgramUniform1ui(mine[g]->id(), 1, group.count);
    dispatch(*mine[g], group.count, workgroup(group) / group.key);
  }
}

}  // namespace strandcast::gpu
