#include "transport/recording/recording.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "transport/commands.h"
#include "transport/message_bytes.h"
#include "transport/pose_inbox.h"
#include "transport/recording/old_messages.h"
#include "transport/wire_fields.h"

namespace strandcast {
namespace {

template <class T>
bool parseRecord(std::span<const uint8_t> bytes, T& record) {
  MessageReader reader(bytes);
  recordFields(reader, record, std::type_identity<T>());
  return reader.atEnd();
}

template <class T>
bool parseMessage(std::span<const uint8_t> bytes, T& message) {
  MessageReader reader(bytes);
  fields(reader, message, std::type_identity<T>());
  return reader.atEnd();
}

template <class Old, class Message>
bool parseOld(std::span<const uint8_t> bytes, Message& message) {
  Old old;
  if (!parseMessage(bytes, old)) return false;
  message = std::move(old);
  return true;
}

bool isSound(const IndexRecord& index) {
  if (index.offsets.empty() || index.offsets.size() > kIndexFrames ||
      index.offsets.size() != index.times.size() || !(index.times.front() >= 0) ||
      !std::isfinite(index.times.back()))
    return false;
  // Negated, so that NaN counts as out of order.
  for (size_t i = 1; i < index.times.size(); ++i)
    if (!(index.times[i] >= index.times[i - 1]) || index.offsets[i] <= index.offsets[i - 1]) return false;
  return true;
}

}  // namespace

Recording::Recording(const std::filesystem::path& file) : Recording(openRecordingFile(file), file.string()) {}

Recording::Recording(std::unique_ptr<RecordingBytes> bytes, const std::string& name)
    : name_(name), reader_(std::move(bytes)) {
  readHead();
  if (!readEnd()) scan();
}

void Recording::readHead() {
  if (!reader_.startsWithMagic())
    throw Error("this is not a recording of Strandcast (it does not start with STRNDREC)", name_,
                "make one with `strandcast record`");
  RecordReader::Record record;
  uint32_t version = 0;
  const bool is_whole = reader_.read(sizeof kRecordingMagic, record) && record.kind == RecordKind::kHead;
  if (is_whole) MessageReader(record.bytes).number(version);
  if (is_whole && (version < 1 || version > kRecordingVersion))
    throw Error("this is version " + std::to_string(version) + " of the format, version " +
                    std::to_string(kRecordingVersion) + " can be read",
                name_, "use the program that recorded it");
  if (!is_whole || !parseRecord(record.bytes, head_))
    throw Error("the head of the recording is damaged", name_, "nothing of it can be read");
  first_record_ = record.next;
}

bool Recording::readIndex(uint64_t offset, IndexRecord& index) {
  RecordReader::Record record;
  return offset >= first_record_ && reader_.read(offset, record) && record.kind == RecordKind::kIndex &&
         parseRecord(record.bytes, index) && isSound(index) && index.groom >= first_record_ &&
         index.groom < index.offsets.front() && index.offsets.back() < offset && index.previous < offset;
}

void Recording::add(const IndexRecord& index, uint64_t offset) {
  blocks_.push_back({offset, index.groom, index.first_number, index.offsets.size(), index.times.front()});
  frames_ += index.offsets.size();
  seconds_ = index.times.back();
}

bool Recording::readEnd() {
  constexpr uint64_t kEndBytes = kRecordHeadBytes + 16;
  RecordReader::Record record;
  EndRecord end;
  if (reader_.size() < first_record_ + kEndBytes || !reader_.read(reader_.size() - kEndBytes, record) ||
      record.kind != RecordKind::kEnd || !parseRecord(record.bytes, end))
    return false;
  IndexRecord index;
  std::vector<Block> backwards;
  double next_time = HUGE_VAL;
  uint64_t next_number = end.frames;
  // Terminates: each index precedes the one that refers to it.
  for (uint64_t at = end.index; at != 0; at = index.previous) {
    if (!readIndex(at, index) || index.first_number + index.offsets.size() != next_number ||
        !(index.times.back() <= next_time))
      return false;
    if (backwards.empty()) seconds_ = index.times.back();
    backwards.push_back({at, index.groom, index.first_number, index.offsets.size(), index.times.front()});
    next_number = index.first_number;
    next_time = index.times.front();
  }
  if (next_number != 0) return false;
  blocks_.assign(backwards.rbegin(), backwards.rend());
  frames_ = end.frames;
  return true;
}

void Recording::scan() {
  is_cut_ = true;
  blocks_.clear();
  frames_ = 0;
  seconds_ = 0;
  tail_ = {};
  RecordReader::Record record, before;
  before.kind = RecordKind::kHead;
  uint64_t inputs_at = 0;
  for (uint64_t at = first_record_; reader_.skim(at, record); before = record, at = record.next) {
    if (record.kind == RecordKind::kGroom && before.kind != RecordKind::kGroom) {
      if (!tail_.offsets.empty()) break;  // an index is missing
      tail_.groom = at;
      inputs_at = 0;
    } else if (isInput(record.kind)) {
      if (inputs_at == 0) inputs_at = at;
    } else if (record.kind == RecordKind::kFrame) {
      FrameRecord frame;
      if (!reader_.read(at, record) || !parseFrame(record.bytes, frame) || tail_.groom == 0 ||
          tail_.offsets.size() == kIndexFrames || frame.number != frames_ + tail_.offsets.size() ||
          !(frame.time >= (tail_.times.empty() ? seconds_ : tail_.times.back())) ||
          !std::isfinite(frame.time))
        break;
      if (tail_.offsets.empty()) tail_.first_number = frames_;
      tail_.offsets.push_back(inputs_at != 0 ? inputs_at : at);
      tail_.times.push_back(frame.time);
      inputs_at = 0;
    } else if (record.kind == RecordKind::kIndex) {
      IndexRecord index;
      if (!readIndex(at, index) || index.offsets != tail_.offsets || index.times != tail_.times ||
          index.groom != tail_.groom || index.first_number != frames_)
        break;
      add(index, at);
      tail_.offsets.clear();
      tail_.times.clear();
    }
  }
  if (!tail_.offsets.empty()) add(tail_, 0);
  // The file may end, or be damaged, within a frame.
  RecordedFrame last;
  while (frames_ > 0 && !blocks_.empty() && blocks_.back().index == 0 && !readFrame(frames_ - 1, last))
    dropLast();
}

void Recording::dropLast() {
  --frames_;
  if (--blocks_.back().count == 0) {
    blocks_.pop_back();
    seconds_ = 0;
    if (const IndexRecord* index = nullptr; !blocks_.empty() && indexOf(blocks_.back(), index))
      seconds_ = index->times.back();
    return;
  }
  tail_.offsets.pop_back();
  tail_.times.pop_back();
  seconds_ = tail_.times.back();
}

bool Recording::indexOf(const Block& block, const IndexRecord*& index) {
  index = block.index == 0 ? &tail_ : &loaded_;
  if (block.index == 0 || block.index == loaded_at_) return true;
  loaded_at_ = 0;
  if (!readIndex(block.index, loaded_) || loaded_.offsets.size() != block.count) return false;
  loaded_at_ = block.index;
  return true;
}

uint64_t Recording::frameAt(double seconds) {
  const auto later = std::upper_bound(blocks_.begin(), blocks_.end(), seconds,
                                      [](double s, const Block& block) { return s < block.first_time; });
  if (later == blocks_.begin()) return 0;
  const Block& block = *(later - 1);
  const IndexRecord* index = nullptr;
  if (!indexOf(block, index)) return block.first_number;
  const auto next = std::upper_bound(index->times.begin(), index->times.end(), seconds);
  return block.first_number + static_cast<uint64_t>(std::max<ptrdiff_t>(0, next - index->times.begin() - 1));
}

bool Recording::readGroom(uint64_t offset) {
  if (offset == groom_at_) return true;
  groom_at_ = 0;
  shown_ = {};
  GroomAssembler grooms(head_.groom_id);
  RecordReader::Record record;
  uint64_t at = offset;
  for (; !shown_.groom; at = record.next) {
    GroomChunk chunk;
    if (!reader_.read(at, record) || record.kind != RecordKind::kGroom || !parseGroom(record.bytes, chunk))
      return false;
    shown_.groom = grooms.add(std::move(chunk));
  }
  readHairs(readBody(at));
  assembler_.setGroom(shown_.groom);
  groom_at_ = offset;
  return true;
}

/// Reads the groom's body, from the record after the groom on; an empty one where it is damaged. Returns the
/// offset of the record after it.
uint64_t Recording::readBody(uint64_t at) {
  const GroomDescription& groom = *shown_.groom;
  BodyAssembler bodies(head_.groom_id);
  RecordReader::Record record;
  for (; reader_.skim(at, record) && record.kind == RecordKind::kBody; at = record.next) {
    BodyChunk chunk;
    if (!shown_.body && reader_.read(at, record) && parseMessage(record.bytes, chunk))
      shown_.body = bodies.add(std::move(chunk));
  }
  if (shown_.body && shown_.body->session == groom.session && shown_.body->revision == groom.revision)
    return at;
  shown_.damage.body = true;
  auto none = std::make_shared<BodyDescription>();
  none->groom_id = groom.groom_id;
  none->session = groom.session;
  none->revision = groom.revision;
  shown_.body = std::move(none);
  return at;
}

/// Reads the hairs that follow the groom, from the record after its body on. Without them a reader would wait
/// for what the groom's growth names.
void Recording::readHairs(uint64_t at) {
  HairAssembler hairs(head_.groom_id);
  hairs.setGroom(shown_.groom);
  RecordReader::Record record;
  bool is_named = (shown_.groom->growth & GroomDescription::kHairs) != 0;
  for (; reader_.skim(at, record) && record.kind == RecordKind::kHairs; at = record.next) {
    is_named = true;
    HairChunk chunk;
    if (!shown_.hairs && reader_.read(at, record) && parseMessage(record.bytes, chunk))
      shown_.hairs = hairs.add(std::move(chunk));
  }
  if (!is_named || shown_.hairs) return;
  shown_.damage.hairs = true;
  auto without = std::make_shared<GroomDescription>(*shown_.groom);
  without->growth &= ~uint32_t{GroomDescription::kHairs};
  if (without->growth == 0) {
    without->growth = GroomDescription::kFromSeed;
    without->seeded.assign(without->guides.strands(), 0);
  }
  shown_.groom = std::move(without);
}

const Recording::Block& Recording::blockOf(uint64_t number) const {
  return *(std::upper_bound(blocks_.begin(), blocks_.end(), number,
                            [](uint64_t n, const Block& block) { return n < block.first_number; }) -
           1);
}

double Recording::timeOf(uint64_t number) {
  const Block& block = blockOf(number);
  const IndexRecord* index = nullptr;
  return indexOf(block, index) ? index->times[number - block.first_number] : block.first_time;
}

bool Recording::readPoseNames(uint64_t offset) {
  if (offset == pose_names_at_) return true;
  RecordReader::Record record;
  pose_names_at_ = 0;
  if (!reader_.read(offset, record) || record.kind != RecordKind::kPoseNames ||
      !parseRecord(record.bytes, pose_names_))
    return false;
  pose_names_at_ = offset;
  return true;
}

/// Adds the poses to the frame. `offset`: of the record; its names come before it. False where it is damaged.
bool Recording::parsePoses(std::span<const uint8_t> bytes, uint64_t offset, RecordedFrame& out) {
  PosesRecord read;
  if (out.poses.size() == kMaxPosesPerFrame || !parseRecord(bytes, read) || read.names < first_record_ ||
      read.names >= offset)
    return false;
  if (!readPoseNames(read.names)) {
    out.damage.pose_names = true;
    return true;
  }
  StepPoses& step = out.poses.emplace_back();
  step.step = read.step;
  step.is_cut = (read.flags & kCutFlag) != 0;
  PoseSamples& poses = step.poses;
  poses.source = read.source;
  poses.time = read.time;
  poses.names = pose_names_.names;
  poses.weight_names = pose_names_.weight_names;
  poses.ages = {0};
  poses.poses = std::move(read.poses);
  poses.scales = std::move(read.scales);
  poses.weights = std::move(read.weights);
  return isSound(poses);
}

bool Recording::parseGroom(std::span<const uint8_t> bytes, GroomChunk& chunk) const {
  return head_.version < 4 ? parseOld<GroomChunk6>(bytes, chunk) : parseMessage(bytes, chunk);
}

bool Recording::parseFrame(std::span<const uint8_t> bytes, FrameRecord& record) const {
  if (head_.version >= 4) return parseRecord(bytes, record);
  FrameRecord3 old;
  const bool is_sound = parseRecord(bytes, old);
  record = old;
  return is_sound;
}

bool Recording::parseGuides(std::span<const uint8_t> bytes) {
  switch (head_.version) {
    case 1:
      return parseOld<GuideChunk3>(bytes, chunk_);
    case 2:
      return parseOld<GuideChunk5>(bytes, chunk_);
    case 3:
      return parseOld<GuideChunk6>(bytes, chunk_);
    default:
      return parseMessage(bytes, chunk_);
  }
}

bool Recording::readFrame(uint64_t number, RecordedFrame& out) {
  const Block& block = blockOf(number);
  const IndexRecord* index = nullptr;
  if (!indexOf(block, index) || !readGroom(block.groom)) return false;
  out.groom = shown_.groom;
  out.body = shown_.body;
  out.hairs = shown_.hairs;
  out.damage = shown_.damage;
  out.inputs.clear();
  out.poses.clear();
  RecordReader::Record record;
  uint64_t at = index->offsets[number - block.first_number];
  for (; reader_.skim(at, record) && isInput(record.kind); at = record.next) {
    if (record.kind == RecordKind::kPoseNames) continue;
    if (!reader_.read(at, record)) return false;
    if (record.kind == RecordKind::kPoses) {
      if (!parsePoses(record.bytes, at, out)) return false;
      continue;
    }
    Command command;
    if (out.inputs.size() == kMaxQueuedCommands || !parseMessage(record.bytes, command) || !isSound(command))
      return false;
    out.inputs.push_back(std::move(command));
  }
  if (!reader_.read(at, record) || record.kind != RecordKind::kFrame ||
      !parseFrame(record.bytes, out.record) || out.record.number != number)
    return false;

  assembler_.restart();
  out.frame.reset();
  for (uint32_t i = 0; i < out.record.chunks && !out.frame; ++i) {
    at = record.next;
    if (!reader_.read(at, record) || record.kind != RecordKind::kGuides || !parseGuides(record.bytes))
      return false;
    out.frame = assembler_.add(chunk_);
  }
  return out.frame != nullptr;
}

bool Recording::findEnd(uint64_t number, uint64_t& end) {
  const Block& block = blockOf(number);
  const IndexRecord* index = nullptr;
  if (!indexOf(block, index)) return false;
  RecordReader::Record record;
  uint64_t at = index->offsets[number - block.first_number];
  while (reader_.skim(at, record) && isInput(record.kind)) at = record.next;
  FrameRecord frame;
  if (!reader_.read(at, record) || record.kind != RecordKind::kFrame || !parseFrame(record.bytes, frame) ||
      frame.number != number)
    return false;
  for (uint32_t i = 0; i < frame.chunks; ++i)
    if (!reader_.skim(record.next, record) || record.kind != RecordKind::kGuides) return false;
  end = record.next;
  return true;
}

std::vector<std::string> Recording::warningsOf(const RecordedDamage& damage) const {
  std::vector<std::string> lines;
  const auto add = [&](bool is_damaged, const char* what, const char* instead) {
    if (is_damaged) lines.emplace_back(Error(what, name_, instead).what());
  };
  add(damage.body, "the body of the recording is damaged", "it is shown without a body");
  add(damage.hairs, "the hairs that follow the recorded guides are damaged or missing",
      "it is shown without them");
  add(damage.pose_names, "names of the recorded poses are damaged",
      "it can be shown, but not simulated again");
  return lines;
}

void Recording::fail(uint64_t number) const {
  throw Error("frame " + std::to_string(number) + " of the recording cannot be read", name_,
              number >= frames_ ? "it has " + std::to_string(frames_) : "the file is damaged there");
}

void Recording::read(uint64_t number, RecordedFrame& out) {
  if (number >= frames_ || !readFrame(number, out)) fail(number);
}

bool Recording::readGrids(uint64_t number, AirGrids& out) {
  uint64_t at = 0;
  if (number >= frames_ || !findEnd(number, at)) fail(number);
  RecordReader::Record record;
  GridRecord grids;
  for (uint32_t layer = 0; layer == 0 || layer < out.cells; layer += kGridLayers, at = record.next) {
    if (!reader_.skim(at, record) && is_cut_) return false;
    if (!reader_.read(at, record)) fail(number);
    if (record.kind != RecordKind::kGrids && layer == 0) return false;
    if (record.kind != RecordKind::kGrids || !parseRecord(record.bytes, grids) || grids.number != number ||
        grids.first_layer != layer || !addLayers(grids, out))
      fail(number);
  }
  return true;
}

}  // namespace strandcast
