#include "transport/recording/recording_publisher.h"

#include <spdlog/spdlog.h>

#include <algorithm>

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
  // At once: close() returns the failure, but may be hours away.
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
  if (!command) return command;
  if (command->kind == CommandKind::kAddCollider || command->kind == CommandKind::kAddColliderFile)
    unanswered_.push_back(*command);
  else
    record([&](Recorder& recorder) { recorder.addInput(*command); });
  return command;
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
