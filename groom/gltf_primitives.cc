#include "groom/gltf_primitives.h"

#include <fmt/format.h>

namespace strandcast {
namespace {

using nlohmann::json;

enum PrimitiveMode : uint64_t { kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

/// The corners of triangle `t` of a primitive, as places in its list of indices; the specification's winding.
std::array<uint64_t, 3> corners(uint64_t mode, uint64_t t) {
  if (mode == kTriangleFan) return {0, t + 1, t + 2};
  if (mode == kTriangleStrip) return {t, t + 1 + t % 2, t + 2 - t % 2};
  return {3 * t, 3 * t + 1, 3 * t + 2};
}

}  // namespace

void GltfPrimitives::add(uint64_t mesh_index, const GltfTransform& to_world, bool mirrored,
                         const std::string& asked_by, const VerticesAdded& added) {
  const std::string part = fmt::format("meshes[{}]", mesh_index);
  const json& mesh = document_.entry("meshes", mesh_index, asked_by);
  const auto primitives = mesh.find("primitives");
  if (primitives == mesh.end() || !primitives->is_array()) document_.fail("the mesh has no primitives", part);
  Shared shared;
  for (size_t p = 0; p < primitives->size(); ++p)
    addPrimitive((*primitives)[p], to_world, mirrored, fmt::format("{}.primitives[{}]", part, p), added,
                 shared);
}

TriangleMesh GltfPrimitives::take() {
  if (mesh_.triangles.empty())
    document_.fail("the scene has no triangles", "scenes", "export the body as a mesh");
  return std::move(mesh_);
}

void GltfPrimitives::addPrimitive(const json& primitive, const GltfTransform& to_world, bool mirrored,
                                  const std::string& part, const VerticesAdded& added, Shared& shared) {
  if (!primitive.is_object()) document_.fail("the primitive is not an object", part);
  const uint64_t mode = document_.unsignedMember(primitive, "mode", part).value_or(kTriangles);
  if (mode < kTriangles) return;  // points and lines
  if (mode > kTriangleFan) document_.fail(fmt::format("there is no primitive mode {}", mode), part);
  const auto attributes = primitive.find("attributes");
  if (attributes == primitive.end() || !attributes->is_object()) document_.fail("it has no attributes", part);
  const auto accessor = document_.unsignedMember(*attributes, "POSITION", part);
  if (!accessor)
    document_.fail("the primitive has no plain positions", part, "export without mesh compression");
  const uint64_t vertices = document_.accessorCount(*accessor);
  const auto skin = [&](const char* key) {
    const auto member = added ? document_.unsignedMember(*attributes, key, part) : std::nullopt;
    return member ? *member + 1 : 0;
  };
  const auto [known, is_new] =
      shared.try_emplace(std::tuple(*accessor, skin("JOINTS_0"), skin("WEIGHTS_0")), 0);
  if (is_new) {
    known->second = addVertices(*accessor, vertices, to_world, part);
    if (added) added(*attributes, vertices, part);
  }

  const auto index_accessor = document_.unsignedMember(primitive, "indices", part);
  const std::vector<uint32_t> indices =
      index_accessor ? document_.indices(*index_accessor) : std::vector<uint32_t>();
  const uint64_t count = index_accessor ? indices.size() : vertices;
  const uint64_t triangles = mode == kTriangles ? count / 3 : (count < 3 ? 0 : count - 2);
  spend(triangles_spent_, triangles + 1, part);
  for (uint64_t t = 0; t < triangles; ++t) {
    std::array<uint32_t, 3> triangle;
    for (int c = 0; c < 3; ++c) {
      const uint64_t place = corners(mode, t)[c];
      const uint64_t index = index_accessor ? indices[place] : place;
      if (index >= vertices)
        document_.fail(fmt::format("index {} is out of range, there are {} vertices", index, vertices), part);
      triangle[c] = known->second + static_cast<uint32_t>(index);
    }
    if (mirrored) std::swap(triangle[1], triangle[2]);
    if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
      mesh_.triangles.push_back(triangle);
  }
}

uint32_t GltfPrimitives::addVertices(uint64_t accessor, uint64_t count, const GltfTransform& to_world,
                                     const std::string& part) {
  const auto first = static_cast<uint32_t>(mesh_.positions.size());
  spend(vertices_spent_, count, part);
  for (const Vec3& point : document_.positions(accessor)) {
    const Vec3 placed = (to_world * point.homogeneous()).head<3>();
    if (!placed.allFinite()) document_.fail("a vertex is placed at no finite point", part);
    mesh_.positions.push_back(placed);
  }
  return first;
}

/// Nodes and primitives may use the same data many times over. A vertex takes twelve bytes of a buffer and
/// a triangle six, so a limit of one per byte leaves room for honest repetition and none for a small file
/// that fills the memory.
void GltfPrimitives::spend(uint64_t& spent, uint64_t elements, const std::string& part) const {
  spent += elements;
  if (spent > document_.bufferBytes())
    document_.fail("the scene repeats its meshes too often", part, "export the body as one mesh");
}

}  // namespace strandcast
