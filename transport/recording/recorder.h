// Writes recordings: Recorder, and a publisher that also records what it publishes.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "transport/chunks.h"
#include "transport/codec/codec.h"
#include "transport/codec/guide_encoder.h"
#include "transport/publisher.h"
#include "transport/recording/air_grids.h"
#include "transport/recording/record_file.h"

namespace strandcast {

/// Options of a recording.
struct RecordingOptions {
  uint32_t groom_id = 1;
  CodecOptions codec;  ///< kTemporal is written as kOctahedral12: every frame of a recording decodes alone
  std::string source;  ///< for resimulation: RecordingHead::source
};

/// When the recording's file is created, and an existing one truncated.
enum class MakeFile {
  kAtOnce,
  kWithGroom  ///< by the first setGroom()
};

/// Writes a stream into a file that can be replayed up to its end, even if the program that writes it dies.
/// Memory: a frame's largest chunk and kIndexFrames offsets.
class Recorder {
 public:
  /// Throws Error when the file cannot be created now or, as far as is known, later: another program may have
  /// it open.
  Recorder(const std::filesystem::path& file, const RecordingOptions& options,
           MakeFile when = MakeFile::kAtOnce);
  /// Closes the file and ignores errors.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // All throw Error when the file cannot be written, and close it.

  /// Call before the first frame, and whenever session or revision change. Throws Error as
  /// Publisher::announce().
  void setGroom(const GroomDescription& groom, const BodyDescription& body);
  /// Records hairs that follow the groom, directly after setGroom(). Throws Error as
  /// Publisher::announceHairs().
  void setHairs(const HairDescription& hairs);
  /// Records a command that is executed before the next frame.
  void addInput(const Command& command);
  /// Records the poses of a step before the next frame; at most kMaxPosesPerFrame, which are sound.
  void addPoses(const StepPoses& poses);
  /// Records a frame of the groom that was set. Skips it and returns false if it is of another groom, not
  /// newer than the last, or not finite.
  bool addFrame(const GuideFrame& frame);
  /// Records grids of the frame added last, once. Skips them and returns false if that frame was skipped or
  /// the grids are not isSound().
  bool addGrids(const AirGrids& grids);
  /// Writes the index. Nothing can be added afterwards.
  void close();

  uint64_t frames() const { return number_; }
  uint64_t gridFrames() const { return grid_frames_; }          ///< frames with grids
  double seconds() const { return time_; }                      ///< of simulation
  uint64_t bytes() const { return file_ ? file_->size() : 0; }  ///< written
  bool isOpen() const { return is_open_; }

 private:
  void makeFile();
  template <class Record>
  uint64_t writeRecord(RecordKind kind, const Record& record);
  template <class Message>
  uint64_t writeMessage(RecordKind kind, const Message& message);
  void writeIndex();
  void writeFullIndex();
  template <class Record>
  uint64_t writeInput(RecordKind kind, const Record& record);
  template <class Work>
  void guarded(const Work& work);

  const std::filesystem::path path_;
  const RecordingOptions options_;
  std::optional<RecordWriter> file_;
  GuideEncoder encoder_;
  bool is_open_ = true;
  uint64_t session_ = 0;  // of the current groom
  uint32_t revision_ = 0;
  StrandSet guides_;  // at rest
  IndexRecord index_;
  uint64_t inputs_at_ = 0;  // offset of the first input of the next frame; 0 = none yet
  PoseNamesRecord pose_names_;
  uint64_t pose_names_at_ = 0;  // 0 = none yet
  size_t poses_ = 0;            // of the next frame
  uint64_t number_ = 0;
  double time_ = 0, interval_ = 0, simulation_time_ = 0;
  uint64_t newest_ = 0;  // newest frame number of the current groom; 0 = none
  uint64_t grid_frames_ = 0;
  bool grids_may_follow_ = false;
  GuideChunk chunk_;
  std::vector<uint8_t> bytes_;
};

/// FNV-1a, 64 bits, of all positions as float32, in natural order.
uint64_t positionsHash(std::span<const Vec3> positions);

/// A publisher that also records what is published: groom, frames before any network's codec, and the
/// commands that were taken, and the poses of live sources, each before the first frame that it affects. A
/// command that adds a collider or moves a collider or the head is recorded when a status confirms it, which
/// may be many frames later, and not at all when it is refused: a name that was taken then, or a head that a
/// source moved, may be free in a resimulation. When the file cannot be written any more, that is logged and
/// publishing continues without it.
class RecordingPublisher final : public Publisher {
 public:
  /// With `casts` false (no reader of `publisher`), a failure is not logged; close() returns it.
  explicit RecordingPublisher(std::unique_ptr<Publisher> publisher, bool casts = true)
      : publisher_(std::move(publisher)), casts_(casts) {}
  /// Records from announce() on, which creates the file: an existing one remains until then. Throws Error
  /// when it cannot be created.
  void open(const std::filesystem::path& file, const RecordingOptions& options) {
    recorder_.emplace(file, options, MakeFile::kWithGroom);
  }

  void announce(const GroomDescription& groom, const BodyDescription& body) override;
  void announceHairs(const HairDescription& hairs) override;
  void announceColliders(const ColliderSet& colliders) override { publisher_->announceColliders(colliders); }
  void publish(const GuideFrame& frame) override;
  void publishFrom(GuideFrame& frame, GuideSource& guides) override;
  void publishStatus(const Status& status) override;
  std::optional<Command> takeCommand() override;
  std::optional<PoseSamples> takePoses() override { return publisher_->takePoses(); }
  void recordPoses(const StepPoses& poses) override;
  uint32_t matchedReaders() const override { return publisher_->matchedReaders(); }
  EncodingReport encoding() const override { return publisher_->encoding(); }
  std::optional<ConflictingDaemon> conflict() const override { return publisher_->conflict(); }
  std::chrono::milliseconds listenTime() const override { return publisher_->listenTime(); }
  size_t possibleConflicts() const override { return publisher_->possibleConflicts(); }
  CastingState castingState() const override { return publisher_->castingState(); }
  bool pollClaimLoss() override { return publisher_->pollClaimLoss(); }
  size_t sharers() const override { return publisher_->sharers(); }
  bool wantsHair() const override { return publisher_->wantsHair(); }
  void publishShow(const Show& show) override { publisher_->publishShow(show); }
  std::optional<Show> takeShow() override { return publisher_->takeShow(); }
  std::string failure() const override { return publisher_->failure(); }

  /// Records grids of the frame published last, as Recorder::addGrids().
  void addGrids(const AirGrids& grids);

  /// Precondition: open() was called.
  const Recorder& recorder() const { return *recorder_; }
  /// Closes the file. Returns the first error, now or before; empty where there was none.
  std::string close();

 private:
  template <class Work>
  void attempt(const Work& work);
  template <class Work>
  void record(const Work& work);

  const std::unique_ptr<Publisher> publisher_;
  const bool casts_;
  std::optional<Recorder> recorder_;
  std::string failure_;
  std::vector<Command> unanswered_;  ///< commands that are recorded once they are confirmed
};

}  // namespace strandcast
