#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "transport/publisher.h"
#include "transport/recording/recorder.h"

namespace strandcast {

/// A publisher that also records what is published: groom, frames before any network's codec, and the
/// commands that were taken, each before the first frame that it affects. A command that adds a collider is
/// recorded when a status confirms it, which may be many frames later, and not at all when it is refused: a
/// name that was taken then may be free in a resimulation. When the file cannot be written any more, that is
/// logged and publishing continues without it.
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
  void announceColliders(const ColliderSet& colliders) override { publisher_->announceColliders(colliders); }
  void publish(const GuideFrame& frame) override;
  void publishStatus(const Status& status) override;
  std::optional<Command> takeCommand() override;
  uint32_t matchedReaders() const override { return publisher_->matchedReaders(); }
  EncodingReport encoding() const override { return publisher_->encoding(); }
  std::optional<Rival> rival() const override { return publisher_->rival(); }
  std::chrono::milliseconds listenTime() const override { return publisher_->listenTime(); }
  size_t possibleRivals() const override { return publisher_->possibleRivals(); }
  CastingState castingState() const override { return publisher_->castingState(); }
  bool takeLapse() override { return publisher_->takeLapse(); }
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
  std::vector<Command> unanswered_;  ///< commands that add colliders
};

}  // namespace strandcast
