#include "transport/in_process.h"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "core/error.h"
#include "transport/chunks.h"
#include "transport/codec/hair_codec.h"
#include "transport/commands.h"
#include "transport/frame_queue.h"
#include "transport/pose_inbox.h"

namespace strandcast {
namespace {

struct Channel {
  explicit Channel(uint32_t id) : groom_id(id), poses(id) {}
  const uint32_t groom_id;
  FrameQueue queue;
  FramePool pool;
  CommandQueue commands;
  PoseInbox poses;
  Answers answers;
  std::mutex mutex;  // guards all below
  std::optional<Status> status;
  ReceiveStatistics statistics;
  uint64_t newest_frame = 0;  // of the current groom
  bool has_publisher = true, has_subscriber = true;
};

class InProcessPublisher final : public Publisher {
 public:
  explicit InProcessPublisher(std::shared_ptr<Channel> channel) : channel_(std::move(channel)) {}
  ~InProcessPublisher() override {
    const std::lock_guard lock(channel_->mutex);
    channel_->has_publisher = false;
    channel_->status.reset();
  }

  void announce(const GroomDescription& groom, const BodyDescription& body) override {
    checkAnnouncement(groom, body, "groom " + groom.name);
    checkSuccession(groom_.get(), groom);
    auto own_groom = std::make_shared<GroomDescription>(groom);
    auto own_body = std::make_shared<BodyDescription>(body);
    own_groom->groom_id = own_body->groom_id = channel_->groom_id;
    own_body->session = groom.session;
    own_body->revision = groom.revision;
    groom_ = own_groom;
    channel_->queue.setBody(std::move(own_body));
    if (channel_->queue.setGroom(std::move(own_groom))) {
      const std::lock_guard lock(channel_->mutex);
      channel_->newest_frame = 0;
    }
  }

  void announceHairs(const HairDescription& hairs) override {
    if (!groom_)
      throw Error("no groom was announced", "hairs of an in-process channel", "announce the groom first");
    checkHairs(hairs, groom_->guides, hairs.source.empty() ? "hairs of groom " + groom_->name : hairs.source);
    auto own = std::make_shared<HairDescription>(hairs);
    own->groom_id = groom_->groom_id;
    own->session = groom_->session;
    own->revision = groom_->revision;
    channel_->queue.setHairs(std::move(own));
  }

  void announceColliders(const ColliderSet& colliders) override {
    checkColliders(colliders, "in-process channel");
    auto own = std::make_shared<ColliderSet>(colliders);
    own->groom_id = channel_->groom_id;
    channel_->queue.setColliders(std::move(own));
  }

  void publish(const GuideFrame& frame) override {
    if (!groom_ || frame.revision != groom_->revision || frame.positions.size() != groom_->guides.vertices())
      return;
    FramePool::Buffer copy = channel_->pool.acquire();
    *copy = frame;  // reuses the memory of a released frame
    copy->groom_id = channel_->groom_id;
    copy->arrival_time = steadyTime();
    {
      const std::lock_guard lock(channel_->mutex);
      if (frame.frame <= channel_->newest_frame) return channel_->pool.release(std::move(copy));
      if (channel_->newest_frame != 0)
        channel_->statistics.frames_lost += frame.frame - channel_->newest_frame - 1;
      channel_->newest_frame = frame.frame;
      ++channel_->statistics.frames_received;
    }
    channel_->queue.push(channel_->pool.share(std::move(copy)), latencyMs(frame.publish_time));
  }

  void publishStatus(const Status& status) override {
    {
      const std::lock_guard lock(channel_->mutex);
      channel_->status = status;
      channel_->status->groom_id = channel_->groom_id;
    }
    // After the status, so that a thread that sees the answer sees its effects
    channel_->answers.post(status);
  }

  std::optional<Command> takeCommand() override { return channel_->commands.take(); }
  std::optional<PoseSamples> takePoses() override { return channel_->poses.take(); }

  uint32_t matchedReaders() const override {
    const std::lock_guard lock(channel_->mutex);
    return channel_->has_subscriber ? 1 : 0;
  }
  EncodingReport encoding() const override { return {}; }
  std::optional<ConflictingDaemon> conflict() const override { return std::nullopt; }

 private:
  std::shared_ptr<Channel> channel_;
  std::shared_ptr<const GroomDescription> groom_;
};

class InProcessSubscriber final : public Subscriber {
 public:
  explicit InProcessSubscriber(std::shared_ptr<Channel> channel) : channel_(std::move(channel)) {}
  ~InProcessSubscriber() override {
    const std::lock_guard lock(channel_->mutex);
    channel_->has_subscriber = false;
  }

  const std::shared_ptr<Channel>& channel() const { return channel_; }
  std::shared_ptr<const GroomDescription> groom() const override { return channel_->queue.groom(); }
  std::shared_ptr<const BodyDescription> body() const override { return channel_->queue.body(); }
  std::shared_ptr<const HairDescription> hairs() const override { return channel_->queue.hairs(); }
  std::shared_ptr<const ColliderSet> colliders() const override { return channel_->queue.colliders(); }
  std::shared_ptr<const GuideFrame> frame() const override { return channel_->queue.frame(); }
  void keepFrames(size_t count) override { channel_->queue.keep(count); }
  std::shared_ptr<const GuideFrame> waitForFrame(uint64_t after, std::chrono::milliseconds timeout) override {
    return channel_->queue.waitForFrame(after, timeout);
  }
  std::shared_ptr<const GuideFrame> waitForNext(const GuideFrame* last,
                                                std::chrono::milliseconds timeout) override {
    return channel_->queue.waitForNext(last, timeout);
  }
  bool waitForGroom(std::chrono::milliseconds timeout) override {
    return channel_->queue.waitForGroom(timeout);
  }

  std::optional<Status> status() const override {
    const std::lock_guard lock(channel_->mutex);
    return channel_->status;
  }
  std::vector<Status> allStatuses() const override {
    const std::optional<Status> one = status();
    return one ? std::vector<Status>{*one} : std::vector<Status>{};
  }

  void send(const Command& command, const std::function<bool()>&) override {
    checkCommand(command, channel_->groom_id);
    const std::lock_guard lock(channel_->mutex);
    if (!channel_->has_publisher) {
      throw Error("nobody takes commands", "groom " + std::to_string(channel_->groom_id),
                  "the simulation in this process has ended");
    }
    Command own = command;
    own.groom_id = channel_->groom_id;
    channel_->commands.push(std::move(own));
  }

  std::optional<std::string> waitForAnswer(uint64_t command, std::chrono::milliseconds timeout) override {
    return channel_->answers.wait(command, timeout);
  }

  ReceiveStatistics statistics() const override {
    ReceiveStatistics statistics;
    {
      const std::lock_guard lock(channel_->mutex);
      statistics = channel_->statistics;
    }
    channel_->queue.addLatencies(statistics);
    return statistics;
  }

 private:
  std::shared_ptr<Channel> channel_;
};

class InProcessPoseSender final : public PoseSender {
 public:
  explicit InProcessPoseSender(std::shared_ptr<Channel> channel)
      : PoseSender(channel->groom_id, 1), channel_(std::move(channel)) {}

 private:
  void write(PoseSamples& message) override { channel_->poses.push(message); }
  std::shared_ptr<Channel> channel_;
};

}  // namespace

std::pair<std::unique_ptr<Publisher>, std::unique_ptr<Subscriber>> makeInProcessChannel(uint32_t groom_id) {
  checkGroomId(groom_id, "makeInProcessChannel");
  auto channel = std::make_shared<Channel>(groom_id);
  return {std::make_unique<InProcessPublisher>(channel), std::make_unique<InProcessSubscriber>(channel)};
}

std::unique_ptr<PoseSender> makeInProcessPoseSender(const Subscriber& subscriber) {
  const auto* const end = dynamic_cast<const InProcessSubscriber*>(&subscriber);
  if (end == nullptr)
    throw Error("the channel leaves this process", "makeInProcessPoseSender", "use its own sender of poses");
  return std::make_unique<InProcessPoseSender>(end->channel());
}

}  // namespace strandcast
