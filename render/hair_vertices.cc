#include "render/hair_vertices.h"

#include <algorithm>

#include "render/scene_block.h"
#include "render/shaders.h"

namespace strandcast {
namespace {

constexpr size_t kGrowthGroupSize = 256;  // must equal local_size_x of hair_growth.comp
constexpr size_t kVertexBytes = 2 * sizeof(float[4]);

size_t maxVertices() {
  GLint64 bytes = 0;
  GLint groups = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
  glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
  const size_t most =
      std::min(static_cast<size_t>(bytes) / kVertexBytes, static_cast<size_t>(groups) * kGrowthGroupSize);
  return std::min(most, size_t{1} << 31);
}

}  // namespace

HairVertices::HairVertices()
    : free_("hair growth", {{GL_COMPUTE_SHADER, shaders::kHairGrowthComp}}),
      among_bodies_("hair growth among bodies",
                    {{GL_COMPUTE_SHADER, shaders::kHairGrowthComp, "#define BODIES\n"}}) {}

void HairVertices::makeRoom(size_t count, int max_nodes) {
  if (max_nodes == max_nodes_ && count <= room_) return;
  // Grows by half, so that approaching the hair does not reallocate at every picture.
  count = std::max(count, max_nodes == max_nodes_ ? room_ + room_ / 2 : 0);
  chunks_.clear();
  room_ = count;
  max_nodes_ = max_nodes;
  const size_t most = std::max<size_t>(maxVertices() / static_cast<size_t>(max_nodes), 1);
  for (size_t first = 0; first < count; first += most) {
    const size_t hairs = std::min(most, count - first);
    chunks_.push_back({first, hairs, gl::Buffer(hairs * max_nodes * kVertexBytes, nullptr, 0)});
  }
}

void HairVertices::grow(size_t count, int segments, int node_stride, bool bodies) {
  makeRoom(count, segments + 1);
  nodes_per_hair_ = (segments + node_stride - 1) / node_stride + 1;
  hairs_ = count;
  const gl::Program& program = bodies ? among_bodies_ : free_;
  program.set("node_stride", static_cast<unsigned>(node_stride));
  program.set("nodes_per_hair", static_cast<unsigned>(nodes_per_hair_));
  program.use();
  for (const Chunk& chunk : chunks_) {
    if (chunk.first >= count) break;
    const size_t hairs = std::min(chunk.hairs, count - chunk.first);
    program.set("first_hair", static_cast<unsigned>(chunk.first));
    program.set("hair_count", static_cast<unsigned>(hairs));
    chunk.vertices.bindStorage(binding::kHairVertices);
    glDispatchCompute(
        static_cast<GLuint>((hairs * nodes_per_hair_ + kGrowthGroupSize - 1) / kGrowthGroupSize), 1, 1);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

size_t HairVertices::bytes() const {
  size_t sum = 0;
  for (const Chunk& chunk : chunks_) sum += chunk.vertices.bytes();
  return sum;
}

}  // namespace strandcast
