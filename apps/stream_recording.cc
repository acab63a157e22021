#include "apps/stream_recording.h"

#include "apps/stream_scene.h"

namespace strandcast {

/// Records the groom of the frame once it has arrived complete.
bool StreamRecording::describe(const GuideFrame& frame) {
  const StreamScene scene = StreamScene::of(subscriber_);
  if (!scene.fits(frame)) return false;
  recorder_.setGroom(*scene.groom, *scene.body);
  return true;
}

bool StreamRecording::take(std::chrono::milliseconds timeout) {
  const auto frame = subscriber_.waitForNext(last_.get(), timeout);
  if (!frame) return false;
  const bool is_new = frame->session != session_ || frame->revision != revision_ ||
                      frame->frame <= last_->frame;  // the frame count restarted
  if (!is_new && frame->frame > last_->frame + 1) skipped_ += frame->frame - last_->frame - 1;
  const bool is_same = !is_new && frame->simulation_time == last_->simulation_time;  // of a paused daemon
  last_ = frame;
  if (is_same) return true;
  if (is_new && !describe(*frame)) return true;
  session_ = frame->session;
  revision_ = frame->revision;
  recorder_.addFrame(*frame);
  return true;
}

}  // namespace strandcast
