#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "transport/publisher.h"
#include "transport/recording/recorder.h"

namespace strandcast {

/// A publisher that also records what goes through it: groom, frames as they were before any network's codec,
/// and the commands that were taken, each before the frame that it had an effect on. A collider that is added
/// is recorded where the status answers that it is there, which may be many frames later, and one that is
/// refused is not: a name that was taken then may be free when the run is repeated. When the file cannot be
/// written any more, that is logged and casting goes on without it.
class RecordingPublisher final : public Publisher {
 public:
  /// Where nobody listens to `publisher` a failure is not logged: close() tells it.
  explicit RecordingPublisher(std::unique_ptr<Publisher> publisher, bool casts = true)
      : publisher_(std::move(publisher)), casts_(casts) {}
  /// Records from announce() on, which makes the file: an old one stays until then. Throws Error when it
  /// cannot be made.
  void open(const std::filesystem::path& file, const RecordingOptions& options) {
    recorder_.emplace(file, options, MakeFile::kWithGroom);
  }

  void announce(const GroomDescription& groom, const BodyDescription& body) override;
  void announceColliders(const ColliderSet& colliders) override { publisher_->announceColliders(colliders); }
  void publish(const GuideFrame& frame) override;
  void publishStatus(const Status& status) override;
  std::optional<Command> takeCommand() override;
  uint32_t matchedReaders() const override { return publisher_->matchedReaders(); }
  EncodingReport encoding() const override { return publisher_->encoding(); }
  std::optional<Rival> rival() const override { return publisher_->rival(); }
  std::chrono::milliseconds listenTime() const override { return publisher_->listenTime(); }
  size_t possibleRivals() const override { return publisher_->possibleRivals(); }
  SharedTurn sharedTurn() const override { return publisher_->sharedTurn(); }
  bool lapsed() override { return publisher_->lapsed(); }
  size_t sharers() const override { return publisher_->sharers(); }
  bool wantsHair() const override { return publisher_->wantsHair(); }
  void publishShow(const Show& show) override { publisher_->publishShow(show); }
  std::optional<Show> takeShow() override { return publisher_->takeShow(); }
  std::string failure() const override { return publisher_->failure(); }

  /// Those of the frame that was published last, as Recorder.
  void addGrids(const AirGrids& grids);

  /// Of an open() one.
  const Recorder& recorder() const { return *recorder_; }
  /// Closes the file. What went wrong with it, now or before; empty where nothing did.
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
  std::vector<Command> unanswered_;  ///< that add colliders
};

}  // namespace strandcast
