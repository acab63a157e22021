#include "service/collider_registry.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/error.h"
#include "service/commands.h"
#include "transport/chunks.h"
#include "transport/commands.h"
#include "transport/parameter_table.h"

namespace strandcast {
namespace {

/// Reads docs/wire.md, "Command": kind, whether it follows the head, pose, and the numbers of a shape.
ContactPrimitive commandedShape(const std::vector<double>& values, const std::string& where) {
  constexpr size_t kBefore = 9;
  if (values.size() != kBefore + kShapeNumbers)
    throw Error("a collider takes 25 numbers", where, "kind, follows head, pose (7), shape (16)");
  const double kind = values[0];
  if (kind != std::floor(kind) || kind < 0 || kind > static_cast<double>(PrimitiveKind::kBox))
    throw Error("a collider of this kind cannot be added by command", where,
                "commands add kinds 0 (sphere) to 5 (box)");
  ContactPrimitive shape;
  shape.kind = static_cast<PrimitiveKind>(static_cast<uint32_t>(kind));
  const double* number = values.data() + kBefore;
  shapeNumbers(shape, [&](float& into) { into = static_cast<float>(*number++); });
  checkColliderShape(shape, where);  // validated before anything changes, not at the announcement
  return shape;
}

}  // namespace

ColliderRegistry::ColliderRegistry(const Scene& scene, const std::filesystem::path& folder,
                                   Simulation& simulation, Publisher& publisher, uint64_t session)
    : simulation_(simulation),
      publisher_(publisher),
      session_(session),
      scene_body_(scene.body_name),
      scene_body_parts_(scene.named_parts),
      skinned_(scene.skinned),
      maker_(folder, scene.mesh_bodies) {
  for (const auto& [name, body] : scene.named_bodies) named_[name].body = body;
}

void ColliderRegistry::add(const Command& command, const std::string& where) {
  checkName(command.name, where);
  RigidBody body;
  body.primitives = {commandedShape(command.values, where)};
  body.follows_head = command.values[1] != 0;
  body.pose = commandedPose(command.values, 2, where);
  addNamed(command.name, std::move(body), where).command = command;
}

void ColliderRegistry::addFile(const Command& command, const std::string& where, MadeCheck check) {
  checkName(colliderFileOf(command, where).name, where);
  maker_.begin(command, where);
  pending_[command.id] = {command, std::move(check)};
}

NamedCollider& ColliderRegistry::find(const std::string& name, const std::string& where) {
  const auto known = named_.find(name);
  if (known != named_.end()) return known->second;
  if (!scene_body_.empty() && name == scene_body_)
    throw Error("hair grows on '" + name + "', which commands neither move nor remove", where,
                skinned_ ? "its clip and the head's motion move its joints" : "move the head");
  throw Error(
      "unknown collider '" + name + "'", where,
      "commands move and remove only colliders that a command added or that the configuration file names");
}

void ColliderRegistry::checkName(const std::string& name, const std::string& where) const {
  if (name.empty()) throw Error("a collider has no name", where, "give it a unique name");
  if (named_.contains(name) || name == scene_body_)
    throw Error("a collider has the same name: '" + name + "'", where, "give it a unique name");
  if (maker_.makes(name))
    throw Error("a collider '" + name + "' is being made", where, "give it a unique name");
}

NamedCollider& ColliderRegistry::addNamed(const std::string& name, RigidBody body, const std::string& where) {
  size_t free = body.follows_head ? 0 : 1, shapes = 1;
  for (const BodyId id : simulation_.bodyIds()) {
    free += simulation_.body(id).follows_head ? 0 : 1;
    shapes += simulation_.body(id).primitives.size();
  }
  if (free > kMaxPlacedColliders || simulation_.bodies() >= kMaxColliders || shapes > kMaxColliderShapes)
    throw Error("too many colliders", where, "remove one first");
  const BodyId id = simulation_.addBody(std::move(body));
  NamedCollider& added = named_[name];
  added.body = id;
  announce();
  return added;
}

std::optional<ColliderRegistry::MadeResult> ColliderRegistry::addNextMade() {
  std::optional<ColliderMaker::Made> made = maker_.take();
  if (!made) return std::nullopt;
  auto pending = pending_.extract(made->command);
  if (made->refusal.empty()) {
    made->refusal = errorTextOf([&] {
      if (!pending.empty() && pending.mapped().check) pending.mapped().check(*made);
      checkColliderShape(made->body.primitives.front(), made->where);
      NamedCollider& added = addNamed(made->name, std::move(made->body), made->where);
      if (pending.empty()) return;
      added.command = std::move(pending.mapped().command);
      added.mesh_hash = made->mesh_hash;
    });
  }
  return MadeResult{made->command, std::move(made->refusal)};
}

void ColliderRegistry::move(const Command& command, const std::string& where) {
  NamedCollider& moved = find(command.name, where);
  if (command.values.size() != 7 && command.values.size() != 8)
    throw Error("a collider's move takes a pose of 7 numbers, and seconds", where,
                "position, rotation x y z w");
  if (simulation_.body(moved.body).follows_head)
    throw Error("collider '" + command.name + "' follows the head", where, "move the head");
  if (const std::string* joint = skinned_ ? skinned_->jointOf(moved.body) : nullptr)
    throw Error(fmt::format("collider '{}' follows the body's joint '{}'", command.name, *joint), where,
                "the body's clip and the head's motion move it; remove it and add a standing collider");
  const double seconds = command.values.size() == 8 ? command.values[7] : kRampSeconds;
  if (!(seconds >= 0 && seconds <= kLongestWay))
    throw Error(fmt::format("a collider's move takes 0 to {:g} s", kLongestWay), where, "");
  moved.tween = PoseTween{simulation_.bodyPose(moved.body), commandedPose(command.values, 0, where),
                          simulation_.time(), seconds};
}

void ColliderRegistry::remove(const Command& command, const std::string& where) {
  if (maker_.drop(command.name)) return;
  find(command.name, where);
  erase(command.name);
  announce();
}

void ColliderRegistry::erase(const std::string& name) {
  const auto known = named_.find(name);
  simulation_.removeBody(known->second.body);
  named_.erase(known);
}

void ColliderRegistry::place(const std::string& name, const Pose& pose) {
  const auto known = named_.find(name);
  if (known == named_.end() || !standsFree(known->second)) return;
  simulation_.setBodyPose(known->second.body, pose);
  known->second.tween.reset();
}

void ColliderRegistry::advance(double time) {
  for (auto& [name, collider] : named_) {
    if (!collider.tween) continue;
    const PoseTween& tween = *collider.tween;
    simulation_.setBodyPose(collider.body,
                            poseBetween(tween.from, tween.to, time - tween.start, tween.seconds));
    if (time - tween.start >= tween.seconds) collider.tween.reset();
  }
}

void ColliderRegistry::replaceTweens(const std::map<std::string, PoseTween>& tweens) {
  for (auto& [name, collider] : named_) {
    const auto tween = tweens.find(name);
    collider.tween = tween == tweens.end() ? std::nullopt : std::optional(tween->second);
  }
}

bool ColliderRegistry::standsFree(const NamedCollider& collider) const {
  return !simulation_.body(collider.body).follows_head && !(skinned_ && skinned_->jointOf(collider.body));
}

void ColliderRegistry::announce() {
  ColliderSet set;
  set.session = session_;
  set.revision = ++revision_;
  set.colliders = collidersOf(simulation_);
  placed_ = placedColliders(simulation_);
  publisher_.announceColliders(set);
}

const std::vector<PlacedCollider>& ColliderRegistry::placed() {
  for (PlacedCollider& placed : placed_) {
    placed.pose = simulation_.bodyPose(placed.id);
    placed.bend = simulation_.bodyBend(placed.id);
  }
  return placed_;
}

void ColliderRegistry::appendTo(ParameterTable& table) const {
  if (scene_body_parts_ > 0)
    appendEntry(table, kColliderEntry, scene_body_, {0, static_cast<double>(scene_body_parts_)});
  for (const auto& [name, collider] : named_)
    appendEntry(table, kColliderEntry, name, {static_cast<double>(collider.body)});
}

}  // namespace strandcast
