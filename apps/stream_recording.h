#pragma once
#include <chrono>
#include <filesystem>

#include "transport/recording/recorder.h"
#include "transport/subscriber.h"

namespace strandcast {

/// Writes what a subscriber receives into a recording, frame after frame. An old file of that name stays
/// until there is a groom to write.
class StreamRecording {
 public:
  /// Frames that the subscriber keeps meanwhile: a second in which the disk or the processor is busy, at 60
  /// a second.
  static constexpr size_t kFramesKept = 64;

  /// Throws Error when the file cannot be made. `subscriber` outlives it.
  StreamRecording(Subscriber& subscriber, const std::filesystem::path& file, const RecordingOptions& options)
      : subscriber_(subscriber), recorder_(file, options, MakeFile::kWithGroom) {
    subscriber_.keepFrames(kFramesKept);
  }
  ~StreamRecording() { subscriber_.keepFrames(kFrameQueueLength); }
  StreamRecording(const StreamRecording&) = delete;
  StreamRecording& operator=(const StreamRecording&) = delete;

  /// Waits for the next frame and writes it, where it is of another moment than the last; false when none
  /// came in time. Throws Error as Recorder.
  bool take(std::chrono::milliseconds timeout);
  void close() { recorder_.close(); }

  const Recorder& recorder() const { return recorder_; }
  /// That were lost on the way or came faster than they could be written.
  uint64_t skipped() const { return skipped_; }

 private:
  bool describe(const GuideFrame& frame);

  Subscriber& subscriber_;
  Recorder recorder_;
  uint64_t session_ = 0, skipped_ = 0;
  std::shared_ptr<const GuideFrame> last_;
  uint32_t revision_ = 0;
};

}  // namespace strandcast
