// Triangle meshes from glTF 2.0: every triangle primitive of the scene, placed by its nodes.
#include <fmt/format.h>

#include <map>
#include <vector>

#include "groom/gltf_document.h"
#include "groom/gltf_mesh.h"
#include "groom/mesh_file.h"

namespace strandcast {
namespace {

using nlohmann::json;
using Transform = Eigen::Matrix<float, 4, 4, Eigen::DontAlign>;

enum PrimitiveMode : uint64_t { kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

/// The corners of triangle `t` of a primitive, as places in its list of indices; the specification's winding.
std::array<uint64_t, 3> corners(uint64_t mode, uint64_t t) {
  if (mode == kTriangleFan) return {0, t + 1, t + 2};
  if (mode == kTriangleStrip) return {t, t + 1 + t % 2, t + 2 - t % 2};
  return {3 * t, 3 * t + 1, 3 * t + 2};
}

class SceneReader {
 public:
  explicit SceneReader(const GltfDocument& document) : document_(document) {
    const auto nodes = document.root().find("nodes");
    if (nodes != document.root().end() && nodes->is_array()) visited_.resize(nodes->size());
  }

  TriangleMesh read() {
    struct Visit {
      uint64_t node;
      Transform to_world;
    };
    std::vector<Visit> stack;
    for (const uint64_t root : rootNodes()) stack.push_back({root, Transform::Identity()});
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const json& node = document_.entry("nodes", visit.node, "a scene or node");
      const std::string part = fmt::format("nodes[{}]", visit.node);
      if (visited_[visit.node]) document_.fail("the node has two parents, or is its own", part);
      visited_[visit.node] = true;
      const Transform to_world = visit.to_world * localTransform(node, part);
      if (const auto mesh = document_.unsignedMember(node, "mesh", part)) {
        // The specification places a skinned mesh by its joints alone; at rest that is where its vertices
        // are.
        addMesh(*mesh, node.contains("skin") ? Transform(Transform::Identity()) : to_world, part);
      }
      for (const uint64_t child : nodeList(node, "children", part)) stack.push_back({child, to_world});
    }
    if (mesh_.triangles.empty())
      document_.fail("the scene has no triangles", "scenes", "export the body as a mesh");
    return std::move(mesh_);
  }

 private:
  std::vector<uint64_t> nodeList(const json& object, const char* key, const std::string& part) const {
    std::vector<uint64_t> nodes;
    const auto list = object.find(key);
    if (list == object.end()) return nodes;
    if (!list->is_array()) document_.fail(fmt::format("{} is not an array", key), part);
    for (const json& node : *list) {
      if (!node.is_number_unsigned() || node.get<uint64_t>() >= visited_.size())
        document_.fail(fmt::format("{} names a node that does not exist", key), part);
      nodes.push_back(node.get<uint64_t>());
    }
    return nodes;
  }

  /// Of the default scene, or the first; of a file without scenes, the nodes that are nobody's children.
  std::vector<uint64_t> rootNodes() const {
    if (document_.root().contains("scenes")) {
      const uint64_t scene = document_.unsignedMember(document_.root(), "scene", "scene").value_or(0);
      return nodeList(document_.entry("scenes", scene, "scene"), "nodes", fmt::format("scenes[{}]", scene));
    }
    std::vector<bool> is_child(visited_.size());
    for (uint64_t n = 0; n < visited_.size(); ++n) {
      const std::string part = fmt::format("nodes[{}]", n);
      for (const uint64_t child : nodeList(document_.entry("nodes", n, part), "children", part))
        is_child[child] = true;
    }
    std::vector<uint64_t> roots;
    for (uint64_t n = 0; n < visited_.size(); ++n)
      if (!is_child[n]) roots.push_back(n);
    return roots;
  }

  Transform localTransform(const json& node, const std::string& part) const {
    if (const auto matrix = document_.numbers(node, "matrix", 16, part))
      return Eigen::Map<const Eigen::Matrix4f>(matrix->data());  // column-major, as Eigen is
    Eigen::Affine3f local = Eigen::Affine3f::Identity();
    if (const auto t = document_.numbers(node, "translation", 3, part))
      local.translate(Eigen::Vector3f((*t)[0], (*t)[1], (*t)[2]));
    if (const auto r = document_.numbers(node, "rotation", 4, part)) {
      const Eigen::Quaternionf rotation((*r)[3], (*r)[0], (*r)[1], (*r)[2]);
      if (!(rotation.norm() > 0)) document_.fail("the rotation has no length", part);
      local.rotate(rotation.normalized());
    }
    if (const auto s = document_.numbers(node, "scale", 3, part))
      local.scale(Eigen::Vector3f((*s)[0], (*s)[1], (*s)[2]));
    return local.matrix();
  }

  void addMesh(uint64_t mesh_index, const Transform& to_world, const std::string& asked_by) {
    const std::string part = fmt::format("meshes[{}]", mesh_index);
    const json& mesh = document_.entry("meshes", mesh_index, asked_by);
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array())
      document_.fail("the mesh has no primitives", part);
    std::map<uint64_t, uint32_t>
        first_vertex;  // accessor of positions -> its first vertex; primitives may share one
    for (size_t p = 0; p < primitives->size(); ++p)
      addPrimitive((*primitives)[p], to_world, fmt::format("{}.primitives[{}]", part, p), first_vertex);
  }

  void addPrimitive(const json& primitive, const Transform& to_world, const std::string& part,
                    std::map<uint64_t, uint32_t>& first_vertex) {
    if (!primitive.is_object()) document_.fail("the primitive is not an object", part);
    const uint64_t mode = document_.unsignedMember(primitive, "mode", part).value_or(kTriangles);
    if (mode < kTriangles) return;  // points and lines
    if (mode > kTriangleFan) document_.fail(fmt::format("there is no primitive mode {}", mode), part);
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object())
      document_.fail("it has no attributes", part);
    const auto accessor = document_.unsignedMember(*attributes, "POSITION", part);
    if (!accessor)
      document_.fail("the primitive has no plain positions", part, "export without mesh compression");
    const uint64_t vertices = document_.accessorCount(*accessor);
    auto known = first_vertex.find(*accessor);
    if (known == first_vertex.end())
      known = first_vertex.emplace(*accessor, addVertices(*accessor, vertices, to_world, part)).first;

    const auto index_accessor = document_.unsignedMember(primitive, "indices", part);
    const std::vector<uint32_t> indices =
        index_accessor ? document_.indices(*index_accessor) : std::vector<uint32_t>();
    const uint64_t count = index_accessor ? indices.size() : vertices;
    const uint64_t triangles = mode == kTriangles ? count / 3 : (count < 3 ? 0 : count - 2);
    spend(triangles_spent_, triangles + 1, part);
    const bool mirrored = to_world.topLeftCorner<3, 3>().determinant() < 0;
    for (uint64_t t = 0; t < triangles; ++t) {
      std::array<uint32_t, 3> triangle;
      for (int c = 0; c < 3; ++c) {
        const uint64_t place = corners(mode, t)[c];
        const uint64_t index = index_accessor ? indices[place] : place;
        if (index >= vertices)
          document_.fail(fmt::format("index {} is out of range, there are {} vertices", index, vertices),
                         part);
        triangle[c] = known->second + static_cast<uint32_t>(index);
      }
      if (mirrored) std::swap(triangle[1], triangle[2]);
      if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
        mesh_.triangles.push_back(triangle);
    }
  }

  uint32_t addVertices(uint64_t accessor, uint64_t count, const Transform& to_world,
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
  void spend(uint64_t& spent, uint64_t elements, const std::string& part) const {
    spent += elements;
    if (spent > document_.bufferBytes())
      document_.fail("the scene repeats its meshes too often", part, "export the body as one mesh");
  }

  const GltfDocument& document_;
  std::vector<bool> visited_;
  uint64_t vertices_spent_ = 0;
  uint64_t triangles_spent_ = 0;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name,
                          const std::optional<std::filesystem::path>& folder) {
  const GltfDocument document(bytes, name, folder);
  TriangleMesh mesh = SceneReader(document).read();
  mesh.name = name;
  computeNormals(mesh);
  return mesh;
}

TriangleMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name) {
  return readGltfMesh(bytes, name, std::nullopt);
}

}  // namespace strandcast
