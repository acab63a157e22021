#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "transport/assembler.h"
#include "transport/messages.h"
#include "transport/publisher.h"
#include "transport/recording/air_grids.h"
#include "transport/recording/record_file.h"

namespace strandcast {

/// Descriptions that are damaged in the file. Frames are read without them.
struct RecordedDamage {
  bool body = false;        ///< it is empty instead
  bool hairs = false;       ///< those that follow guides, also where they are missing
  bool pose_names = false;  ///< the poses that are in their order are left out
};

/// One frame of a recording.
struct RecordedFrame {
  FrameRecord record;
  std::shared_ptr<const GuideFrame> frame;
  std::vector<Command> inputs;   ///< executed since the frame before
  std::vector<StepPoses> poses;  ///< of the steps since the frame before that live sources posed
  /// Where its hairs are damaged, its growth names none: hair grows from a seed if that was named too.
  std::shared_ptr<const GroomDescription> groom;
  std::shared_ptr<const BodyDescription> body;
  std::shared_ptr<const HairDescription> hairs;  ///< that follow the groom; null: none
  RecordedDamage damage;                         ///< of what describes this frame
};

/// Reads a recording in any order. The file is not trusted: memory is that of one frame, one groom and a few
/// numbers per kIndexFrames frames, and never more than the file could hold. A file that was cut, or not
/// closed, is read up to its last whole frame.
class Recording {
 public:
  /// Both throw Error when the file is no recording, is of another version, or has a damaged head.
  explicit Recording(const std::filesystem::path& file);
  /// `name` appears in errors.
  Recording(std::unique_ptr<RecordingBytes> bytes, const std::string& name);

  const RecordingHead& head() const { return head_; }
  uint64_t frames() const { return frames_; }
  double seconds() const { return seconds_; }  ///< of simulation, from the first frame to the last
  bool isCut() const { return is_cut_; }       ///< it was not closed, or its end is missing or damaged
  uint64_t bytes() const { return reader_.size(); }
  /// A line for each description that is damaged.
  std::vector<std::string> warningsOf(const RecordedDamage& damage) const;

  /// The last frame that is not later than this; 0 before the first.
  uint64_t frameAt(double seconds);
  /// Simulation time of frame `number`, s. Precondition: number < frames().
  double timeOf(uint64_t number);
  /// Reads frame `number`. Precondition: number < frames(). Throws Error where the file is damaged.
  void read(uint64_t number, RecordedFrame& out);
  /// Reads the grids of frame `number`; false where it has none, or the file was cut within them.
  /// Precondition: number < frames(). Throws Error where the file is damaged. Memory: one frame's grids.
  bool readGrids(uint64_t number, AirGrids& out);

 private:
  /// A run of frames of one groom.
  struct Block {
    uint64_t index = 0;  // offset of its kIndex; 0 = none: its offsets are in tail_
    uint64_t groom = 0;
    uint64_t first_number = 0, count = 0;
    double first_time = 0;
  };
  struct Shown {
    std::shared_ptr<const GroomDescription> groom;
    std::shared_ptr<const BodyDescription> body;
    std::shared_ptr<const HairDescription> hairs;
    RecordedDamage damage;
  };

  void readHead();
  bool readEnd();
  void scan();
  bool readIndex(uint64_t offset, IndexRecord& index);
  /// The block of a frame. Precondition: number < frames_.
  const Block& blockOf(uint64_t number) const;
  /// Loads the index of a block; false where it is damaged.
  bool indexOf(const Block& block, const IndexRecord*& index);
  bool readGroom(uint64_t offset);
  uint64_t readBody(uint64_t at);
  void readHairs(uint64_t at);
  bool readPoseNames(uint64_t offset);
  bool parsePoses(std::span<const uint8_t> bytes, uint64_t offset, RecordedFrame& out);
  // By the version of the file.
  bool parseGroom(std::span<const uint8_t> bytes, GroomChunk& chunk) const;
  bool parseFrame(std::span<const uint8_t> bytes, FrameRecord& record) const;
  bool parseGuides(std::span<const uint8_t> bytes);
  bool readFrame(uint64_t number, RecordedFrame& out);
  /// Offset of the record after the guides of a frame.
  bool findEnd(uint64_t number, uint64_t& end);
  [[noreturn]] void fail(uint64_t number) const;
  void add(const IndexRecord& index, uint64_t offset);
  void dropLast();

  const std::string name_;
  RecordReader reader_;
  RecordingHead head_;
  uint64_t first_record_ = 0;  // after the head
  std::vector<Block> blocks_;
  IndexRecord tail_;    // of frames that no index in the file covers
  IndexRecord loaded_;  // of the block that was used last
  uint64_t loaded_at_ = 0;
  uint64_t frames_ = 0;
  double seconds_ = 0;
  bool is_cut_ = false;

  uint64_t groom_at_ = 0;  // offset of the current groom
  PoseNamesRecord pose_names_;
  uint64_t pose_names_at_ = 0;  // their offset; 0 = none
  Shown shown_;
  GuideAssembler assembler_;
  GuideChunk chunk_;
};

}  // namespace strandcast
