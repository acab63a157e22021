#include "gpu_compute/gpu_strands.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <numeric>

#include "core/error.h"
#include "core/strand_block.h"
#include "gpu_compute/shaders.h"

namespace strandcast::gpu {
namespace {

constexpr size_t kFirstPrimitives = 256;  // what a step may bring before the ring is made anew, larger
constexpr GLuint kMaxGroupsPerAxis = 65535;

using Vec4 = std::array<float, 4>;

Vec4 vec4(const Vec3& v, float w = 0) { return {v.x(), v.y(), v.z(), w}; }

template <class T>
gl::Buffer storage(size_t count) {
  return gl::Buffer(count * sizeof(T), nullptr, GL_DYNAMIC_STORAGE_BIT);
}

// Invocations for a strand of so many vertices.
uint32_t threadsFor(size_t vertices) { return std::max(4u, std::bit_ceil(static_cast<uint32_t>(vertices))); }

void checkFits(size_t vertices) {
  GLint64 limit = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
  if (vertices * sizeof(Vec4) > static_cast<uint64_t>(limit))
    throw Error(fmt::format("{} vertices are too many for this GPU's buffers", vertices),
                reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                "use fewer strands or --backend simd");
}

void discardErrors() {
  for (int i = 0; i < 64 && glGetError() != GL_NO_ERROR; ++i) {
  }
}

}  // namespace

GpuStrands::GpuStrands(const StrandModel& model)
    : vertices_((checkFits(model.vertices()), discardErrors(), model.vertices())),
      strands_(model.strands()),
      positions_(storage<Vec4>(vertices_)),
      velocities_(storage<Vec4>(vertices_)),
      offsets_(std::span<const uint32_t>(model.offsets)),
      guides_(storage<Vec3>(vertices_)),
      uploads_(std::in_place, strands_, kFirstPrimitives),
      readback_(vertices_) {
  std::vector<Vec4> local(vertices_), edge(vertices_);
  std::array<Vec3, kMaxVerticesPerStrand> edges;
  for (size_t s = 0; s < strands_; ++s) {
    const uint32_t first = model.offsets[s];
    const std::span<const Vec3> rest(model.rest_local.data() + first, model.verticesOf(s));
    restEdges(rest, edges);
    for (size_t i = 0; i < rest.size(); ++i) {
      local[first + i] = vec4(rest[i], model.inverse_mass[first + i]);
      edge[first + i] = vec4(edges[i], i + 1 < rest.size() ? (rest[i + 1] - rest[i]).norm() : 0.0f);
    }
  }
  rest_local_ = gl::Buffer(std::span<const Vec4>(local));
  rest_edge_ = gl::Buffer(std::span<const Vec4>(edge));
  makeGroups(model);
  if (glGetError() == GL_OUT_OF_MEMORY)
    throw Error("the model does not fit the GPU's memory", fmt::format("{} vertices", vertices_),
                "use fewer strands or --backend simd");
}

void GpuStrands::makeGroups(const StrandModel& model) {
  std::vector<uint32_t> order(strands_);
  std::iota(order.begin(), order.end(), 0u);
  auto threads = [&](uint32_t strand) { return threadsFor(model.verticesOf(strand)); };
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return threads(a) < threads(b); });
  order_ = gl::Buffer(std::span<const uint32_t>(order));
  for (size_t first = 0; first < order.size();) {
    const uint32_t wide = threads(order[first]);
    size_t end = first;
    while (end < order.size() && threads(order[end]) == wide) ++end;
    const uint32_t workgroup = std::max(32u, wide);
    gl::Program program("gauss_seidel.comp",
                        {{GL_COMPUTE_SHADER, shaders::kGaussSeidelComp,
                          fmt::format("#define THREADS {}\n#define WORKGROUP {}\n", wide, workgroup)}});
    program.set("first_strand", static_cast<unsigned>(first));
    program.set("strands_in_group", static_cast<unsigned>(end - first));
    const uint32_t per_workgroup = workgroup / wide;
    const auto strands = static_cast<GLuint>(end - first);
    groups_.push_back({std::move(program), strands, (strands + per_workgroup - 1) / per_workgroup});
    first = end;
  }
}

void GpuStrands::upload(const StrandState& state) {
  std::vector<Vec4> packed(vertices_);
  auto write = [&](const std::vector<Vec3>& from, gl::Buffer& to) {
    for (size_t i = 0; i < vertices_; ++i) packed[i] = vec4(from[i]);
    to.write(std::span<const Vec4>(packed));
  };
  write(state.positions, positions_);
  write(state.velocities, velocities_);
  uploaded_ = state.positions;
}

void GpuStrands::download(StrandState& state) const {
  std::vector<Vec4> packed(vertices_);
  auto read = [&](const gl::Buffer& from, std::vector<Vec3>& to) {
    glGetNamedBufferSubData(from.id(), 0, static_cast<GLsizeiptr>(vertices_ * sizeof(Vec4)), packed.data());
    to.resize(vertices_);
    for (size_t i = 0; i < vertices_; ++i) to[i] = Vec3(packed[i][0], packed[i][1], packed[i][2]);
  };
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  read(positions_, state.positions);
  read(velocities_, state.velocities);
}

void GpuStrands::bind() const {
  const gl::Buffer* buffers[] = {&positions_, &velocities_, &rest_local_, &rest_edge_, &offsets_, &order_};
  for (GLuint i = 0; i < std::size(buffers); ++i) buffers[i]->bindStorage(i);
  guides_.bindStorage(8);
}

void GpuStrands::step(const StepInput& input) {
  uploaded_.clear();
  if (vertices_ == 0) return;
  if (!uploads_->holds(input.primitives.size())) {  // more bodies than ever before
    glFinish();
    uploads_.emplace(strands_, 2 * input.primitives.size());
  }
  uploads_->write(input);
  bind();
  for (const Group& group : groups_) {
    group.program.use();
    const GLuint wide = std::min(group.workgroups, kMaxGroupsPerAxis);
    glDispatchCompute(wide, (group.workgroups + wide - 1) / wide, 1);
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  uploads_->finish();
  readback_.copyFrom(guides_);
  glFlush();
}

std::span<const Vec3> GpuStrands::guides() {
  if (!uploaded_.empty() || vertices_ == 0) return uploaded_;
  return readback_.newest();
}

}  // namespace strandcast::gpu
