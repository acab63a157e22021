#include "service/show_fingerprint.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "core/contact_primitive.h"
#include "core/distance_field.h"
#include "core/hash.h"
#include "transport/chunks.h"

namespace strandcast {
namespace {

template <class Item>
void addAll(ContentHash& hash, const std::vector<Item>& items) {
  hash.add(items.size());
  hash.add(items.data(), items.size() * sizeof(Item));
}

void addCurve(ContentHash& hash, const RootTipCurve& curve) {
  for (const auto& knot : curve.knots) hash.add(knot);
}

void addMaterial(ContentHash& hash, const Material& m) {
  for (const float number :
       {m.youngs_modulus, m.poisson_ratio, m.radius, m.density, m.damping_scale, m.friction_scale, m.tether})
    hash.add(number);
  for (const RootTipCurve* const curve :
       {&m.radius_scale, &m.stiffness_scale, &m.density_scale, &m.air_drag_scale, &m.goal_scale,
        &m.damping_curve, &m.friction_curve})
    addCurve(hash, *curve);
}

/// Hashes a field by its grid alone: the mesh, hashed separately, and the grid determine its samples.
void addShape(ContentHash& hash, const ContactPrimitive& shape) {
  hash.add(shape.kind);
  for (const Vec3* const v : {&shape.a, &shape.b, &shape.extent}) hash.add(v->data(), sizeof(Vec3));
  for (const float number : {shape.radius, shape.radius_b, shape.friction}) hash.add(number);
  hash.add(shape.rotation.coeffs().data(), sizeof(Quat));
  if (shape.convex) addAll(hash, shape.convex->planes);
  if (!shape.field) return;
  const FieldGrid& grid = shape.field->grid;
  hash.add(grid.cell);
  hash.add(grid.band);
  hash.add(grid.origin);
  hash.add(grid.bricks);
}

ShowEntry entryOf(const std::string& what, double count, uint64_t hash) {
  return {ShowKind::kFingerprint,
          what,
          {count, static_cast<double>(hash >> 32), static_cast<double>(hash & 0xffffffff)}};
}

constexpr std::string_view kSceneMesh = "mesh of collider ", kAddedMesh = "mesh of added collider ";
constexpr const char* kUnnamedMeshes = "meshes of colliders without a name";

/// Prefixes the name; uses its hash where the text would be too long.
std::string named(std::string_view what, const std::string& name) {
  if (what.size() + name.size() <= kMaxTextBytes) return std::string(what) + name;
  ContentHash hash;
  hash.add(name.data(), name.size());
  return fmt::format("{}{:016x}", what, hash.value());
}

bool isMesh(const ShowEntry& entry) {
  return entry.name.starts_with(kSceneMesh) || entry.name == kUnnamedMeshes;
}

const ShowEntry* fingerprintNamed(const std::vector<ShowEntry>& entries, const std::string& name) {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const ShowEntry& entry) {
    return entry.kind == ShowKind::kFingerprint && entry.name == name;
  });
  return found == entries.end() ? nullptr : &*found;
}

}  // namespace

std::vector<ShowEntry> fingerprintOf(const Scene& scene, const Settings& settings) {
  const StrandSet& strands = scene.groom.strands;
  ContentHash solver, rest, materials, pins, body, colliders, motion;
  solver.add(settings.solver);
  solver.add(settings.sag_free);
  addAll(rest, strands.offsets);
  addAll(rest, strands.positions);
  addAll(rest, strands.pinned);
  for (const Material& material : scene.materials) addMaterial(materials, material);
  addAll(materials, strands.parts);
  for (const PinRule& pin : scene.pins) {
    pins.add(pin.bone.data(), pin.bone.size());
    pins.add(pin.from);
    pins.add(pin.to);
  }
  addAll(body, scene.body.positions);
  addAll(body, scene.body.triangles);
  addAll(body, scene.head_weights);
  for (const RigidBody& known : scene.bodies) {
    colliders.add(known.follows_head);
    for (const ContactPrimitive& shape : known.primitives) addShape(colliders, shape);
  }
  for (const auto& [name, id] : scene.named_bodies) colliders.add(name.data(), name.size());
  const std::string clip =
      settings.scene.motion + "\n" + (settings.scene.skinned ? settings.scene.skinned->clip : "");
  motion.add(clip.data(), clip.size());
  std::vector<ShowEntry> entries = {
      entryOf("strands", static_cast<double>(strands.strands()), rest.value()),
      entryOf("solver", 1, solver.value()),
      entryOf("materials", static_cast<double>(scene.materials.size()), materials.value()),
      entryOf("pins", static_cast<double>(scene.pins.size()), pins.value()),
      entryOf("body", static_cast<double>(scene.body.positions.size()), body.value()),
      entryOf("colliders", static_cast<double>(scene.bodies.size()), colliders.value()),
      entryOf("motion", 1, motion.value()),
      entryOf("frames a second", settings.rate, ContentHash().value())};
  for (const auto& [name, hash] : scene.mesh_hashes)
    entries.push_back(entryOf(name.empty() ? kUnnamedMeshes : named(kSceneMesh, name), 1, hash));
  return entries;
}

ShowEntry meshEntry(const std::string& collider, uint64_t mesh_hash) {
  return entryOf(named(kAddedMesh, collider), 1, mesh_hash);
}

uint64_t meshHashIn(const std::vector<ShowEntry>& show, const std::string& collider) {
  constexpr double kHalf = 4294967296.0;  // 2^32
  const ShowEntry* const entry = fingerprintNamed(show, named(kAddedMesh, collider));
  if (entry == nullptr || entry->values.size() != 3) return 0;
  const auto isHalf = [](double v) { return v >= 0 && v < kHalf; };
  if (!isHalf(entry->values[1]) || !isHalf(entry->values[2])) return 0;
  return static_cast<uint64_t>(entry->values[1]) << 32 | static_cast<uint64_t>(entry->values[2]);
}

std::string differenceOf(const std::vector<ShowEntry>& own, const std::vector<ShowEntry>& other) {
  std::string text;
  for (const ShowEntry& mine : own) {
    const ShowEntry* const theirs = fingerprintNamed(other, mine.name);
    if (theirs == nullptr ? isMesh(mine) : theirs->values == mine.values) continue;
    const bool counts = theirs != nullptr && !theirs->values.empty() && theirs->values[0] != mine.values[0];
    text += text.empty() ? "" : ", ";
    text += counts ? fmt::format("{} ({:g} here, {:g} there)", mine.name, mine.values[0], theirs->values[0])
                   : mine.name;
  }
  return text;
}

}  // namespace strandcast
