#pragma once
#include <chrono>
#include <filesystem>

#include "transport/recording/recorder.h"
#include "transport/subscriber.h"

namespace strandcast {

/// Records the frames that a subscriber receives. An existing file of that name is kept until there is a
/// groom to write.
class StreamRecording {
 public:
  /// Frames that the subscriber queues meanwhile: about a second of a busy disk or processor at 60 a second.
  static constexpr size_t kFramesKept = 64;

  /// Throws Error where the file cannot be created. `subscriber` must outlive this.
  StreamRecording(Subscriber& subscriber, const std::filesystem::path& file, const RecordingOptions& options)
      : subscriber_(subscriber), recorder_(file, options, MakeFile::kWithGroom) {
    subscriber_.keepFrames(kFramesKept);
  }
  ~StreamRecording() { subscriber_.keepFrames(kFrameQueueLength); }
  StreamRecording(const StreamRecording&) = delete;
  StreamRecording& operator=(const StreamRecording&) = delete;

  /// Waits for the next frame and writes it unless its time equals the last one's; false on timeout. Throws
  /// Error as Recorder.
  bool take(std::chrono::milliseconds timeout);
  void close() { recorder_.close(); }

  const Recorder& recorder() const { return recorder_; }
  /// Frames lost on the network or dropped because writing was slower than the stream.
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
