#include "transport/recording/recorder.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/hash.h"
#include "transport/codec/hair_codec.h"
#include "transport/message_bytes.h"
#include "transport/pose_inbox.h"
#include "transport/wire_fields.h"

namespace strandcast {
namespace {

/// Stored in the file, for readers without this program.
constexpr const char* kLayout =
    "A recording of Strandcast, version 4. After the 8 bytes STRNDREC: records of uint32 kind, uint32 "
    "length, "
    "uint64 hash (FNV-1a of the 4 bytes of kind and of what follows), length bytes. Numbers are big-endian, "
    "texts "
    "have a uint32 length that counts a final zero byte, arrays a uint32 length. Kinds: 1 head (version, "
    "groom id, "
    "float worst error in m, texts codec, layout, source); 2 groom, 3 body, 6 guides: the fields of "
    "groom_chunk_t, "
    "body_chunk_t and guide_chunk_t of strandcast.lcm version 7 without their fingerprint; 4 input: "
    "command_t, "
    "obeyed before the next frame; 5 frame (uint64 number from 0, double seconds, uint64 FNV-1a of all "
    "positions as "
    "float32 little-endian, uint32 chunks of guides that follow, "
    "uint64 place of the newest light materials, of the newest lights or 0); 7 index (uint64 place of the "
    "index before "
    "it or "
    "0, place of the groom, number of its first frame, arrays of places and seconds); 8 end (uint64 place of "
    "the "
    "last index or 0, frames); 9 grids of the frame before (uint64 number of the frame, uint32 cells per "
    "axis, float x y z of the lowest corner in m, float cell in m, uint32 first of 16 layers along z, uint32 "
    "bits of what is there: 1 density in kg/m^3, 2 4 8 wind x y z in m/s, 16 pressure in Pa, 32 divergence "
    "in 1/s, 64 solid, array of float units, bytes: zstd of low and then high bytes of 16-bit numbers); 12 "
    "hairs, after the body: the fields of hair_chunk_t; 14 names of poses (texts names, weight_names of "
    "pose_samples_t); 15 poses of a step before the next frame (uint64 place of their names, uint64 steps "
    "before it, uint32 1 = cut, uint64 source, uint64 its time in ns, arrays of float poses, scales, weights "
    "of one sample). Payloads of guides, hairs and grids: docs/wire.md of Strandcast.";

CodecOptions alone(CodecOptions codec) {
  if (codec.codec == Codec::kTemporal) codec.codec = Codec::kOctahedral12;
  return codec;
}

/// Whether a reader would accept the frame.
bool isSound(const GuideFrame& frame) {
  return frame.head.position.allFinite() && std::abs(frame.head.rotation.squaredNorm() - 1) < 1e-3f &&
         std::isfinite(frame.simulation_time) &&
         std::all_of(frame.positions.begin(), frame.positions.end(),
                     [](const Vec3& position) { return position.allFinite(); });
}

}  // namespace

uint64_t positionsHash(std::span<const Vec3> positions) {
  ContentHash hash;
  hash.add(positions.data(), positions.size_bytes());
  return hash.value();
}

template <class Record>
uint64_t Recorder::writeRecord(RecordKind kind, const Record& record) {
  MessageWriter writer(bytes_);
  recordFields(writer, record, std::type_identity<Record>());
  return file_->write(kind, bytes_);
}

template <class Message>
uint64_t Recorder::writeMessage(RecordKind kind, const Message& message) {
  MessageWriter writer(bytes_);
  fields(writer, message, std::type_identity<Message>());
  return file_->write(kind, bytes_);
}

template <class Work>
void Recorder::guarded(const Work& work) {
  try {
    work();
  } catch (const Error&) {
    is_open_ = false;  // an index after half a record would be useless
    throw;
  }
}

Recorder::Recorder(const std::filesystem::path& file, const RecordingOptions& options, MakeFile when)
    : path_(file), options_(options), encoder_(alone(options.codec)) {
  checkCodecOptions(options.codec, file.string());
  if (when == MakeFile::kAtOnce)
    makeFile();
  else
    RecordWriter::check(file);
}

void Recorder::makeFile() {
  file_.emplace(path_);
  RecordingHead head;
  head.groom_id = options_.groom_id;
  head.codec = nameOf(alone(options_.codec).codec);
  head.max_error = options_.codec.codec == Codec::kFloat32 ? 0 : options_.codec.max_error;
  head.layout = kLayout;
  head.source = options_.source;
  writeRecord(RecordKind::kHead, head);
  file_->flush();
}

Recorder::~Recorder() {
  try {
    close();
  } catch (const Error&) {
  }
}

void Recorder::setGroom(const GroomDescription& groom, const BodyDescription& body) {
  checkAnnouncement(groom, body, "groom " + groom.name);
  if (!is_open_) return;
  guarded([&] {
    if (!file_) makeFile();
    writeIndex();
    GroomDescription own_groom = groom;
    BodyDescription own_body = body;
    own_groom.groom_id = own_body.groom_id = options_.groom_id;
    own_body.session = groom.session;
    own_body.revision = groom.revision;
    index_.groom = file_->size();
    for (const GroomChunk& chunk : splitGroom(own_groom)) writeMessage(RecordKind::kGroom, chunk);
    for (const BodyChunk& chunk : splitBody(own_body)) writeMessage(RecordKind::kBody, chunk);
    file_->flush();
  });
  encoder_.setGroom(groom.guides);
  session_ = groom.session;
  revision_ = groom.revision;
  guides_ = groom.guides;
  inputs_at_ = 0;
  poses_ = 0;
  newest_ = 0;
  grids_may_follow_ = false;
}

void Recorder::setHairs(const HairDescription& hairs) {
  const std::string where = path_.string() + ", hairs";
  if (guides_.vertices() == 0) throw Error("no groom is recorded", where, "record the groom first");
  checkHairs(hairs, guides_, hairs.source.empty() ? where : hairs.source);
  if (!is_open_) return;
  HairDescription own = hairs;
  if (own.source.empty()) own.source = where;
  own.groom_id = options_.groom_id;
  own.session = session_;
  own.revision = revision_;
  const std::vector<HairChunk> chunks = encodeHairs(own, guides_, options_.codec.hair_error);
  guarded([&] {
    for (const HairChunk& chunk : chunks) writeMessage(RecordKind::kHairs, chunk);
    file_->flush();
  });
}

void Recorder::addInput(const Command& command) {
  grids_may_follow_ = false;
  if (!is_open_ || guides_.vertices() == 0) return;
  guarded([&] {
    writeFullIndex();
    const uint64_t at = writeMessage(RecordKind::kInput, command);
    if (inputs_at_ == 0) inputs_at_ = at;
  });
}

template <class Record>
uint64_t Recorder::writeInput(RecordKind kind, const Record& record) {
  const uint64_t at = writeRecord(kind, record);
  if (inputs_at_ == 0) inputs_at_ = at;
  return at;
}

void Recorder::addPoses(const StepPoses& step) {
  grids_may_follow_ = false;
  const PoseSamples& poses = step.poses;
  if (!is_open_ || guides_.vertices() == 0 || poses_ == kMaxPosesPerFrame || !isSound(poses)) return;
  guarded([&] {
    writeFullIndex();
    if (pose_names_at_ == 0 || poses.names != pose_names_.names ||
        poses.weight_names != pose_names_.weight_names) {
      pose_names_ = {poses.names, poses.weight_names};
      pose_names_at_ = writeInput(RecordKind::kPoseNames, pose_names_);
    }
    writeInput(RecordKind::kPoses,
               PosesRecord{pose_names_at_, step.step, step.is_cut ? kCutFlag : 0, poses.source, poses.time,
                           poses.poses, poses.scales, poses.weights});
  });
  ++poses_;
}

bool Recorder::addFrame(const GuideFrame& frame) {
  grids_may_follow_ = false;
  if (!is_open_ || guides_.vertices() == 0 || frame.session != session_ || frame.revision != revision_ ||
      frame.frame <= newest_ || frame.positions.size() != guides_.vertices() || !isSound(frame))
    return false;
  guarded([&] {
    writeFullIndex();
    if (newest_ != 0) interval_ = std::max(0.0, frame.simulation_time - simulation_time_);
    if (number_ > 0) time_ += interval_;  // between grooms: as between the frames before
    simulation_time_ = frame.simulation_time;
    newest_ = frame.frame;
    FrameRecord record;
    record.number = number_;
    record.time = time_;
    record.state_hash = positionsHash(frame.positions);
    record.chunks = static_cast<uint32_t>(encoder_.runs().size());
    const uint64_t at = writeRecord(RecordKind::kFrame, record);
    for (uint32_t i = 0; i < record.chunks; ++i) {
      encoder_.encode(frame, i, chunk_);
      chunk_.groom_id = options_.groom_id;
      writeMessage(RecordKind::kGuides, chunk_);
    }
    index_.offsets.push_back(inputs_at_ != 0 ? inputs_at_ : at);
    index_.times.push_back(time_);
    inputs_at_ = 0;
    poses_ = 0;
    ++number_;
    file_->flush();  // a killed program loses only the frame in progress
  });
  grids_may_follow_ = true;
  return true;
}

bool Recorder::addGrids(const AirGrids& grids) {
  if (!is_open_ || !std::exchange(grids_may_follow_, false) || !isSound(grids)) return false;
  guarded([&] {
    GridRecord record;
    record.number = number_ - 1;
    for (uint32_t layer = 0; layer < grids.cells; layer += kGridLayers) {
      packLayers(grids, layer, record);
      writeRecord(RecordKind::kGrids, record);
    }
    file_->flush();
  });
  ++grid_frames_;
  return true;
}

/// Called before the next frame and its inputs, so that grids follow their own frame.
void Recorder::writeFullIndex() {
  if (index_.offsets.size() == kIndexFrames) writeIndex();
}

void Recorder::writeIndex() {
  if (index_.offsets.empty()) return;
  index_.previous = writeRecord(RecordKind::kIndex, index_);
  index_.first_number = number_;
  index_.offsets.clear();
  index_.times.clear();
}

void Recorder::close() {
  if (!is_open_) return;
  guarded([&] {
    if (!file_) return;
    writeIndex();
    writeRecord(RecordKind::kEnd, EndRecord{index_.previous, number_});
    file_->flush();
  });
  is_open_ = false;
}

template <class Work>
void RecordingPublisher::attempt(const Work& work) {
  try {
    if (recorder_) work(*recorder_);
  } catch (const Error& error) {
    if (failure_.empty()) failure_ = error.what();
  }
}

template <class Work>
void RecordingPublisher::record(const Work& work) {
  const bool was_sound = failure_.empty();
  attempt(work);
  // At once: close() returns the failure, but may be hours away.
  if (casts_ && was_sound && !failure_.empty())
    spdlog::error("casting goes on, recording does not: {}", failure_);
}

void RecordingPublisher::announce(const GroomDescription& groom, const BodyDescription& body) {
  publisher_->announce(groom, body);
  record([&](Recorder& recorder) { recorder.setGroom(groom, body); });
}

void RecordingPublisher::announceHairs(const HairDescription& hairs) {
  publisher_->announceHairs(hairs);
  record([&](Recorder& recorder) { recorder.setHairs(hairs); });
}

void RecordingPublisher::publish(const GuideFrame& frame) {
  publisher_->publish(frame);
  record([&](Recorder& recorder) { recorder.addFrame(frame); });
}

void RecordingPublisher::publishFrom(GuideFrame& frame, GuideSource& guides) {
  publisher_->publishFrom(frame, guides);
  record([&](Recorder& recorder) {
    copyGuides(guides, frame);
    recorder.addFrame(frame);
  });
}

std::optional<Command> RecordingPublisher::takeCommand() {
  std::optional<Command> command = publisher_->takeCommand();
  if (!command) return command;
  const CommandKind kind = command->kind;
  if (kind == CommandKind::kAddCollider || kind == CommandKind::kAddColliderFile ||
      kind == CommandKind::kMoveCollider || kind == CommandKind::kHeadPose ||
      kind == CommandKind::kHeadMotion)
    unanswered_.push_back(*command);
  else
    record([&](Recorder& recorder) { recorder.addInput(*command); });
  return command;
}

void RecordingPublisher::recordPoses(const StepPoses& poses) {
  record([&](Recorder& recorder) { recorder.addPoses(poses); });
}

void RecordingPublisher::publishStatus(const Status& status) {
  publisher_->publishStatus(status);
  const auto answered = std::find_if(unanswered_.begin(), unanswered_.end(), [&](const Command& command) {
    return command.id == status.last_command;
  });
  if (answered == unanswered_.end()) return;
  if (status.last_command_error.empty()) record([&](Recorder& recorder) { recorder.addInput(*answered); });
  unanswered_.erase(answered);
}

void RecordingPublisher::addGrids(const AirGrids& grids) {
  record([&](Recorder& recorder) { recorder.addGrids(grids); });
}

std::string RecordingPublisher::close() {
  attempt([](Recorder& recorder) { recorder.close(); });
  return failure_;
}

}  // namespace strandcast
