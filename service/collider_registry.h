// A daemon's colliders by name: those that its scene names, and those that commands add, move and remove.
#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/simulation.h"
#include "scenes/scene.h"
#include "service/colliders.h"
#include "transport/publisher.h"

namespace strandcast {

/// The motion of a collider by command, until its end.
struct PoseTween {
  Pose from, to;
  double start = 0, seconds = 0;  ///< s of simulation time
};

/// A collider that commands may move and remove.
struct NamedCollider {
  BodyId body = 0;
  std::optional<Command> command;     ///< that added it; none where the scene names it
  std::optional<uint64_t> mesh_hash;  ///< PrimitiveBody::mesh_hash, where the command names a file
  std::optional<PoseTween> tween;
};

/// Adds, moves and removes the named bodies of a simulation, and announces all bodies to readers whenever
/// their set changes. Bodies from files are made in a thread of their own (ColliderMaker); addNextMade() adds
/// them. A refused command throws Error, naming `where`, and changes nothing. Not thread-safe.
class ColliderRegistry {
 public:
  /// `folder`: files of commands, as in ColliderMaker. `simulation`, of this scene, and `publisher` must
  /// outlive the registry. `session`: of the daemon.
  ColliderRegistry(const Scene& scene, const std::filesystem::path& folder, Simulation& simulation,
                   Publisher& publisher, uint64_t session);

  /// Execute the commands of kinds 8, 9 and 10: docs/wire.md. remove() also cancels a body that is being
  /// made.
  void add(const Command& command, const std::string& where);
  void move(const Command& command, const std::string& where);
  void remove(const Command& command, const std::string& where);

  /// Called with a body from a file before it is added; throws Error to refuse it.
  using MadeCheck = std::function<void(const ColliderMaker::Made&)>;
  /// Begins to execute a command of kind 14; throws as ColliderMaker::begin(). Its result is that of a later
  /// addNextMade().
  void addFile(const Command& command, const std::string& where, MadeCheck check = {});
  /// The result of a command of kind 14.
  struct MadeResult {
    uint64_t command = 0;
    std::string refusal;  ///< empty where the body was added
  };
  /// Adds the next body that is made; nothing where none is.
  std::optional<MadeResult> addNextMade();
  /// Whether any body is being made, or made and not added yet.
  bool isMaking() const { return maker_.isBusy(); }
  /// Blocks until addNextMade() has a result, or until the timeout.
  void waitForMade(std::chrono::milliseconds timeout) const { maker_.wait(timeout); }
  /// Refuses the bodies that are not made yet; addNextMade() then has all results.
  void stopMaking() { maker_.stop(); }

  /// Poses a collider for the end of the next step and ends its motion by command. Nothing happens where
  /// there is none of this name, or it does not stand free. Throws Error as checkPose().
  void place(const std::string& name, const Pose& pose);
  /// Poses colliders that commands are moving for `time`, s of simulation: the end of the next step.
  void advance(double time);
  /// Announces all bodies of the simulation. Throws Error as Publisher::announceColliders().
  void announce();
  /// Present poses of the announced bodies that do not follow the head. Valid until the next call.
  const std::vector<PlacedCollider>& placed();
  /// Appends the body that hair grows on and the named colliders: docs/wire.md, "Status".
  void appendTo(ParameterTable& table) const;

  const std::map<std::string, NamedCollider>& named() const { return named_; }
  /// Whether a collider of this name exists or is being made.
  bool has(const std::string& name) const { return named_.contains(name) || maker_.makes(name); }
  /// Whether neither the head nor a joint of a skinned body carries the collider.
  bool standsFree(const NamedCollider& collider) const;
  /// Removes a collider without an announcement. Precondition: named() has it.
  void erase(const std::string& name);
  /// Replaces the motions of all colliders; those without one stand still where they are.
  void replaceTweens(const std::map<std::string, PoseTween>& tweens);

 private:
  /// A command whose body is being made.
  struct Pending {
    Command command;
    MadeCheck check;
  };
  /// A collider that commands may move or remove; throws Error otherwise.
  NamedCollider& find(const std::string& name, const std::string& where);
  /// Throws Error where the name is empty or in use.
  void checkName(const std::string& name, const std::string& where) const;
  /// Adds a named body and announces the colliders. Throws Error where the limits on colliders are exceeded.
  NamedCollider& addNamed(const std::string& name, RigidBody body, const std::string& where);

  Simulation& simulation_;
  Publisher& publisher_;
  const uint64_t session_;
  uint32_t revision_ = 0;               ///< of the newest announcement
  std::vector<PlacedCollider> placed_;  ///< bodies of the newest announcement
  const std::string scene_body_;        ///< name of the body that hair grows on; may be empty
  const size_t scene_body_parts_;       ///< it consists of the first bodies, so many
  std::shared_ptr<const SkinnedBody> skinned_;
  std::map<std::string, NamedCollider> named_;
  std::map<uint64_t, Pending> pending_;  ///< by the command's id
  ColliderMaker maker_;
};

}  // namespace strandcast
