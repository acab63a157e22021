#include "apps/show_fingerprint.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/content_hash.h"
#include "core/convex_body.h"
#include "core/distance_field.h"

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

/// A field by its grid: its samples follow from the body and the grid.
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

ShowEntry entryOf(const char* what, double count, const ContentHash& hash) {
  const uint64_t value = hash.value();
  return {ShowKind::kFingerprint,
          what,
          {count, static_cast<double>(value >> 32), static_cast<double>(value & 0xffffffff)}};
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
  return {entryOf("strands", static_cast<double>(strands.strands()), rest),
          entryOf("solver", 1, solver),
          entryOf("materials", static_cast<double>(scene.materials.size()), materials),
          entryOf("pins", static_cast<double>(scene.pins.size()), pins),
          entryOf("body", static_cast<double>(scene.body.positions.size()), body),
          entryOf("colliders", static_cast<double>(scene.bodies.size()), colliders),
          entryOf("motion", 1, motion),
          entryOf("frames a second", settings.rate, {})};
}

std::string differenceOf(const std::vector<ShowEntry>& own, const std::vector<ShowEntry>& other) {
  std::string text;
  for (const ShowEntry& mine : own) {
    const auto theirs = std::find_if(other.begin(), other.end(), [&](const ShowEntry& entry) {
      return entry.kind == ShowKind::kFingerprint && entry.name == mine.name;
    });
    if (theirs != other.end() && theirs->values == mine.values) continue;
    const bool counts =
        theirs != other.end() && !theirs->values.empty() && theirs->values[0] != mine.values[0];
    text += text.empty() ? "" : ", ";
    text += counts ? fmt::format("{} ({:g} here, {:g} there)", mine.name, mine.values[0], theirs->values[0])
                   : mine.name;
  }
  return text;
}

}  // namespace strandcast
