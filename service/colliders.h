// Bodies of a simulation as renderers receive them, and bodies that commands make from mesh files.
#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/simulation.h"
#include "scenes/scene_primitives.h"
#include "transport/messages.h"

namespace strandcast {

/// The simulation's bodies that have shapes, in the form that renderers receive.
std::vector<Collider> collidersOf(const Simulation& simulation);
/// Poses of the bodies that do not follow the head.
std::vector<PlacedCollider> placedColliders(const Simulation& simulation);

/// A body that a daemon makes from a mesh file of its own: docs/wire.md, kind 14.
struct ColliderFile {
  std::string name;                            ///< name of the collider
  std::string file;                            ///< path relative to the daemon's collider folder
  PrimitiveKind kind = PrimitiveKind::kField;  ///< kField or kConvex
  bool follows_head = false;
  Pose pose{};                                   ///< world; with follows_head: while the head is at rest
  float friction = ContactPrimitive().friction;  ///< 0 to 10
  float unit_meters = 0;  ///< metres per unit of the file, 1e-6 to 1000; 0 = the unit of the scene's own
                          ///< bodies
  float cell = 0;         ///< m, 1e-6 to 1000, of a field; 0 = the cell of the scene's own bodies
};

/// The command that requests the collider; the caller sets id and groom. Throws Error where the names exceed
/// the wire's length limit.
Command colliderFileCommand(const ColliderFile& collider);
/// Parses a command; inverse of colliderFileCommand(). Throws Error, naming `where`, on invalid values.
ColliderFile colliderFileOf(const Command& command, const std::string& where);

/// Throws Error, naming `where`, unless a file of this name exists beneath the folder. Paths and links that
/// lead outside are refused (readBeneath). An empty `folder` permits no file.
void checkFileWithin(const std::filesystem::path& folder, const std::string& name, const std::string& where);

/// Makes bodies from files, one after another, in a low-priority thread beside the simulation. Baking a field
/// may take minutes.
class ColliderMaker {
 public:
  static constexpr size_t kMaxQueuedJobs = 16;

  /// The result of a command.
  struct Made {
    uint64_t command = 0;
    std::string name;
    std::string where;  ///< as passed to begin()
    RigidBody body;
    uint64_t mesh_hash = 0;  ///< PrimitiveBody::mesh_hash
    std::string refusal;     ///< reason why there is no body; empty on success
  };

  /// Opens files beneath `folder`, and the buffers there that these name, and no others. An empty `folder`
  /// permits no file.
  ColliderMaker(std::filesystem::path folder, MeshBodyOptions options)
      : folder_(std::move(folder)), options_(std::move(options)) {}
  ~ColliderMaker() { stop(); }
  ColliderMaker(const ColliderMaker&) = delete;
  ColliderMaker& operator=(const ColliderMaker&) = delete;

  /// Queues the command. Throws Error where the command is invalid, as checkFileWithin(), or where
  /// kMaxQueuedJobs jobs are queued.
  void begin(const Command& command, const std::string& where);
  /// Whether a collider of this name is queued, in work or done but not taken yet.
  bool makes(const std::string& name) const;
  /// Whether any collider is queued, in work or done but not taken yet.
  bool isBusy() const;
  /// Takes the next result, in the order of the commands.
  std::optional<Made> take();
  /// Blocks until take() has a result, or until the timeout.
  void wait(std::chrono::milliseconds timeout) const;
  /// Cancels the collider of this name, which take() then reports as refused. False where none is queued or
  /// done.
  bool drop(const std::string& name);
  /// Refuses all queued colliders and joins the thread. A file that is being read is read to its end.
  void stop();

 private:
  struct Job {
    uint64_t command = 0;
    ColliderFile collider;
    std::string where;
    std::shared_ptr<std::atomic<bool>> dropped = std::make_shared<std::atomic<bool>>(false);
  };
  void work();
  Made made(const Job& job) const;
  PrimitiveBody bodyOf(const Job& job) const;

  const std::filesystem::path folder_;
  const MeshBodyOptions options_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::deque<Job> jobs_;  ///< the first job is in work
  std::deque<Made> done_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace strandcast
