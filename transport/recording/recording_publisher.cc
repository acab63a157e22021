#include "transport/recording/recording_publisher.h"

#include <spdlog/spdlog.h>

#include "core/error.h"

namespace strandcast {

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
  // The end, which tells it, may be hours away.
  if (casts_ && was_sound && !failure_.empty())
    spdlog::error("casting goes on, recording does not: {}", failure_);
}

void RecordingPublisher::announce(const GroomDescription& groom, const BodyDescription& body) {
  publisher_->announce(groom, body);
  record([&](Recorder& recorder) { recorder.setGroom(groom, body); });
}

void RecordingPublisher::publish(const GuideFrame& frame) {
  publisher_->publish(frame);
  record([&](Recorder& recorder) { recorder.addFrame(frame); });
}

std::optional<Command> RecordingPublisher::takeCommand() {
  std::optional<Command> command = publisher_->takeCommand();
  if (command) record([&](Recorder& recorder) { recorder.addInput(*command); });
  return command;
}

void RecordingPublisher::addGrids(const AirGrids& grids) {
  record([&](Recorder& recorder) { recorder.addGrids(grids); });
}

std::string RecordingPublisher::close() {
  attempt([](Recorder& recorder) { recorder.close(); });
  return failure_;
}

}  // namespace strandcast
