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

#include "core/simulation.h"
#include "scenes/scene_primitives.h"
#include "transport/messages.h"

namespace strandcast {

/// A body that a daemon is to make of a mesh of its own: docs/wire.md, kind 14.
struct ColliderFile {
  std::string name;                            ///< of the collider
  std::string file;                            ///< within the daemon's folder
  PrimitiveKind kind = PrimitiveKind::kField;  ///< or kConvex
  bool follows_head = false;
  Pose pose{};  ///< of one that follows the head: where it is while that is at rest
  float friction = ContactPrimitive().friction;  ///< 0 to 10
  float unit_meters = 0;  ///< 1e-6 to 1000, metres per unit of the file; 0 = as of the scene's own bodies
  float cell = 0;         ///< m, 1e-6 to 1000, of a field; 0 = as of the scene's own bodies
};

/// The command that asks for it, but for its id and groom. Throws Error where the names are longer than the
/// wire's.
Command colliderFileCommand(const ColliderFile& collider);
/// The other way round. Throws Error, naming `where`, where it is not sound.
ColliderFile colliderFileOf(const Command& command, const std::string& where);

/// Throws Error, naming `where`, unless there is a file of this name beneath the folder (readBeneath: nothing
/// outside is opened, through whatever links), and where `folder` is empty: then no file may be opened.
void checkFileWithin(const std::filesystem::path& folder, const std::string& name, const std::string& where);

/// Makes bodies of files beside the frames, one after another, in a thread of its own that gives way to those
/// of the simulation. Where a field is baked that may take minutes.
class ColliderMaker {
 public:
  static constexpr size_t kMostWaiting = 16;

  /// What became of a command.
  struct Made {
    uint64_t command = 0;
    std::string name;
    std::string where;  ///< that begin() was told
    RigidBody body;
    uint64_t mesh_hash = 0;  ///< PrimitiveBody::mesh_hash
    std::string refusal;     ///< why there is no body; or empty
  };

  /// Opens files beneath `folder`, and the buffers there that these name, and no others; none where it is
  /// empty.
  ColliderMaker(std::filesystem::path folder, MeshBodyOptions options)
      : folder_(std::move(folder)), options_(std::move(options)) {}
  ~ColliderMaker() { stop(); }
  ColliderMaker(const ColliderMaker&) = delete;
  ColliderMaker& operator=(const ColliderMaker&) = delete;

  /// Throws Error where the command is not sound, as checkFileWithin, and where kMostWaiting are to be made.
  void begin(const Command& command, const std::string& where);
  /// Whether a collider of this name was begun and not taken yet.
  bool makes(const std::string& name) const;
  /// Whether anything was begun and not taken yet.
  bool isBusy() const;
  /// The next that is done, in the order of their commands.
  std::optional<Made> take();
  /// Waits until take() has something, for so long at most.
  void wait(std::chrono::milliseconds timeout) const;
  /// Refuses the collider of this name, that was begun and not taken yet; false where none was.
  bool drop(const std::string& name);
  /// Makes no more: what is not done is refused. A file that is being read is read to its end.
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
  std::deque<Job> jobs_;  ///< the first is being made
  std::deque<Made> done_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace strandcast
