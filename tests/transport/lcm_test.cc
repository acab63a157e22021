#include "transport/lcm.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <set>
#include <sstream>
#include <thread>

#include "bound_hairs.h"
#include "dds_domain.h"
#include "limb.h"
#include "lossy_link.h"
#include "moving_hair.h"
#include "steering.h"
#include "tests/expect_error.h"
#include "tests/full_disk.h"
#include "tests/thorough.h"
#include "transport/lcm/lcm_ends.h"
#include "transport/lcm/lcm_messages.h"
#include "transport/parameter_table.h"
#include "transport/publisher.h"
#include "true_within.h"

namespace strandcast {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kPatience{30000};  // for a loaded machine; a passing test never waits this long

bool becomesTrue(const std::function<bool()>& condition) { return trueWithin(kPatience, condition); }

LcmOptions options(uint64_t session, Codec codec = Codec::kDelta16) { return {"", 1, session, {codec}}; }

GroomDescription hair(size_t strands = 1500) {
  return hairGroom(strands, [](size_t) { return 16; });
}

/// Publishes frame `number` and expects the subscriber to receive it.
::testing::AssertionResult goesThrough(Publisher& publisher, Subscriber& subscriber,
                                       const GroomDescription& groom, uint64_t number) {
  const GuideFrame sent = hairFrame(groom, number);
  publisher.publish(sent);
  const auto frame = subscriber.waitForFrame(number - 1, kPatience);
  if (!frame || frame->frame != number)
    return ::testing::AssertionFailure() << "frame " << number << " is lost";
  for (size_t v = 0; v < sent.positions.size(); ++v) {
    if (!((sent.positions[v] - frame->positions[v]).norm() <= 1.001e-5f))
      return ::testing::AssertionFailure() << "vertex " << v << " is elsewhere";
  }
  return ::testing::AssertionSuccess();
}

void expectEverything(Publisher& publisher, Subscriber& subscriber, const GroomDescription& groom = hair()) {
  publisher.announce(groom, sampleBody(60));
  ASSERT_TRUE(subscriber.waitForGroom(kPatience));
  EXPECT_EQ(subscriber.groom()->guides.positions, groom.guides.positions);
  EXPECT_EQ(subscriber.groom()->guides.offsets, groom.guides.offsets);
  EXPECT_EQ(subscriber.body()->mesh.triangles, sampleBody(60).mesh.triangles);
  publisher.announceColliders(sampleColliders());
  ASSERT_TRUE(becomesTrue([&] { return subscriber.colliders() && subscriber.colliders()->revision == 1; }));
  EXPECT_TRUE(areAlike(*subscriber.colliders(), sampleColliders()));
  EXPECT_TRUE(becomesTrue([&] { return publisher.matchedReaders() == 1; }));
  for (uint64_t number = 1; number <= 5; ++number)
    EXPECT_TRUE(goesThrough(publisher, subscriber, groom, number));
  EXPECT_EQ(subscriber.statistics().frames_lost, 0u);
  EXPECT_EQ(subscriber.statistics().frames_concealed, 0u);
  EXPECT_EQ(subscriber.statistics().chunks_rejected, 0u);
  EXPECT_EQ(publisher.encoding().codec, "delta16");

  Command command;
  command.id = 42;
  command.kind = CommandKind::kSetParameter;
  command.name = "wind";
  command.values = {1, 0, 2.5};
  subscriber.send(command);
  std::optional<Command> taken;
  ASSERT_TRUE(becomesTrue([&] { return (taken = publisher.takeCommand()).has_value(); }));
  EXPECT_EQ(taken->id, 42u);
  EXPECT_EQ(taken->name, "wind");
  EXPECT_EQ(taken->values, command.values);
  Status status;
  status.backend = "simd";
  status.last_command = 42;
  status.encoding = publisher.encoding();
  status.parameters = parameterTable(Parameters());
  publisher.publishStatus(status);
  EXPECT_EQ(subscriber.waitForAnswer(42, kPatience), "");
  ASSERT_TRUE(becomesTrue([&] { return subscriber.status() && subscriber.status()->last_command == 42; }));
  EXPECT_EQ(subscriber.status()->backend, "simd");
  EXPECT_EQ(namedValues(subscriber.status()->parameters), namedValues(status.parameters));
  EXPECT_EQ(subscriber.status()->session, 11u);
  EXPECT_EQ(subscriber.status()->encoding.frame_bytes, publisher.encoding().frame_bytes);
  EXPECT_FALSE(publisher.conflict()) << "its own status is no rival's";
}

TEST(Lcm, GroomFramesStatusAndCommandsGoThrough) {
  const auto link = std::make_shared<LossyLink>();
  const auto publisher = makeLcmPublisher(link, options(11));
  const auto subscriber = makeLcmSubscriber(link, options(0));
  expectEverything(*publisher, *subscriber);
}

TEST(Lcm, WhoOnlySteersIsNoReader) {
  const auto link = std::make_shared<LossyLink>();
  const auto publisher = makeLcmPublisher(link, options(11));
  LcmOptions steering = options(0);
  steering.frames = false;
  expectSteersAlone(*publisher, *makeLcmSubscriber(link, steering));
}

TEST(Lcm, AFrameOfAsManyBentCollidersAsItHoldsArrives) {
  const auto link = std::make_shared<LossyLink>();
  const auto publisher = makeLcmPublisher(link, options(11, Codec::kFloat32));
  const auto subscriber = makeLcmSubscriber(link, options(0));
  const GroomDescription groom = uniformGroom(1000, 10);  // more than a chunk
  publisher->announce(groom, sampleBody(3));
  ASSERT_TRUE(subscriber->waitForGroom(kPatience));
  GuideFrame sent = sampleFrame(groom, 1);
  sent.colliders.clear();
  for (uint32_t id = 0; id < kMaxPlacedColliders; ++id)
    sent.colliders.push_back({id, Pose{}, sampleBend(id + 1)});
  publisher->publish(sent);
  const auto frame = subscriber->waitForFrame(0, kPatience);
  ASSERT_TRUE(frame);
  ASSERT_EQ(frame->colliders.size(), kMaxPlacedColliders);
  for (uint32_t id = 0; id < kMaxPlacedColliders; ++id)
    EXPECT_TRUE(areAlike(frame->colliders[id].bend, sampleBend(id + 1))) << id;
}

/// LCM's threads pass messages on under GLib's locks. GLib is not instrumented, so the thread sanitizer
/// cannot see their order and would report each message. Our handlers are checked with LossyLink instead.
#ifdef __SANITIZE_THREAD__
constexpr bool kLcmIsWatched = true;
#else
constexpr bool kLcmIsWatched = false;
#endif

class LcmItself : public testing::Test {
 protected:
  void SetUp() override {
    if (kLcmIsWatched) GTEST_SKIP() << "the thread sanitizer does not understand GLib's locks";
  }
};

TEST_F(LcmItself, MemoryQueueCarriesEverything) {
  const auto [publisher, subscriber] = makeLcmChannel({"memq://", 1, 11, {}});
  expectEverything(*publisher, *subscriber);
}

TEST_F(LcmItself, MulticastCarriesEverything) {
  const std::string url = lcmUrl(testDomain(3));
  std::unique_ptr<Publisher> publisher;
  const std::string error = errorOf([&] { publisher = makeLcmPublisher({url, 1, 11, {}}); });
  if (!publisher) GTEST_SKIP() << error;
  const auto subscriber = makeLcmSubscriber({url, 1, 0, {}});
  // A frame in one datagram: sockets drop parts of bursts
  expectEverything(*publisher, *subscriber, hair(200));
}

TEST_F(LcmItself, ALogFileIsReplayed) {
  const auto file =
      std::filesystem::temp_directory_path() / ("strandcast_lcm_" + std::to_string(getpid()) + ".log");
  const GroomDescription groom = hair();
  {
    const auto publisher = makeLcmPublisher({"file://" + file.string() + "?mode=w", 1, 11, {}});
    publisher->announce(groom, sampleBody(10));
    for (uint64_t number = 1; number <= 5; ++number) publisher->publish(hairFrame(groom, number));
  }
  for (int again = 0; again < 20;
       ++again) {  // a reader that starts before all channels are registered loses the groom
    const auto subscriber = makeLcmSubscriber({"file://" + file.string() + "?mode=r&speed=0", 1, 0, {}});
    ASSERT_TRUE(becomesTrue([&] { return subscriber->frame() && subscriber->frame()->frame == 5; })) << again;
    EXPECT_EQ(subscriber->groom()->guides.positions, groom.guides.positions);
    EXPECT_EQ(subscriber->statistics().frames_received, 5u);
    EXPECT_FALSE(subscriber->mayCommand());
    const Command command{.groom_id = 1, .id = 7, .kind = CommandKind::kReset, .name = "", .values = {}};
    EXPECT_NE(errorOf([&] { ask(*subscriber, command, [] { return false; }); }).find("takes no commands"),
              std::string::npos);
  }
  std::filesystem::remove(file);
}

TEST_F(LcmItself, ALogThatCannotBeWrittenIsSaidOnce) {
  const auto file =
      std::filesystem::temp_directory_path() / ("strandcast_full_" + std::to_string(getpid()) + ".log");
  const GroomDescription groom = hair(100);
  const auto publisher = makeLcmPublisher({"file://" + file.string() + "?mode=w", 1, 11, {}});
  publisher->announce(groom, sampleBody(3));
  EXPECT_EQ(publisher->failure(), "");
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  {
    const FullDisk disk(std::filesystem::file_size(file) + 10000);
    for (uint64_t number = 1; number <= 9; ++number) publisher->publish(hairFrame(groom, number));
  }
  spdlog::set_default_logger(before);
  EXPECT_NE(publisher->failure().find("is the disk full?"), std::string::npos) << publisher->failure();
  const std::string said = log.str();
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  std::filesystem::remove(file);
}

TEST(Lcm, PosesReachTheGroomsOfACharacter) {
  const auto link = std::make_shared<LossyLink>();
  const auto head = makeLcmPublisher(link, options(11));
  LcmOptions of_beard = options(12), of_other = options(13);
  of_beard.groom_id = 2;
  of_other.groom_id = 3;
  const auto beard = makeLcmPublisher(link, of_beard), other = makeLcmPublisher(link, of_other);
  const auto one = makeLcmPoseSender(link, options(0)), both = makeLcmPoseSender(link, options(0), {2});
  const Pose pose{Vec3(1, 2, 3), Quat(0.8f, 0, 0.6f, 0)};
  for (PoseSender* const sender : {one.get(), both.get()}) {
    sender->setNames({"head"});
    sender->send(7, {&pose, 1});
  }
  std::optional<PoseSamples> taken;
  for (const auto& [publisher, sender] :
       {std::pair(head.get(), one.get()), {head.get(), both.get()}, {beard.get(), both.get()}}) {
    ASSERT_TRUE(becomesTrue([&] { return (taken = publisher->takePoses()).has_value(); }));
    EXPECT_EQ(taken->source, sender->source());
    EXPECT_EQ(taken->time, 7u);
    EXPECT_EQ(taken->names, "head");
    EXPECT_EQ(taken->poses, (std::vector<float>{1, 2, 3, 0, 0.6f, 0, 0.8f}));
  }
  EXPECT_FALSE(head->takePoses() || beard->takePoses() || other->takePoses());
}

TEST(Lcm, APoseIsLostOnlyWithThreeMessages) {
  constexpr uint32_t kSent = 200;
  const auto link = std::make_shared<LossyLink>(Losses{0.1, 0.05, 0.1, 3});
  const auto publisher = makeLcmPublisher(link, options(11));
  const auto sender = makeLcmPoseSender(link, options(0));
  sender->setNames({"head"});
  for (uint32_t i = 1; i <= kSent; ++i) {
    const Pose pose{Vec3(static_cast<float>(i), 0, 0), Quat::Identity()};
    sender->send(1000 * i, {&pose, 1});
  }
  link->setLosses({});
  const Pose last{Vec3::Zero(), Quat::Identity()};
  sender->send(1000 * (kSent + 1), {&last, 1});
  std::set<uint32_t> arrived;
  uint32_t newest = 0;
  EXPECT_TRUE(becomesTrue([&] {
    while (const std::optional<PoseSamples> taken = publisher->takePoses()) {
      newest = std::max(newest, taken->newest);
      for (uint32_t k = 0; k < taken->ages.size(); ++k) {
        const uint32_t number = taken->newest - k;
        EXPECT_EQ(taken->time - taken->ages[k], 1000u * number);
        EXPECT_EQ(taken->poses[7 * k], number <= kSent ? static_cast<float>(number) : 0.0f);
        arrived.insert(number);
      }
    }
    return newest == kSent + 1;
  }));
  EXPECT_GE(arrived.size(), kSent - 1);  // 0.1^3 of 200
}

TEST(Lcm, ALateReaderIsGivenTheGroomAtOnce) {
  const auto link = std::make_shared<LossyLink>();
  const auto publisher = makeLcmPublisher(link, options(11));
  const GroomDescription groom = hair(5000);
  publisher->announce(groom, sampleBody(60));
  const auto subscriber = makeLcmSubscriber(link, options(0));
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(subscriber->waitForGroom(kPatience));
  EXPECT_TRUE(goesThrough(*publisher, *subscriber, groom, 100));
  std::printf("complete after %.0f ms\n",
              std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
}

TEST(Lcm, HairsReachPresentAndLateReaders) {
  const auto link = std::make_shared<LossyLink>();
  const auto publisher = makeLcmPublisher(link, options(11));
  const auto present = makeLcmSubscriber(link, options(0));
  GroomDescription groom = hair(500);
  groom.growth = GroomDescription::kHairs;
  const HairDescription hairs = boundHairs(groom.guides, 8000);  // of more chunks than are repeated unasked
  publisher->announce(groom, sampleBody(20));
  publisher->announceHairs(hairs);
  const float error = 1.001f * CodecOptions().hair_error;
  ASSERT_TRUE(becomesTrue([&] { return present->hairs() != nullptr; }));
  EXPECT_TRUE(areAlike(*present->hairs(), hairs, error));
  const auto first = present->hairs();
  const auto late = makeLcmSubscriber(link, options(0));
  ASSERT_TRUE(becomesTrue([&] { return late->hairs() != nullptr; }));
  EXPECT_TRUE(areAlike(*late->hairs(), hairs, error));
  EXPECT_EQ(present->hairs(), first) << "repeated hairs are no new ones";
  EXPECT_EQ(late->statistics().chunks_rejected, 0u);
  {
    link->setLosses({0.3, 0.05, 0.05, 7});
    const auto unlucky = makeLcmSubscriber(link, options(0));
    ASSERT_TRUE(becomesTrue([&] { return unlucky->hairs() != nullptr; })) << "it asks until all are here";
    EXPECT_TRUE(areAlike(*unlucky->hairs(), hairs, error));
    link->setLosses({});
  }
  GroomDescription next = groom;
  next.revision = 2;
  next.growth = GroomDescription::kFromSeed;
  publisher->announce(next, sampleBody(20));
  ASSERT_TRUE(becomesTrue([&] { return late->groom()->revision == 2; }));
  EXPECT_FALSE(late->hairs()) << "the new groom has none";
}

TEST(Lcm, ANewSessionIsNoticedAndItsGroomFetched) {
  const auto link = std::make_shared<LossyLink>();
  auto publisher = makeLcmPublisher(link, options(11));
  const auto subscriber = makeLcmSubscriber(link, options(0));
  GroomDescription groom = hair();
  publisher->announce(groom, sampleBody(10));
  ASSERT_TRUE(subscriber->waitForGroom(kPatience));
  EXPECT_TRUE(goesThrough(*publisher, *subscriber, groom, 7));
  publisher.reset();
  publisher = makeLcmPublisher(link, options(12));
  groom = hair(300);
  publisher->announce(groom, sampleBody(10));
  ASSERT_TRUE(becomesTrue([&] { return subscriber->groom()->session == 12 && subscriber->body(); }));
  EXPECT_TRUE(goesThrough(*publisher, *subscriber, groom, 1));
  groom = hair(200);
  groom.revision = 2;
  publisher->announce(groom, sampleBody(10));
  ASSERT_TRUE(becomesTrue([&] { return subscriber->groom()->revision == 2 && subscriber->body(); }));
  EXPECT_TRUE(goesThrough(*publisher, *subscriber, groom, 2));
}

TEST(Lcm, RivalsHearEachOtherAndSilenceIsNoticed) {
  const auto link = std::make_shared<LossyLink>();
  auto first = makeLcmPublisher(link, options(11));
  const auto second = makeLcmPublisher(link, options(12));
  const auto reader = makeLcmSubscriber(link, options(0));
  EXPECT_TRUE(becomesTrue([&] {
    return first->conflict() == ConflictingDaemon{12} && second->conflict() == ConflictingDaemon{11};
  }));
  EXPECT_TRUE(becomesTrue([&] { return reader->allStatuses().size() == 2; }));
  first.reset();
  EXPECT_TRUE(becomesTrue([&] { return !second->conflict(); }));
  EXPECT_TRUE(becomesTrue([&] { return reader->allStatuses().size() == 1; }));
}

TEST(Lcm, StrangersThatFellSilentLeaveRoomThoughNobodyAsks) {
  const auto link = std::make_shared<LossyLink>();
  const auto reader = makeLcmSubscriber(link, options(0));
  const auto hear = [&](uint64_t session) {
    Status status;
    status.groom_id = 1;
    status.session = session;
    status.last_command = session;
    std::vector<uint8_t> message;
    toBytes(status, message);
    link->send(LcmChannels(1).status, message);
  };
  for (uint64_t session = 1; session <= 2000; ++session) hear(session);
  std::this_thread::sleep_for(kLcmSilence + milliseconds(500));
  hear(9999);
  ASSERT_TRUE(reader->waitForAnswer(9999, kPatience));  // without a call of status()
  ASSERT_EQ(reader->allStatuses().size(), 1u);
  EXPECT_EQ(reader->allStatuses()[0].session, 9999u);
}

// ---- losses

class LcmLosses : public testing::TestWithParam<double> {};

/// Frames of 12 chunks of which some never arrive. Each frame is shown, only strands of lost chunks are
/// concealed, and their error is small.
TEST_P(LcmLosses, OnlyTheStrandsOfLostChunksAreConcealed) {
  const auto link = std::make_shared<LossyLink>();
  const auto publisher = makeLcmPublisher(link, options(11));
  const auto subscriber = makeLcmSubscriber(link, options(0));
  const GroomDescription groom = hairGroom(1800, [](size_t) { return 32; });
  publisher->announce(groom, sampleBody(10));
  ASSERT_TRUE(subscriber->waitForGroom(kPatience));
  for (uint64_t number = 1; number <= 3; ++number)
    ASSERT_TRUE(goesThrough(*publisher, *subscriber, groom, number));
  link->setLosses({GetParam(), 0.05, 0.05, 7});
  constexpr uint64_t kFrames = kSanitized ? 30 : 80;
  uint64_t seen = 0, off = 0, concealed = 0, newest = 3;
  float worst = 0;
  for (uint64_t number = 4; number < 4 + kFrames; ++number) {
    publisher->publish(hairFrame(groom, number));
    link->drain();
    while (const auto frame = subscriber->waitForFrame(newest, milliseconds(0))) {
      newest = frame->frame;
      ++seen;
      concealed += frame->strands_concealed;
      const GuideFrame sent = hairFrame(groom, newest);
      uint32_t moved = 0;
      for (size_t s = 0; s < groom.guides.strands(); ++s) {
        float error = 0;
        for (uint32_t v = groom.guides.offsets[s]; v < groom.guides.offsets[s + 1]; ++v)
          error = std::max(error, (frame->positions[v] - sent.positions[v]).norm());
        moved += error > 1.001e-5f ? 1 : 0;
        worst = std::max(worst, error);
      }
      EXPECT_LE(moved, frame->strands_concealed) << newest;
      off += moved;
    }
  }
  const ReceiveStatistics statistics = subscriber->statistics();
  EXPECT_GE(seen, kFrames - 3) << "only frames without any chunk, and the last one, may be missing";
  EXPECT_EQ(statistics.frames_received, seen + 3);
  EXPECT_EQ(statistics.strands_concealed, concealed);
  EXPECT_EQ(statistics.chunks_rejected, 0u);
  EXPECT_GT(statistics.frames_concealed, 0u);
  EXPECT_GT(off, 0u);
  EXPECT_LT(worst, 0.05f) << "m, from where the strands really are";
  std::printf(
      "%.0f %% of messages lost: %llu of %llu frames seen, %llu with concealed strands, worst %.1f mm\n",
      100 * GetParam(), static_cast<unsigned long long>(seen), static_cast<unsigned long long>(kFrames),
      static_cast<unsigned long long>(statistics.frames_concealed), 1e3 * static_cast<double>(worst));
}

INSTANTIATE_TEST_SUITE_P(Drops, LcmLosses, testing::Values(0.01, 0.05));

/// The head is at rest and a limb swings. Lost strands, and the limb where its chunk is lost, stay on its
/// path.
TEST(Lcm, HairOfALimbStaysOnItThroughLosses) {
  const auto link = std::make_shared<LossyLink>();
  const auto publisher = makeLcmPublisher(link, options(11, Codec::kFloat32));
  const auto subscriber = makeLcmSubscriber(link, options(0));
  const GroomDescription groom = limbGroom(1800, 32);
  publisher->announce(groom, sampleBody(10));
  publisher->announceColliders(limbs({limb()}));
  ASSERT_TRUE(subscriber->waitForGroom(kPatience));
  ASSERT_TRUE(becomesTrue([&] { return subscriber->colliders() != nullptr; }));
  constexpr uint64_t kFrames = kSanitized ? 40 : 80;
  uint64_t newest = 0, concealed = 0;
  float worst = 0, limb_off = 0;
  for (uint64_t number = 1; number <= kFrames; ++number) {
    if (number == 4) link->setLosses({0.3, 0.05, 0.05, 7});
    publisher->publish(limbFrame(groom, number));
    link->drain();
    while (const auto frame = subscriber->waitForFrame(newest, milliseconds(0))) {
      newest = frame->frame;
      concealed += frame->strands_concealed;
      const GuideFrame sent = limbFrame(groom, newest);
      for (size_t v = 0; v < sent.positions.size(); ++v)
        worst = std::max(worst, (frame->positions[v] - sent.positions[v]).norm());
      limb_off = std::max(limb_off, limbOff(*frame, sent));
    }
  }
  EXPECT_GT(concealed, 1000u);
  EXPECT_LT(worst, 1e-3f) << "m, from where the strands really are";
  EXPECT_LT(limb_off, 1e-3f);
  std::printf("30 %% of messages lost: %llu strands concealed, worst %.2f mm, the limb %.2f mm\n",
              static_cast<unsigned long long>(concealed), 1e3 * static_cast<double>(worst),
              1e3 * static_cast<double>(limb_off));
}

TEST(Lcm, CommandsAreObeyedOnceAndAnsweredThroughLosses) {
  const auto link = std::make_shared<LossyLink>(Losses{0.3, 0.2, 0.2, 3});
  const auto publisher = makeLcmPublisher(link, options(11));
  const auto subscriber = makeLcmSubscriber(link, options(0));
  std::atomic<bool> stop{false};
  std::atomic<int> obeyed{0};
  std::thread daemon([&] {
    while (!stop) {
      while (const auto command = publisher->takeCommand()) {
        ++obeyed;
        Status status;
        status.last_command = command->id;
        publisher->publishStatus(status);
      }
      std::this_thread::sleep_for(milliseconds(5));
    }
  });
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  for (uint64_t id = 1; id <= 4; ++id) {
    Command command;
    command.id = id;
    EXPECT_EQ(ask(*subscriber, command, [&] { return std::chrono::steady_clock::now() > deadline; }), "")
        << id;
  }
  stop = true;
  daemon.join();
  EXPECT_EQ(obeyed, 4);
}

/// Counts the messages that a thread sends.
class ThreadCountingLink final : public MessageLink {
 public:
  std::vector<Subscription> listen(std::vector<Channel> channels) override {
    return link_.listen(std::move(channels));
  }
  void send(const std::string& channel, std::span<const uint8_t> message) override {
    if (std::this_thread::get_id() == own_) ++sent_;
    link_.send(channel, message);
  }
  int sent() const { return sent_; }

 private:
  const std::thread::id own_ = std::this_thread::get_id();
  std::atomic<int> sent_{0};
  LossyLink link_;
};

TEST(Lcm, AColliderHoldsNoFrames) {
  const auto link = std::make_shared<ThreadCountingLink>();
  const auto publisher = makeLcmPublisher(link, options(11));
  const auto subscriber = makeLcmSubscriber(link, options(0));
  const GroomDescription groom = hair();
  expectEverything(*publisher, *subscriber, groom);
  const int before = link->sent();
  EXPECT_GT(before, 5) << "the groom goes out before its first frame";
  publisher->announceColliders(sampleColliders());
  EXPECT_EQ(link->sent(), before) << "another thread sends all that";
  EXPECT_TRUE(becomesTrue([&] {
    const auto colliders = subscriber->colliders();
    return colliders && colliders->colliders.size() == 2;
  }));
}

TEST(Lcm, TheGroomComesThroughLosses) {
  const auto link = std::make_shared<LossyLink>(Losses{0.3, 0.1, 0.3, 5});
  const auto publisher = makeLcmPublisher(link, options(11));
  const auto subscriber = makeLcmSubscriber(link, options(0));
  const GroomDescription groom = hair(5000);
  publisher->announce(groom, sampleBody(60));
  ASSERT_TRUE(subscriber->waitForGroom(kPatience));
  EXPECT_EQ(subscriber->groom()->guides.positions, groom.guides.positions);
}

TEST(Lcm, BadOptionsAreRefused) {
  EXPECT_NE(errorOf([] { makeLcmPublisher({lcmUrl(0), 1, 0, {}}); }).find("session"), std::string::npos);
  EXPECT_NE(errorOf([] {
              makeLcmPublisher({lcmUrl(0), 1, 1, {Codec::kTemporal}});
            }).find("loses nothing"),
            std::string::npos);
  struct Refusal {
    std::string url;
    uint32_t groom_id;
    const char* complaint;
  };
  for (const Refusal& refusal : {Refusal{"tcp://here", 1, "not an LCM URL"},
                                 {"file:///no/such/file?mode=r", 1, "log file"},
                                 {"file:///no/such/file?mode=w", 1, "would replace the log"},
                                 {"memq://", 1, "makeLcmChannel"},
                                 {"udpm://x", 1, "'x' is no multicast address"},
                                 {"udpm://192.168.1.20:7667", 1, "no multicast address"},
                                 {"udpm://239.255.76.67:99999?ttl=0", 1, "'99999' is no UDP port"},
                                 {"udpm://239.255.76.67:0", 1, "no UDP port"},
                                 {"udpm://239.255.76.67:", 1, "no UDP port"},
                                 {lcmUrl(0), 0, "groom id"}}) {
    const std::string error = errorOf([&] { makeLcmSubscriber({refusal.url, refusal.groom_id, 0, {}}); });
    EXPECT_NE(error.find(refusal.complaint), std::string::npos) << refusal.url << ": " << error;
  }
  EXPECT_NE(errorOf([] { lcmUrl(233); }), "");
  EXPECT_NE(errorOf([] {
              makeLcmPublisher({"file:///tmp/absent.log?mode=r", 1, 1, {}});
            }).find("writes its log"),
            std::string::npos);
}

}  // namespace
}  // namespace strandcast
