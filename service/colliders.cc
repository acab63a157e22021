#include "service/colliders.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "io/file_bytes.h"
#include "options/console.h"
#include "service/commands.h"
#include "transport/chunks.h"
#include "transport/parameter_table.h"

namespace strandcast {

std::vector<Collider> collidersOf(const Simulation& simulation) {
  std::vector<Collider> colliders;
  for (const BodyId id : simulation.bodyIds()) {
    const RigidBody& body = simulation.body(id);
    if (!body.primitives.empty())
      colliders.push_back({static_cast<uint32_t>(id), body.follows_head, true, body.primitives});
  }
  return colliders;
}

std::vector<PlacedCollider> placedColliders(const Simulation& simulation) {
  std::vector<PlacedCollider> placed;
  for (const BodyId id : simulation.bodyIds()) {
    const RigidBody& body = simulation.body(id);
    if (!body.primitives.empty() && !body.follows_head)
      placed.push_back({static_cast<uint32_t>(id), simulation.bodyPose(id), simulation.bodyBend(id)});
  }
  return placed;
}

namespace {

constexpr size_t kColliderFileValues = 12;  // kind, follows head (0 or 1), pose (7), friction, unit, cell
constexpr double kMaxColliderFriction = 10;
constexpr float kMinLength = 1e-6f, kMaxLength = 1e3f;  // m, limits of a unit and of a cell

bool isOneOf(double value, std::initializer_list<double> values) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

float lengthOrNone(double value, const char* what, const std::string& where) {
  const auto length = static_cast<float>(value);
  if (value != 0 && !(length >= kMinLength && length <= kMaxLength))
    throw Error(fmt::format("{} is out of range", what), where,
                fmt::format("give 0, or {:g} to {:g} m", kMinLength, kMaxLength));
  return length;
}

std::string notMadeText(const std::string& where, const std::string& why) {
  return Error("the collider was not created", where, why).what();
}
std::string droppedText(const std::string& where) { return notMadeText(where, "it was removed meanwhile"); }

}  // namespace

Command colliderFileCommand(const ColliderFile& collider) {
  Command command;
  command.kind = CommandKind::kAddColliderFile;
  command.name = withoutSpaces(collider.name) + ' ' + withoutSpaces(collider.file);
  if (command.name.size() > kMaxTextBytes)
    throw Error(
        "the names of a collider and of its file are too long together", collider.file,
        fmt::format("a command holds {} bytes of names; each space or % takes three bytes", kMaxTextBytes));
  command.values = {static_cast<double>(collider.kind), collider.follows_head ? 1.0 : 0.0};
  for (int c = 0; c < 3; ++c) command.values.push_back(static_cast<double>(collider.pose.position[c]));
  for (int c = 0; c < 4; ++c)
    command.values.push_back(static_cast<double>(collider.pose.rotation.coeffs()[c]));
  for (const float number : {collider.friction, collider.unit_meters, collider.cell})
    command.values.push_back(static_cast<double>(number));
  return command;
}

ColliderFile colliderFileOf(const Command& command, const std::string& where) {
  const std::vector<double>& v = command.values;
  if (v.size() != kColliderFileValues)
    throw Error(fmt::format("a collider of a file takes {} numbers", kColliderFileValues), where,
                "kind, follows the head, pose, friction, unit, cell");
  const size_t space = command.name.find(' ');
  const std::string_view names = command.name;
  if (space == 0 || space == names.npos || space + 1 == names.size() ||
      names.find(' ', space + 1) != names.npos)
    throw Error(
        "a collider of a file takes two names", where,
        "give the collider's name, a space and the file's name; write a space in a name as %20 and % as %25");
  ColliderFile out;
  out.name = withSpaces(names.substr(0, space));
  out.file = withSpaces(names.substr(space + 1));
  const bool is_convex = v[0] == static_cast<double>(PrimitiveKind::kConvex);
  if (!is_convex && v[0] != static_cast<double>(PrimitiveKind::kField))
    throw Error("a collider of this kind is not read from a file", where, "6 is a convex body, 7 a mesh");
  if (is_convex) out.kind = PrimitiveKind::kConvex;
  if (!isOneOf(v[1], {0, 1})) throw Error("'follows head' is neither 0 nor 1", where, "give 1 or 0");
  out.follows_head = v[1] == 1;
  out.pose = commandedPose(v, 2, where);
  if (!(v[9] >= 0 && v[9] <= kMaxColliderFriction))
    throw Error("a collider's friction is out of range", where,
                fmt::format("give 0 to {:g}", kMaxColliderFriction));
  out.friction = static_cast<float>(v[9]);
  out.unit_meters = lengthOrNone(v[10], "a file's unit", where);
  out.cell = lengthOrNone(v[11], "a cell", where);
  if (is_convex && out.cell > 0) throw Error("only a mesh has cells", where, "give 0, or kind 7");
  return out;
}

void checkFileWithin(const std::filesystem::path& folder, const std::string& name, const std::string& where) {
  if (folder.empty())
    throw Error("this daemon opens no files for commands", where,
                "start it with --collider-folder DIR and name a file in there");
  checkBeneath(folder, name, "the daemon's collider folder", where);
}

void ColliderMaker::begin(const Command& command, const std::string& where) {
  Job job;
  job.command = command.id;
  job.collider = colliderFileOf(command, where);
  checkFileWithin(folder_, job.collider.file, where);
  job.where = where;
  const std::lock_guard lock(mutex_);
  if (jobs_.size() >= kMaxQueuedJobs)
    throw Error(fmt::format("{} colliders are still being made from files", jobs_.size()), where,
                "wait for their answers");
  jobs_.push_back(std::move(job));
  changed_.notify_all();
  if (thread_.joinable()) return;
  thread_ = std::thread([this, label = LogLabel::current()] {
    const LogLabel of_character(label);
    work();
  });
}

bool ColliderMaker::makes(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  return std::any_of(jobs_.begin(), jobs_.end(), [&](const Job& job) { return job.collider.name == name; }) ||
         std::any_of(done_.begin(), done_.end(), [&](const Made& made) { return made.name == name; });
}

bool ColliderMaker::isBusy() const {
  const std::lock_guard lock(mutex_);
  return !jobs_.empty() || !done_.empty();
}

std::optional<ColliderMaker::Made> ColliderMaker::take() {
  const std::lock_guard lock(mutex_);
  if (done_.empty()) return std::nullopt;
  std::optional<Made> made = std::move(done_.front());
  done_.pop_front();
  return made;
}

void ColliderMaker::wait(std::chrono::milliseconds timeout) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [&] { return !done_.empty(); });
}

bool ColliderMaker::drop(const std::string& name) {
  const std::lock_guard lock(mutex_);
  for (Job& job : jobs_)
    if (job.collider.name == name && !job.dropped->exchange(true)) return true;
  for (Made& made : done_)
    if (made.name == name && made.refusal.empty()) {
      made.refusal = droppedText(made.where);
      return true;
    }
  return false;
}

void ColliderMaker::stop() {
  stopping_ = true;
  {
    const std::lock_guard lock(mutex_);
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
  stopping_ = false;
}

void ColliderMaker::work() {
  constexpr int kNiceness = 10;  // of this thread and of those that its bakes start and end (BakeLoop)
  if (getpriority(PRIO_PROCESS, 0) < kNiceness) setpriority(PRIO_PROCESS, 0, kNiceness);
  for (;;) {
    Job job;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return stopping_ || !jobs_.empty(); });
      if (jobs_.empty()) return;
      job = jobs_.front();
    }
    Made result = made(job);
    const std::lock_guard lock(mutex_);
    if (*job.dropped) result.refusal = droppedText(job.where);
    done_.push_back(std::move(result));
    jobs_.pop_front();
    changed_.notify_all();
  }
}

ColliderMaker::Made ColliderMaker::made(const Job& job) const {
  Made out{job.command, job.collider.name, job.where, {}, 0, {}};
  try {
    if (stopping_ || *job.dropped) throw BakeStopped();
    PrimitiveBody made_body = bodyOf(job);
    out.body = std::move(made_body.body);
    out.mesh_hash = made_body.mesh_hash;
  } catch (const BakeStopped&) {
    out.refusal = *job.dropped ? droppedText(job.where) : notMadeText(job.where, "the daemon ends");
  } catch (const Error& error) {
    out.refusal = error.what();
  } catch (const std::exception& error) {
    out.refusal = notMadeText(job.where, error.what());
  }
  return out;
}

PrimitiveBody ColliderMaker::bodyOf(const Job& job) const {
  const ColliderFile& collider = job.collider;
  ScenePrimitive primitive;
  primitive.shape.kind = collider.kind;
  primitive.shape.friction = collider.friction;
  primitive.follows_head = collider.follows_head;
  primitive.name = collider.name;
  primitive.file = collider.file;
  primitive.beneath = folder_;
  primitive.cell = collider.cell;
  primitive.where = job.where;
  primitive.units.unit_meters = collider.unit_meters;
  BakeLimits limits;
  limits.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / 2);
  PrimitiveBodies made = primitiveBodies(
      {primitive}, options_, {}, [&](const std::string&, double) { return !stopping_ && !*job.dropped; },
      [&](const std::string& estimate, double seconds) {
        if (seconds >= kNotableBakeSeconds) spdlog::info("collider {}: {}", collider.name, estimate);
      },
      limits);
  for (const std::string& warning : made.warnings) spdlog::warn("collider {}: {}", collider.name, warning);
  for (const std::string& note : made.notes) spdlog::info("collider {}: {}", collider.name, note);
  PrimitiveBody out = std::move(made.bodies.front());
  if (collider.follows_head) {
    out.body.primitives.front().a = collider.pose.position;
    out.body.primitives.front().rotation = collider.pose.rotation;
  } else {
    out.body.pose = collider.pose;
  }
  return out;
}

}  // namespace strandcast
