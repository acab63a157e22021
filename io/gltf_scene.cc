#include "io/gltf_scene.h"

#include <fmt/format.h>

#include "io/gltf_document.h"

namespace strandcast {
namespace {

using nlohmann::json;

size_t nodeCount(const GltfDocument& document) {
  const auto nodes = document.root().find("nodes");
  return nodes != document.root().end() && nodes->is_array() ? nodes->size() : 0;
}

std::vector<uint64_t> nodeList(const GltfDocument& document, const json& object, const char* key,
                               const std::string& part) {
  std::vector<uint64_t> nodes;
  const auto list = object.find(key);
  if (list == object.end()) return nodes;
  if (!list->is_array()) document.fail(fmt::format("{} is not an array", key), part);
  for (const json& node : *list) {
    if (!node.is_number_unsigned() || node.get<uint64_t>() >= nodeCount(document))
      document.fail(fmt::format("{} names a node that does not exist", key), part);
    nodes.push_back(node.get<uint64_t>());
  }
  return nodes;
}

/// Roots of the scene; in a file without scenes, all nodes that are no node's child.
std::vector<uint64_t> rootNodes(const GltfDocument& document) {
  if (document.root().contains("scenes")) {
    const uint64_t scene = document.unsignedMember(document.root(), "scene", "scene").value_or(0);
    return nodeList(document, document.entry("scenes", scene, "scene"), "nodes",
                    fmt::format("scenes[{}]", scene));
  }
  std::vector<bool> is_child(nodeCount(document));
  for (uint64_t n = 0; n < is_child.size(); ++n) {
    const std::string part = gltfNodePart(n);
    for (const uint64_t child : nodeList(document, document.entry("nodes", n, part), "children", part))
      is_child[child] = true;
  }
  std::vector<uint64_t> roots;
  for (uint64_t n = 0; n < is_child.size(); ++n)
    if (!is_child[n]) roots.push_back(n);
  return roots;
}

}  // namespace

std::string gltfNodePart(uint64_t node) { return fmt::format("nodes[{}]", node); }

std::optional<Placement> gltfNodeMatrix(const GltfDocument& document, const json& node,
                                        const std::string& part) {
  const auto numbers = document.numbers(node, "matrix", 16, part);
  if (!numbers) return {};
  Placement matrix = Placement::Identity();
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 3; ++r)
      matrix.matrix()(r, c) = static_cast<double>((*numbers)[static_cast<size_t>(4 * c + r)]);
  return matrix;
}

JointTransform gltfNodeTransform(const GltfDocument& document, const json& node, const std::string& part) {
  JointTransform out;
  if (const auto t = document.numbers(node, "translation", 3, part))
    out.translation = Vec3((*t)[0], (*t)[1], (*t)[2]);
  if (const auto r = document.numbers(node, "rotation", 4, part)) {
    const Eigen::Quaterniond rotation((*r)[3], (*r)[0], (*r)[1], (*r)[2]);
    if (!(rotation.norm() > 0)) document.fail("the rotation has no length", part);
    out.rotation = rotation.normalized().cast<float>();
  }
  if (const auto s = document.numbers(node, "scale", 3, part)) out.scale = Vec3((*s)[0], (*s)[1], (*s)[2]);
  return out;
}

bool hasInstances(const json& node) { return extensionOf(node, "EXT_mesh_gpu_instancing") != nullptr; }

std::vector<JointTransform> gltfInstances(const GltfDocument& document, const json& node,
                                          const std::string& part) {
  const json* extension = extensionOf(node, "EXT_mesh_gpu_instancing");
  if (extension == nullptr) return {JointTransform{}};
  const std::string where = part + ".extensions.EXT_mesh_gpu_instancing";
  const auto attributes = extension->find("attributes");
  if (attributes == extension->end() || !attributes->is_object())
    document.fail("it has no attributes", where);
  std::vector<JointTransform> out;
  bool is_first = true;
  const auto read = [&](const char* key, const char* type, const auto& take) {
    const auto accessor = document.unsignedMember(*attributes, key, where);
    if (!accessor) return;
    const uint64_t count = document.accessorCount(*accessor, type);
    if (count > document.limits().instances)
      document.fail(
          fmt::format("{} instances of a mesh are more than {}", count, document.limits().instances), where,
          "export the body as one mesh");
    if (is_first) out.resize(count);
    is_first = false;
    if (count != out.size()) document.fail("its attributes are not of one count", where);
    const std::vector<float> values = document.floats(*accessor, type, true);
    const size_t each = count > 0 ? values.size() / count : 0;
    for (size_t i = 0; i < count; ++i) take(out[i], values.data() + each * i);
  };
  read("TRANSLATION", "VEC3",
       [](JointTransform& to, const float* v) { to.translation = Vec3(v[0], v[1], v[2]); });
  read("ROTATION", "VEC4", [&](JointTransform& to, const float* v) {
    const Eigen::Quaterniond rotation(v[3], v[0], v[1], v[2]);
    if (!(rotation.norm() > 0)) document.fail("a rotation has no length", where);
    to.rotation = rotation.normalized().cast<float>();
  });
  read("SCALE", "VEC3", [](JointTransform& to, const float* v) { to.scale = Vec3(v[0], v[1], v[2]); });
  if (is_first) return {JointTransform{}};  // no attribute places the instances: they coincide
  return out;
}

std::vector<GltfNode> sceneNodes(const GltfDocument& document, GltfReport& report) {
  if (const auto scenes = document.root().find("scenes");
      scenes != document.root().end() && scenes->is_array() && scenes->size() > 1)
    report.addOmission(scenes->size() == 2 ? std::string("another scene")
                                           : fmt::format("{} other scenes", scenes->size() - 1));
  std::vector<bool> visited(nodeCount(document));
  std::vector<GltfNode> out, stack;
  for (const uint64_t root : rootNodes(document)) stack.push_back({root, -1});
  while (!stack.empty()) {
    GltfNode visit = stack.back();
    stack.pop_back();
    const std::string part = gltfNodePart(visit.index);
    const json& node = document.entry("nodes", visit.index, "a scene or node");
    if (visited[visit.index]) document.fail("the node has two parents, or is its own", part);
    visited[visit.index] = true;
    if (const json* visibility = extensionOf(node, "KHR_node_visibility")) {
      const auto visible = visibility->find("visible");
      if (visible != visibility->end() && *visible == false) visit.is_visible = false;
    }
    if (!visit.is_visible && node.contains("mesh")) report.addOmission("hidden meshes", part);
    const int place = static_cast<int>(out.size());
    out.push_back(visit);
    for (const uint64_t child : nodeList(document, node, "children", part))
      stack.push_back({child, place, visit.is_visible});
  }
  return out;
}

}  // namespace strandcast
