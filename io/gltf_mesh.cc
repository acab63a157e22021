// Triangle meshes from glTF 2.0: primitives with their morph targets, placed by the nodes of the scene or by
// the joints of its skin.
#include "io/gltf_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "io/gltf_document.h"
#include "io/gltf_scene.h"
#include "io/mesh_file.h"

namespace strandcast {
namespace {

using nlohmann::json;

enum PrimitiveMode : uint64_t { kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

/// Corners of triangle `t` of a primitive, as positions in its list of indices, with the specification's
/// winding.
std::array<uint64_t, 3> corners(uint64_t mode, uint64_t t) {
  if (mode == kTriangleFan) return {0, t + 1, t + 2};
  if (mode == kTriangleStrip) return {t, t + 1 + t % 2, t + 2 - t % 2};
  return {3 * t, 3 * t + 1, 3 * t + 2};
}

const json& primitivesOf(const GltfDocument& document, uint64_t mesh_index, const std::string& asked_by) {
  const json& mesh = document.entry("meshes", mesh_index, asked_by);
  const auto primitives = mesh.find("primitives");
  if (primitives == mesh.end() || !primitives->is_array())
    document.fail("the mesh has no primitives", fmt::format("meshes[{}]", mesh_index));
  return *primitives;
}

/// Refuses a primitive that Draco compresses, unless it has an uncompressed fallback. Without one its
/// accessors have no data.
void refuseDraco(const GltfDocument& document, const json& primitive, const std::string& part) {
  const char* draco = "KHR_draco_mesh_compression";
  if (extensionOf(primitive, draco) == nullptr) return;
  const auto attributes = primitive.find("attributes");
  const auto has = [&](const json& object, const char* key) {
    const auto accessor = document.unsignedMember(object, key, part);
    if (!accessor) return false;
    const json& description = document.entry("accessors", *accessor, part);
    return description.contains("bufferView") || description.contains("sparse");
  };
  const bool plain = attributes != primitive.end() && attributes->is_object() &&
                     has(*attributes, "POSITION") &&
                     (!primitive.contains("indices") || has(primitive, "indices"));
  if (!plain)
    document.fail(fmt::format("the primitive is compressed with {}, which is not read", draco), part,
                  kUncompressed);
}

/// Count that the accessor of an object's POSITION states; empty if the accessor is damaged, which is
/// reported where it is read.
std::optional<uint64_t> statedCount(const GltfDocument& document, const json& object) {
  const auto accessor = object.is_object() ? object.find("POSITION") : object.end();
  if (!object.is_object() || accessor == object.end() || !accessor->is_number_unsigned()) return {};
  const auto list = document.root().find("accessors");
  const auto index = accessor->get<uint64_t>();
  if (list == document.root().end() || !list->is_array() || index >= list->size()) return {};
  const json& description = (*list)[index];
  const auto count = description.is_object() ? description.find("count") : description.end();
  if (!description.is_object() || count == description.end() || !count->is_number_unsigned()) return {};
  return count->get<uint64_t>();
}

}  // namespace

size_t GltfMorphs::targetsOf(uint64_t mesh, const std::string& part) {
  const auto [known, is_new] = targets_.try_emplace(mesh, 0);
  if (!is_new) return known->second;
  const json& primitives = primitivesOf(document_, mesh, part);
  for (size_t p = 0; p < primitives.size(); ++p) {
    if (!primitives[p].is_object()) continue;
    const auto list = primitives[p].find("targets");
    if (list == primitives[p].end() || !list->is_array()) continue;
    known->second = std::max(known->second, list->size());
    reportTargetCounts(primitives[p], *list, fmt::format("meshes[{}].primitives[{}]", mesh, p));
  }
  return known->second;
}

/// Called once per mesh, whether its targets are used or not.
void GltfMorphs::reportTargetCounts(const json& primitive, const json& targets, const std::string& part) {
  const auto attributes = primitive.find("attributes");
  const auto vertices = attributes == primitive.end() ? std::nullopt : statedCount(document_, *attributes);
  for (size_t t = 0; vertices && t < targets.size(); ++t)
    if (statedCount(document_, targets[t]).value_or(*vertices) != *vertices)
      report_.addOmission("morph targets of another number of vertices",
                          fmt::format("{}.targets[{}]", part, t));
}

GltfMorph GltfMorphs::of(const json& node, uint64_t mesh, const std::string& part) {
  const size_t targets = targetsOf(mesh, part);
  const bool own = node.contains("weights");
  const std::string where = own ? part : fmt::format("meshes[{}]", mesh);
  GltfMorph out;
  if (const auto weights =
          document_.numbers(own ? node : document_.entry("meshes", mesh, part), "weights", where)) {
    if (weights->size() != targets)
      report_.warn("weights that are not as many as the morph targets: the missing are taken as 0", where);
    out.weights = *weights;
  }
  out.weights.resize(targets, 0.0f);
  return out;
}

std::map<uint64_t, uint64_t> gltfSets(const GltfDocument& document, const json& attributes,
                                      const std::string& beginning, const std::string& part) {
  std::map<uint64_t, uint64_t> sets;
  for (const auto& attribute : attributes.items()) {
    const std::string& key = attribute.key();
    if (!key.starts_with(beginning) || key.size() == beginning.size() || key.size() > beginning.size() + 3)
      continue;
    if (!std::all_of(key.begin() + static_cast<std::ptrdiff_t>(beginning.size()), key.end(),
                     [](char c) { return c >= '0' && c <= '9'; }))
      continue;
    sets[std::stoul(key.substr(beginning.size()))] =
        document.unsignedMember(attributes, key.c_str(), part).value();
  }
  return sets;
}

void GltfPrimitives::add(uint64_t mesh_index, const GltfMorph& morph, const GltfTransform& to_world,
                         bool mirrored, const std::string& asked_by, const VerticesAdded& added) {
  const json& primitives = primitivesOf(document_, mesh_index, asked_by);
  Shared shared;
  for (size_t p = 0; p < primitives.size(); ++p)
    addPrimitive(primitives[p], morph, to_world, mirrored,
                 fmt::format("meshes[{}].primitives[{}]", mesh_index, p), added, shared);
}

TriangleMesh GltfPrimitives::take() {
  if (mesh_.triangles.empty()) {
    const std::string without = report_.omissionsLine();
    document_.fail("the scene has no triangles" + (without.empty() ? "" : ", read " + without), "scenes",
                   "export the body as a mesh");
  }
  return std::move(mesh_);
}

void GltfPrimitives::addPrimitive(const json& primitive, const GltfMorph& morph,
                                  const GltfTransform& to_world, bool mirrored, const std::string& part,
                                  const VerticesAdded& added, Shared& shared) {
  if (!primitive.is_object()) document_.fail("the primitive is not an object", part);
  spend(primitives_spent_, 1, document_.limits().primitives, "primitives", part);
  const uint64_t mode = document_.unsignedMember(primitive, "mode", part).value_or(kTriangles);
  if (mode < kTriangles) return report_.addOmission("primitives of points or lines", part);
  if (mode > kTriangleFan)
    return report_.addOmission(fmt::format("primitives of the unknown mode {}", mode), part);
  refuseDraco(document_, primitive, part);
  const auto attributes = primitive.find("attributes");
  if (attributes == primitive.end() || !attributes->is_object())
    return report_.addOmission("primitives without attributes", part);
  const auto accessor = document_.unsignedMember(*attributes, "POSITION", part);
  if (!accessor) return report_.addOmission("primitives without POSITION", part);
  const uint64_t vertices = document_.accessorCount(*accessor);
  if (vertices == 0) return report_.addOmission("primitives whose accessor of positions is empty", part);
  const auto indices = document_.unsignedMember(primitive, "indices", part);
  if (indices && document_.accessorCount(*indices, "SCALAR") == 0)
    return report_.addOmission("primitives whose accessor of indices is empty", part);

  const std::vector<Target> targets = targetsOf(primitive, morph, vertices, part);
  std::vector<uint64_t> key{*accessor, targets.size()};
  for (const Target& target : targets) key.insert(key.end(), {target.number, target.accessor});
  if (added)
    for (const char* beginning : {"JOINTS_", "WEIGHTS_"})
      for (const auto& [number, set] : gltfSets(document_, *attributes, beginning, part))
        key.insert(key.end(), {beginning[0] == 'J' ? number : number + 1000, set});
  const auto [known, is_new] = shared.try_emplace(std::move(key), 0);
  if (is_new) {
    Added made{*attributes, 0, vertices, part, {}};
    known->second = addVertices(*accessor, targets, morph, to_world, made);
    if (added) added(made);
  }
  addTriangles(primitive, mode, known->second, vertices, mirrored, part);
}

/// Targets that have a weight at rest or are played. A target that cannot be read is left out, and the rest
/// of the body stays usable.
std::vector<GltfPrimitives::Target> GltfPrimitives::targetsOf(const json& primitive, const GltfMorph& morph,
                                                              uint64_t vertices, const std::string& part) {
  std::vector<Target> out;
  const auto list = primitive.find("targets");
  if (list == primitive.end()) return out;
  if (!list->is_array()) {
    report_.addOmission("morph targets that are not in an array", part);
    return out;
  }
  for (size_t t = 0; t < list->size(); ++t) {
    if (morph.weights[t] == 0 && !morph.isPlayed(t)) continue;
    const std::string where = fmt::format("{}.targets[{}]", part, t);
    const json& target = (*list)[t];
    if (!target.is_object()) {
      report_.addOmission("morph targets that are not objects", where);
      continue;
    }
    const auto accessor = document_.unsignedMember(target, "POSITION", where);
    if (!accessor) continue;                             // a target of normals or colours only
    if (document_.accessorCount(*accessor) == vertices)  // GltfMorphs reports the others
      out.push_back({t, *accessor});
  }
  return out;
}

uint32_t GltfPrimitives::addVertices(uint64_t accessor, const std::vector<Target>& targets,
                                     const GltfMorph& morph, const GltfTransform& to_world, Added& added) {
  const auto first = static_cast<uint32_t>(mesh_.positions.size());
  added.first = first;
  spend(vertices_spent_, added.count, document_.limits().vertices, "vertices", added.part);
  spend(targets_spent_, added.count * targets.size(), document_.limits().target_vertices,
        "vertices of morph targets", added.part);
  std::vector<Vec3> points = document_.positions(accessor);
  for (const Target& target : targets) {
    std::vector<Vec3> moves = document_.positions(target.accessor);
    const float weight = morph.weights[target.number];
    if (weight != 0)
      for (size_t v = 0; v < points.size(); ++v) points[v] += weight * moves[v];
    if (morph.isPlayed(target.number)) added.moves.emplace_back(target.number, std::move(moves));
  }
  for (const Vec3& point : points) {
    const Vec3 placed = (to_world * point.homogeneous()).head<3>();
    if (!placed.allFinite()) document_.fail("a vertex is placed at no finite point", added.part);
    mesh_.positions.push_back(placed);
  }
  return first;
}

void GltfPrimitives::addTriangles(const json& primitive, uint64_t mode, uint32_t first, uint64_t vertices,
                                  bool mirrored, const std::string& part) {
  const auto accessor = document_.unsignedMember(primitive, "indices", part);
  const uint64_t count = accessor ? document_.accessorCount(*accessor, "SCALAR") : vertices;
  const uint64_t triangles = mode == kTriangles ? count / 3 : (count < 3 ? 0 : count - 2);
  if (const uint64_t rest = mode == kTriangles ? count % 3 : (count < 3 ? count : 0); rest > 0)
    report_.addOmission(
        fmt::format("{} left over after the last whole triangle", accessor ? "indices" : "vertices"), part);
  spend(triangles_spent_, triangles + 1, document_.limits().triangles, "triangles", part);
  const std::vector<uint32_t> indices = accessor ? document_.indices(*accessor) : std::vector<uint32_t>();
  for (uint64_t t = 0; t < triangles; ++t) {
    std::array<uint32_t, 3> triangle;
    for (int c = 0; c < 3; ++c) {
      const uint64_t place = corners(mode, t)[c];
      const uint64_t index = accessor ? indices[place] : place;
      if (index >= vertices)
        document_.fail(fmt::format("index {} is out of range, there are {} vertices", index, vertices), part);
      triangle[c] = first + static_cast<uint32_t>(index);
    }
    if (mirrored) std::swap(triangle[1], triangle[2]);
    if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
      mesh_.triangles.push_back(triangle);
  }
}

/// Adds `elements` to `spent` and fails above `limit`: nodes and primitives may repeat the same data many
/// times.
void GltfPrimitives::spend(uint64_t& spent, uint64_t elements, uint64_t limit, const char* what,
                           const std::string& part) const {
  spent += elements;
  if (spent > limit)
    document_.fail(fmt::format("the scene repeats its meshes into more than {} {}", limit, what), part,
                   "export fewer copies");
}

namespace {

TriangleMesh placedByNodes(const GltfDocument& document, const std::vector<GltfNode>& nodes,
                           GltfReport& report) {
  GltfPrimitives primitives(document, report);
  GltfMorphs morphs(document, report);
  std::vector<Placement> to_world;
  for (const GltfNode& visit : nodes) {
    const json& node = document.entry("nodes", visit.index, "a scene or node");
    const std::string part = gltfNodePart(visit.index);
    const Placement parent =
        visit.parent < 0 ? Placement::Identity() : to_world[static_cast<size_t>(visit.parent)];
    const std::optional<Placement> matrix = gltfNodeMatrix(document, node, part);
    to_world.push_back(parent * (matrix ? *matrix : gltfNodeTransform(document, node, part).placement()));
    const auto mesh = document.unsignedMember(node, "mesh", part);
    if (!mesh || !visit.is_visible) continue;
    const GltfMorph morph = morphs.of(node, *mesh, part);
    const bool is_copied = hasInstances(node);
    const std::vector<JointTransform> instances = gltfInstances(document, node, part);
    if (instances.empty()) report.addOmission("meshes of no instance", part);
    for (const JointTransform& instance : instances) {
      GltfTransform place = GltfTransform::Identity();
      const Placement at = is_copied ? to_world.back() * instance.placement() : to_world.back();
      place.topRows<3>() = at.matrix().cast<float>();
      primitives.add(*mesh, morph, place, place.topLeftCorner<3, 3>().determinant() < 0, part);
    }
  }
  return primitives.take();
}

}  // namespace

std::string gltfNodeName(const GltfDocument& document, uint64_t node) {
  const std::string part = gltfNodePart(node);
  const json& description = document.entry("nodes", node, part);
  const auto name = description.find("name");
  return name != description.end() && name->is_string() ? name->get<std::string>() : part;
}

std::string gltfTargetName(const GltfDocument& document, uint64_t node, size_t target) {
  const std::string part = gltfNodePart(node);
  const auto mesh = document.unsignedMember(document.entry("nodes", node, part), "mesh", part);
  const json& description = document.entry("meshes", mesh.value(), part);
  const auto extras = description.find("extras");
  if (extras != description.end() && extras->is_object())
    if (const auto names = extras->find("targetNames");
        names != extras->end() && names->is_array() && target < names->size() && (*names)[target].is_string())
      return printable((*names)[target].get_ref<const std::string&>());
  return fmt::format("target {}", target);
}

BodyRig gltfRig(const GltfDocument& document, const std::vector<GltfNode>& nodes) {
  GltfReport told;  // by who reads the meshes
  GltfMorphs morphs(document, told);
  BodyRig rig;
  std::set<std::string> joints, targets;
  std::set<uint64_t> meshes;  // many nodes may have one
  bool is_skinned = false;
  for (const GltfNode& visit : nodes) {
    const json& node = document.entry("nodes", visit.index, "a scene or node");
    const std::string part = gltfNodePart(visit.index), name = gltfNodeName(document, visit.index);
    if (joints.insert(name).second) rig.joints.push_back(name);
    const auto mesh = document.unsignedMember(node, "mesh", part);
    if (!mesh || !visit.is_visible) continue;
    is_skinned = is_skinned || node.contains("skin");
    if (!meshes.insert(*mesh).second) continue;
    const size_t count = morphs.of(node, *mesh, part).weights.size();
    for (size_t t = 0; t < count; ++t)
      if (const std::string target = gltfTargetName(document, visit.index, t); targets.insert(target).second)
        rig.targets.push_back(target);
  }
  if (!is_skinned) rig.joints.clear();
  return rig;
}

ReadMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name,
                      const ReadBeside& read_beside, const GltfLimits& limits) {
  const GltfDocument document(bytes, name, read_beside, limits);
  GltfReport report, of_nodes;
  reportAsset(document, of_nodes);
  const std::vector<GltfNode> nodes = sceneNodes(document, of_nodes);
  const bool skinned = std::any_of(nodes.begin(), nodes.end(), [&](const GltfNode& visit) {
    const json& node = document.entry("nodes", visit.index, "a scene or node");
    return node.contains("mesh") && node.contains("skin");
  });
  TriangleMesh mesh = skinned ? skinAtRest(document, report) : placedByNodes(document, nodes, of_nodes);
  mesh.name = name;
  computeNormals(mesh);
  return {std::move(mesh), (skinned ? report : of_nodes).report(), gltfRig(document, nodes)};
}

ReadMesh readGltfMesh(std::span<const std::byte> bytes, const std::string& name, const GltfLimits& limits) {
  return readGltfMesh(bytes, name, ReadBeside(), limits);
}

}  // namespace strandcast
