#include "render/bound_hairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>

#include "core/error.h"
#include "core/hash.h"
#include "kernels/scalar_hair.h"
#include "render/hair_selection.h"
#include "render/scene_block.h"
#include "render/shaders.h"

namespace strandcast {
namespace {

/// Arc length up to each vertex, m.
std::vector<float> runsOf(std::span<const Vec3> points) {
  std::vector<float> runs(points.size(), 0);
  for (size_t i = 1; i < points.size(); ++i) runs[i] = runs[i - 1] + (points[i] - points[i - 1]).norm();
  return runs;
}

Vec3 pointAt(std::span<const Vec3> points, std::span<const float> runs, float run) {
  const auto above = static_cast<size_t>(std::upper_bound(runs.begin(), runs.end(), run) - runs.begin());
  if (above >= points.size()) return points.back();
  const float part = (run - runs[above - 1]) / std::max(runs[above] - runs[above - 1], 1e-9f);
  return points[above - 1] + part * (points[above] - points[above - 1]);
}

/// m, the largest distance of a hair from the guides that carry it, at rest. It stays the largest in motion,
/// because nodes carry hairs rigidly.
float reachOf(std::span<const Vec3> hair, const Hair& bound, const StrandSet& guides,
              const std::vector<std::vector<float>>& guide_runs) {
  const std::vector<float> runs = runsOf(hair);
  float reach = 0;
  for (const uint32_t guide : bound.guides) {
    const std::span<const float> along = guide_runs[guide];
    if (along.empty()) continue;
    const bool longer = along.back() > runs.back();
    const float stretch = longer || !(runs.back() > 0) ? 1 : along.back() / runs.back();
    for (size_t j = 0; j < hair.size(); ++j)
      reach = std::max(reach, (hair[j] - pointAt(guides.strand(guide), along, stretch * runs[j])).norm());
  }
  return reach;
}

/// Uniform in [-1, 1): the n-th random number of a hair.
float randomOf(uint64_t hair, uint64_t n) {
  return static_cast<float>(splitMix64(splitMix64(hair) + n * kSplitMixStep) >> 40) * 0x1p-23f - 1;
}

constexpr uint32_t kHasColor = 1u << 24;  // in Hair::color

}  // namespace

std::vector<Hair> boundHairs(const HairDescription& description, const StrandSet& guides,
                             const HairGrowth& growth, float hair_width) {
  const StrandSet& strands = description.hairs;
  std::vector<std::vector<float>> guide_runs;
  for (size_t g = 0; g < guides.strands(); ++g) guide_runs.push_back(runsOf(guides.strand(g)));
  const ScalpPlaces guide_places(guides), own_places(strands);
  std::vector<Hair> hairs;
  hairs.reserve(strands.strands());
  for (size_t s = 0; s < strands.strands(); ++s) {
    const HairBinding& binding = description.bindings[s];
    Hair hair{};
    for (size_t k = 0; k < 3; ++k) hair.guides[k] = binding.guides[binding.weight(k) > 0 ? k : 0];
    for (size_t k = 0; k < 2; ++k) hair.weights[k] = static_cast<float>(binding.weight(k + 1));
    hair.extent = hair.width = hair.importance = 1;
    hair.bound = static_cast<uint32_t>(s) + 1;
    hair.reach = reachOf(strands.strand(s), hair, guides, guide_runs);
    const uint64_t number = description.ids.empty() ? s : description.ids[s];
    const double turns = (std::numbers::phi - 1) * static_cast<double>(s);
    hair.dither = std::min(static_cast<float>(turns - std::floor(turns)), 1 - 0x1p-24f);
    hair.first_sample = 0.5f + 0.5f * randomOf(number, 0);
    if (!description.colours.empty()) {
      const std::array<uint8_t, 3>& color = description.colours[s];
      hair.color = kHasColor | color[0] | color[1] << 8 | color[2] << 16;
    } else {
      hair.shade = 0.65f * randomOf(number, 1) + 0.35f * randomOf(~uint64_t{hair.guides[0]}, 1);
      hair.warmth = randomOf(number, 2);
    }
    if (!strands.radii.empty()) {
      const auto first = strands.radii.begin() + strands.offsets[s];
      hair.width = 2 * *std::max_element(first, first + strands.verticesOf(s)) / hair_width;
    }
    const uint32_t own[3] = {static_cast<uint32_t>(s), static_cast<uint32_t>(s), static_cast<uint32_t>(s)};
    const float whole[2] = {0, 0};
    const Vec2 place =
        strands.uvs.empty() ? guide_places.of(hair.guides, hair.weights) : own_places.of(own, whole);
    if (growth.thickness) hair.width *= growth.thickness->at(place);
    if (growth.importance) hair.importance = std::max(growth.importance->at(place), kLeastImportance);
    if (hair.width > 0) hairs.push_back(hair);
  }
  return hairs;
}

namespace {

/// The structs of shaders/bound_growth.comp, field for field.
struct BoundHair {
  uint32_t first, count;  // vertices
  float length;           // m, at rest
  uint32_t unused = 0;
};
struct BoundVertex {
  Vec3 position;  // m, at rest
  float along;    // fraction of the hair's length
  Vec3 tangent;   // unit, or zero where the hair has none
  float width;    // over the hair's full width
};
/// Follow all vertices, one for each, and one more where their number is odd: a vec4 has two.
struct BoundBodyNumbers {
  float rest_distance = 0;  // m, from bodies, at rest
  float closing = 0;        // on the first guide, 0 to 1; -1 where no body is near
};
static_assert(sizeof(BoundHair) == 16 && sizeof(BoundVertex) == 32 && sizeof(BoundBodyNumbers) == 8);

constexpr size_t kBoundGroupSize = 64;  // must equal local_size_x of bound_bodies.comp

void appendVertices(const StrandSet& hairs, size_t s, std::vector<BoundVertex>& vertices) {
  const std::span<const Vec3> points = hairs.strand(s);
  const std::vector<float> runs = runsOf(points);
  float widest = 0;
  if (!hairs.radii.empty())
    widest =
        *std::max_element(hairs.radii.begin() + hairs.offsets[s], hairs.radii.begin() + hairs.offsets[s + 1]);
  for (size_t j = 0; j < points.size(); ++j) {
    const float along = runs.back() > 0 ? runs[j] / runs.back()
                        : j > 0         ? static_cast<float>(j) / static_cast<float>(points.size() - 1)
                                        : 0;
    const Vec3 chord = points[std::min(j + 1, points.size() - 1)] - points[j == 0 ? 0 : j - 1];
    const Vec3 tangent = chord.norm() > 1e-12f ? Vec3(chord.normalized()) : Vec3(Vec3::Zero());
    const float width = widest > 0 ? hairs.radii[hairs.offsets[s] + j] / widest
                                   : static_cast<float>(kernels::f64::hairTaper(static_cast<double>(along)));
    vertices.push_back({points[j], along, tangent, width});
  }
}

}  // namespace

BoundHairs::BoundHairs(const StrandSet& hairs)
    : program_("bound hair growth", {{GL_COMPUTE_SHADER, shaders::kBoundGrowthComp}}) {
  all_vertices_ = hairs.vertices();
  hairs_ = hairs.strands();
  const size_t of_vertices = all_vertices_ * sizeof(BoundVertex);
  const size_t bytes = of_vertices + (all_vertices_ + all_vertices_ % 2) * sizeof(BoundBodyNumbers);
  GLint64 largest = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &largest);
  if (bytes > static_cast<size_t>(largest))
    throw Error("hairs are too large for the OpenGL device",
                std::to_string(hairs.vertices()) + " vertices need a buffer of " + std::to_string(bytes) +
                    " bytes, the device allows " + std::to_string(largest),
                "publish fewer hairs, or hairs of fewer vertices");
  std::vector<BoundHair> described;
  std::vector<BoundVertex> vertices;
  vertices.reserve(hairs.vertices());
  for (size_t s = 0; s < hairs.strands(); ++s) {
    const auto count = static_cast<uint32_t>(hairs.verticesOf(s));
    described.push_back({hairs.offsets[s], count, arcLength(hairs.strand(s))});
    appendVertices(hairs, s, vertices);
    vertices_ = std::max(vertices_, static_cast<int>(count));
  }
  hair_buffer_ = gl::Buffer(std::span<const BoundHair>(described));
  vertex_buffer_ = gl::Buffer(bytes, nullptr, GL_DYNAMIC_STORAGE_BIT);
  vertex_buffer_.write(std::span<const BoundVertex>(vertices));
}

const gl::Program& BoundHairs::program(bool among_bodies) const {
  const gl::Program& program = among_bodies ? *among_bodies_ : program_;
  program.set("vertex_count", static_cast<unsigned>(all_vertices_));
  return program;
}

void BoundHairs::measureRest() {
  const auto made = [](const char* name, const char* text, const char* defines) {
    return std::make_unique<gl::Program>(name,
                                         std::vector<gl::ShaderStage>{{GL_COMPUTE_SHADER, text, defines}});
  };
  if (!rest_) {
    among_bodies_ =
        made("bound hair growth among bodies", shaders::kBoundGrowthComp, "#define AMONG_BODIES\n");
    closing_ = made("bound hair and bodies", shaders::kBoundBodiesComp, "");
    rest_ = made("bound hair at rest and bodies", shaders::kBoundBodiesComp, "#define REST\n");
  }
  dispatch(*rest_, 0, hairs_);
}

void BoundHairs::computeClosing(size_t first, size_t count) const { dispatch(*closing_, first, count); }

void BoundHairs::dispatch(const gl::Program& program, size_t first, size_t count) const {
  program.set("vertex_count", static_cast<unsigned>(all_vertices_));
  program.set("first_hair", static_cast<unsigned>(first));
  program.set("hair_count", static_cast<unsigned>(count));
  program.use();
  glDispatchCompute(static_cast<GLuint>((count + kBoundGroupSize - 1) / kBoundGroupSize), 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void BoundHairs::bind() const {
  hair_buffer_.bindStorage(binding::kBoundHairs);
  vertex_buffer_.bindStorage(binding::kBoundVertices);
}

}  // namespace strandcast
