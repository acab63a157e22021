#include "transport/recording/recording_publisher.h"

#include "core/error.h"

namespace strandcast {

template <class Work>
void RecordingPublisher::record(const Work& work) {
  try {
    if (recorder_) work(*recorder_);
  } catch (const Error& error) {
    if (failure_.empty()) failure_ = error.what();
  }
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
  record([&](Recorder& recorder) { recorder.close(); });
  return failure_;
}

}  // namespace strandcast
