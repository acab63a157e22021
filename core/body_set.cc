#include "core/body_set.h"

#include <algorithm>
#include <utility>

#include "core/error.h"

namespace strandcast {

void checkBody(const RigidBody& body, const char* where) {
  for (const ContactPrimitive& primitive : body.primitives) checkPrimitive(primitive, where);
  if (!body.follows_head) checkPose(body.pose, where);
  for (const ContactPrimitive& primitive : body.primitives)
    if (body.bends && primitive.field && primitive.rotation.angularDistance(Quat::Identity()) > 1e-6f)
      throw Error("a distance field that bends is rotated within its body", where, "rotate the body instead");
}

BodySet::BodySet(std::unique_ptr<BroadPhase> broad_phase, size_t neighbourhoods)
    : broad_phase_(std::move(broad_phase)), neighbourhoods_(neighbourhoods) {}

BodyId BodySet::add(RigidBody body) {
  Placed added;
  if (!body.follows_head) added.begin = added.end = body.pose;
  added.body = std::move(body);
  try {
    addShapes(added);
  } catch (...) {
    rebuildShapes();  // without those of this body
    throw;
  }
  added.id = next_id_++;  // a refused body uses up no id
  bodies_.push_back(std::move(added));
  reserve();
  return bodies_.back().id;
}

void BodySet::addShapes(Placed& body) {
  body.data.clear();
  body.bends.clear();
  for (const ContactPrimitive& primitive : body.body.primitives) {
    body.data.push_back(shapes_.add(primitive));
    body.bends.push_back(body.body.bends && primitive.field ? shapes_.addBend() : 0);
  }
}

void BodySet::reserve() {
  constexpr size_t kMaxNear = size_t{1} << 22;
  size_t primitives = 0;
  for (const Placed& placed : bodies_) primitives += placed.body.primitives.size();
  primitives_.reserve(primitives);
  boxes_.reserve(primitives);
  near_.offsets.reserve(neighbourhoods_ + 1);
  near_.bodies.reserve(std::min(neighbourhoods_ * primitives, kMaxNear));
}

void BodySet::remove(BodyId body, const char* where) {
  find(body, where);
  std::erase_if(bodies_, [&](const Placed& known) { return known.id == body; });
  rebuildShapes();
}

void BodySet::rebuildShapes() {
  shapes_.clear();
  for (Placed& placed : bodies_) addShapes(placed);
}

const BodySet::Placed* BodySet::findOrNull(BodyId body) const {
  for (const Placed& placed : bodies_)
    if (placed.id == body) return &placed;
  return nullptr;
}
const BodySet::Placed& BodySet::find(BodyId body, const char* where) const {
  if (const Placed* placed = findOrNull(body)) return *placed;
  throw Error("unknown body " + std::to_string(body), where, "it was never added, or was removed");
}
BodySet::Placed& BodySet::find(BodyId body, const char* where) {
  return const_cast<Placed&>(std::as_const(*this).find(body, where));
}

std::vector<BodyId> BodySet::ids() const {
  std::vector<BodyId> ids;
  for (const Placed& known : bodies_) ids.push_back(known.id);
  return ids;
}

const RigidBody& BodySet::body(BodyId body, const char* where) const { return find(body, where).body; }

void BodySet::setPose(BodyId body, const Pose& pose, const char* where) {
  Placed& known = find(body, where);
  if (known.body.follows_head)
    throw Error("body " + std::to_string(body) + " follows the head", where,
                "move the head, or add the body without follows_head");
  checkPose(pose, where);
  known.end = pose;
}

void BodySet::setBend(BodyId body, const SurfaceBend& bend, const char* where) {
  Placed& known = find(body, where);
  if (!known.body.bends)
    throw Error("body " + std::to_string(body) + " does not bend", where, "add it with RigidBody::bends");
  const bool finite =
      std::all_of(bend.terms.begin(), bend.terms.end(), [](const Vec3& t) { return t.allFinite(); });
  if (!finite || !bend.middle.allFinite())
    throw Error("a bend is not finite", where, "check its terms and middle");
  known.bend_end = bend;
}

const Pose& BodySet::pose(BodyId body, const Pose& head, const char* where) const {
  const Placed& known = find(body, where);
  return known.body.follows_head ? head : known.begin;
}

const SurfaceBend& BodySet::bend(BodyId body, const char* where) const {
  return find(body, where).bend_begin;
}

void BodySet::advance() {
  for (Placed& body : bodies_) {
    body.begin = body.end;
    body.bend_begin = body.bend_end;
  }
}

void BodySet::cancelMotion() {
  for (Placed& body : bodies_) {
    body.end = body.begin;
    body.bend_end = body.bend_begin;
  }
}

void BodySet::place(const Pose& head_begin, const Pose& head_end, const Origin& origin, float dt) {
  primitives_.clear();  // keeps its memory
  for (const Placed& placed : bodies_) {
    const bool head = placed.body.follows_head;
    const Pose begin = origin.toLocal(head ? head_begin : placed.begin),
               end = origin.toLocal(head ? head_end : placed.end);
    for (size_t i = 0; i < placed.data.size(); ++i) {
      const ContactPrimitive& primitive = placed.body.primitives[i];
      primitives_.push_back(moved(primitive, begin, end, dt, placed.data[i]));
      if (placed.bends[i] == 0) continue;
      const MovingBend bend = bendOf(primitive, placed.bend_begin, placed.bend_end);
      shapes_.setBend(placed.bends[i], bend);
      applyBend(primitives_.back(), bend, placed.bends[i]);
    }
  }
}

const NearBodyLists& BodySet::findNear(std::span<const Box> neighbourhoods) {
  boxes_.clear();
  for (const MovingPrimitive& primitive : primitives_) boxes_.push_back(sweptBox(primitive));
  broad_phase_->findPairs(boxes_, neighbourhoods, near_);
  return near_;
}

namespace {

/// StrandModel::rest_distance from the rest distances of the vertices to `bodies`. No body holds a vertex
/// deeper than `depths`, one per body, m.
std::vector<float> distancesAtRest(const StrandModel& model, std::span<const MovingPrimitive> bodies,
                                   std::span<const uint32_t> words, std::span<const float> depths,
                                   float hair_radius) {
  constexpr float kSlack = 2e-6f;  // m, so that rounding does not press on hair at rest
  std::vector<float> out(model.vertices(), kFarFromBodies), distances;  // distances: of one strand
  for (size_t s = 0; s < model.strands(); ++s) {
    const uint32_t root = model.offsets[s], end = model.offsets[s + 1];
    for (size_t i = 0; i < bodies.size(); ++i) {
      distances.clear();
      for (uint32_t v = root; v < end; ++v)
        distances.push_back(signedDistance(bodies[i], model.restPosition(s, v), words));
      auto inSkin = [&](uint32_t v) { return v >= root && v < end && distances[v - root] < hair_radius; };
      for (uint32_t v = root; v < end; ++v) {
        const float distance = distances[v - root];
        const bool skin = inSkin(v) || ((inSkin(v - 1) || inSkin(v + 1)) && distance < kSkinDepth);
        const float nearest = distance - (skin ? kSkinDepth : kSlack);
        out[v] = std::min(out[v], distance > -depths[i] ? nearest : -kFarFromBodies);
      }
    }
  }
  return out;
}

}  // namespace

std::vector<float> BodySet::restDistances(const StrandModel& model, float hair_radius) const {
  std::vector<MovingPrimitive> rooted;
  std::vector<float> depths;
  for (const Placed& placed : bodies_) {
    if (!placed.body.holds_roots) continue;
    for (size_t i = 0; i < placed.data.size(); ++i) {
      const ContactPrimitive& primitive = placed.body.primitives[i];
      constexpr float kAnyStep = 1;  // s: a body at rest is at the same place after a step of any length
      rooted.push_back(moved(primitive, placed.begin, placed.begin, kAnyStep, placed.data[i]));
      // A field holds only vertices near its samples: deeper inside it stores distance bounds only.
      const FieldGrid* grid = primitive.field ? &primitive.field->grid : nullptr;
      depths.push_back(grid != nullptr ? grid->band - 2 * grid->cell : kFarFromBodies);
    }
  }
  if (rooted.empty()) return {};
  return distancesAtRest(model, rooted, shapes_.words, depths, hair_radius);
}

}  // namespace strandcast
