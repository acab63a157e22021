#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <thread>

#include "bound_hairs.h"
#include "core/error.h"
#include "dds_domain.h"
#include "moving_hair.h"
#include "sample_messages.h"
#include "steering.h"
#include "tests/expect_error.h"
#include "transport/dds.h"
#include "transport/parameter_table.h"
#include "transport/publisher.h"
#include "true_within.h"

namespace strandcast {
namespace {

using std::chrono::milliseconds;

bool becomesTrue(const std::function<bool()>& condition, milliseconds patience = milliseconds(5000)) {
  return trueWithin(patience, condition);
}

class Dds : public testing::Test {
 protected:
  void SetUp() override {
    std::string reason;
    if (!ddsAvailable(&reason)) GTEST_SKIP() << reason;
  }
};

TEST(DdsBuild, SaysWhyWhenThereIsNone) {
  std::string reason = "?";
  if (ddsAvailable(&reason)) {
    EXPECT_EQ(reason, "");
  } else {
    EXPECT_NE(reason, "");
    EXPECT_THROW(makeDdsPublisher({0, 1, 1, {Codec::kFloat32}}), Error);
    EXPECT_THROW(makeDdsSubscriber({0, 1, 0, {}}), Error);
    EXPECT_THROW(makeDdsPoseSender({0, 1, 0, {}}), Error);
  }
}

TEST_F(Dds, HairsReachPresentAndLateReaders) {
  constexpr milliseconds kPatience{30000};  // for a loaded machine
  const int domain = testDomain(0);
  const auto publisher = makeDdsPublisher({domain, 1, 11, {}});
  const auto subscriber = makeDdsSubscriber({domain, 1, 0, {}});
  GroomDescription groom = hairGroom(500, [](size_t) { return 16; });
  const HairDescription hairs = boundHairs(groom.guides, 8000);
  const float error = 1.001f * CodecOptions().hair_error;
  publisher->announce(groom, sampleBody(20));
  publisher->announceHairs(hairs);
  ASSERT_TRUE(becomesTrue([&] { return subscriber->hairs() != nullptr; }, kPatience));
  EXPECT_TRUE(areAlike(*subscriber->hairs(), hairs, error));
  // Fewer chunks than before, and then none: a late joiner must get only those of its groom.
  const HairDescription fewer = boundHairs(groom.guides, 2000);
  groom.revision = 2;
  publisher->announce(groom, sampleBody(20));
  publisher->announceHairs(fewer);
  ASSERT_TRUE(
      becomesTrue([&] { return subscriber->hairs() && subscriber->hairs()->revision == 2; }, kPatience));
  {
    const auto late = makeDdsSubscriber({domain, 1, 0, {}});
    ASSERT_TRUE(becomesTrue([&] { return late->hairs() != nullptr; }, kPatience));
    EXPECT_TRUE(areAlike(*late->hairs(), fewer, error));
    EXPECT_EQ(late->statistics().chunks_rejected, 0u);
  }
  groom.revision = 3;
  publisher->announce(groom, sampleBody(20));
  ASSERT_TRUE(becomesTrue([&] { return subscriber->groom()->revision == 3; }, kPatience));
  EXPECT_FALSE(subscriber->hairs());
  EXPECT_EQ(subscriber->statistics().chunks_rejected, 0u);
}

TEST_F(Dds, GroomFramesStatusAndCommandsGoThrough) {
  const int domain = testDomain(0);
  const auto publisher = makeDdsPublisher({domain, 1, 11, {Codec::kFloat32}});
  const auto subscriber = makeDdsSubscriber({domain, 1, 0, {}});
  const GroomDescription groom = sampleGroom(1500, [](size_t s) { return 2 + s % 40; });
  const BodyDescription body = sampleBody(100);
  publisher->announce(groom, body);
  ASSERT_TRUE(subscriber->waitForGroom(milliseconds(5000)));
  EXPECT_EQ(subscriber->groom()->guides.positions, groom.guides.positions);
  EXPECT_EQ(subscriber->groom()->guides.offsets, groom.guides.offsets);
  EXPECT_EQ(subscriber->groom()->guides.parts, groom.guides.parts);
  EXPECT_EQ(subscriber->body()->mesh.triangles, body.mesh.triangles);
  EXPECT_EQ(subscriber->body()->head_weights, body.head_weights);
  ASSERT_TRUE(becomesTrue([&] { return publisher->matchedReaders() == 1; }));
  publisher->announceColliders(sampleColliders());
  ASSERT_TRUE(becomesTrue([&] { return subscriber->colliders() != nullptr; }));
  EXPECT_TRUE(areAlike(*subscriber->colliders(), sampleColliders()));
  // Fewer chunks than before: a late joiner must get only these.
  ColliderSet fewer = sampleColliders();
  fewer.colliders.pop_back();
  fewer.revision = 2;
  publisher->announceColliders(fewer);
  ASSERT_TRUE(becomesTrue([&] { return subscriber->colliders()->revision == 2; }));
  {
    const auto late = makeDdsSubscriber({domain, 1, 0, {}});
    ASSERT_TRUE(becomesTrue([&] { return late->colliders() != nullptr; }));
    EXPECT_TRUE(areAlike(*late->colliders(), fewer));
  }
  for (uint64_t number = 1; number <= 20; ++number) {
    publisher->publish(sampleFrame(groom, number));
    const auto frame = subscriber->waitForFrame(number - 1, milliseconds(2000));
    ASSERT_TRUE(frame) << number;
    EXPECT_EQ(frame->frame, number);
    EXPECT_TRUE(isSampleFrame(*frame));
  }
  EXPECT_EQ(subscriber->statistics().frames_lost, 0u);
  EXPECT_EQ(subscriber->statistics().chunks_rejected, 0u);

  Command command;
  command.id = 42;
  command.kind = CommandKind::kSetParameter;
  command.name = "wind";
  command.values = {1, 0, 2.5};
  subscriber->send(command);
  std::optional<Command> taken;
  ASSERT_TRUE(becomesTrue([&] { return (taken = publisher->takeCommand()).has_value(); }));
  EXPECT_EQ(taken->id, 42u);
  EXPECT_EQ(taken->kind, CommandKind::kSetParameter);
  EXPECT_EQ(taken->name, "wind");
  EXPECT_EQ(taken->values, command.values);

  Status status;
  status.backend = "simd";
  status.last_command = 42;
  status.parameters = parameterTable(Parameters());
  publisher->publishStatus(status);
  EXPECT_TRUE(becomesTrue([&] { return subscriber->status() && subscriber->status()->last_command == 42; }));
  EXPECT_EQ(subscriber->status()->backend, "simd");
  EXPECT_EQ(namedValues(subscriber->status()->parameters), namedValues(status.parameters));
  const uint64_t rejected = subscriber->statistics().chunks_rejected;
  Status unsound = status;
  unsound.backend = "none";
  unsound.parameters.values.pop_back();
  publisher->publishStatus(unsound);
  EXPECT_TRUE(becomesTrue([&] { return subscriber->statistics().chunks_rejected == rejected + 1; }));
  EXPECT_EQ(subscriber->status()->backend, "simd") << "what does not fit is dropped";
  EXPECT_EQ(subscriber->status()->session, 11u);
  EXPECT_FALSE(publisher->conflict()) << "its own status is no conflict";
}

TEST_F(Dds, PosesReachTheGroomsOfACharacter) {
  const int domain = testDomain(9);
  const auto head = makeDdsPublisher({domain, 1, 11, {}}), beard = makeDdsPublisher({domain, 2, 12, {}}),
             other = makeDdsPublisher({domain, 3, 13, {}});
  const auto one = makeDdsPoseSender({domain, 1, 0, {}}), both = makeDdsPoseSender({domain, 1, 0, {}}, {2});
  uint64_t time = 0;
  const auto sendAll = [&] {
    const Pose pose{Vec3(static_cast<float>(++time) / 100, 0, 0), Quat(0.8f, 0, 0.6f, 0)};
    for (PoseSender* const sender : {one.get(), both.get()}) sender->send(time, {&pose, 1});
  };
  for (PoseSender* const sender : {one.get(), both.get()}) sender->setNames({"head"});
  std::map<std::pair<Publisher*, uint64_t>, std::vector<PoseSamples>> arrived;
  const auto takeAll = [&] {
    for (Publisher* const publisher : {head.get(), beard.get(), other.get()})
      while (std::optional<PoseSamples> taken = publisher->takePoses())
        arrived[{publisher, taken->source}].push_back(std::move(*taken));
  };
  ASSERT_TRUE(becomesTrue([&] {
    sendAll();
    takeAll();
    return arrived.size() == 3;
  })) << "once they have found each other";
  const uint64_t found = time;
  for (int i = 0; i < 100; ++i) sendAll();
  const auto areComplete = [&] {
    takeAll();
    return std::all_of(arrived.begin(), arrived.end(),
                       [&](const auto& of) { return of.second.back().time == time; });
  };
  ASSERT_TRUE(becomesTrue(areComplete));
  ASSERT_EQ(arrived.size(), 3u);
  EXPECT_TRUE(arrived.contains({head.get(), one->source()}));
  EXPECT_TRUE(arrived.contains({head.get(), both->source()}));
  EXPECT_TRUE(arrived.contains({beard.get(), both->source()}));
  for (const auto& [of, all] : arrived) {
    EXPECT_LE(all.front().time, found);
    for (size_t i = 0; i < all.size(); ++i) {
      ASSERT_EQ(all[i].time, all[0].time + i) << "each in its order";
      EXPECT_EQ(all[i].poses[0], static_cast<float>(all[i].time) / 100);
    }
  }
}

TEST_F(Dds, FramesThatBuildOnEachOtherReachEarlyAndLateReaders) {
  const int domain = testDomain(7);
  const auto publisher = makeDdsPublisher({domain, 1, 11, {Codec::kTemporal}});
  const auto early = makeDdsSubscriber({domain, 1, 0, {}});
  const GroomDescription groom = hairGroom(1500, [](size_t s) { return 2 + s % 40; });
  publisher->announce(groom, sampleBody(20));
  ASSERT_TRUE(early->waitForGroom(milliseconds(5000)));
  ASSERT_TRUE(becomesTrue([&] { return publisher->matchedReaders() == 1; }));
  std::unique_ptr<Subscriber> late;
  for (uint64_t number = 1; number <= 40; ++number) {
    if (number == 13) {
      late = makeDdsSubscriber({domain, 1, 0, {}});
      ASSERT_TRUE(late->waitForGroom(milliseconds(5000)));
      ASSERT_TRUE(becomesTrue([&] { return publisher->matchedReaders() == 2; }));
    }
    const GuideFrame sent = hairFrame(groom, number);
    publisher->publish(sent);
    const auto frame = early->waitForFrame(number - 1, milliseconds(2000));
    ASSERT_TRUE(frame) << number;
    for (size_t v = 0; v < sent.positions.size(); ++v)
      ASSERT_LE((frame->positions[v] - sent.positions[v]).norm(), 1.001e-5f) << number;
  }
  ASSERT_TRUE(becomesTrue([&] { return late->frame() && late->frame()->frame == 40; }));
  EXPECT_EQ(late->frame()->positions, early->frame()->positions);
  EXPECT_EQ(late->statistics().frames_lost, 0u) << "once it has had one";
  EXPECT_GE(late->statistics().frames_received, 18u) << "within an interval of key frames";
  EXPECT_EQ(early->statistics().frames_received, 40u);
}

TEST_F(Dds, AFrameOfAsManyBentCollidersAsItHoldsArrives) {
  const int domain = testDomain(7);
  const auto publisher = makeDdsPublisher({domain, 1, 11, {Codec::kFloat32}});
  const auto subscriber = makeDdsSubscriber({domain, 1, 0, {}});
  const GroomDescription groom = uniformGroom(1000, 10);  // more than a chunk
  publisher->announce(groom, sampleBody(3));
  ASSERT_TRUE(subscriber->waitForGroom(milliseconds(5000)));
  ASSERT_TRUE(becomesTrue([&] { return publisher->matchedReaders() == 1; }));
  GuideFrame sent = sampleFrame(groom, 1);
  sent.colliders.clear();
  for (uint32_t id = 0; id < kMaxPlacedColliders; ++id)
    sent.colliders.push_back({id, Pose{}, sampleBend(id + 1)});
  publisher->publish(sent);
  const auto frame = subscriber->waitForFrame(0, milliseconds(2000));
  ASSERT_TRUE(frame);
  ASSERT_EQ(frame->colliders.size(), kMaxPlacedColliders);
  for (uint32_t id = 0; id < kMaxPlacedColliders; ++id)
    EXPECT_TRUE(areAlike(frame->colliders[id].bend, sampleBend(id + 1))) << id;
}

TEST_F(Dds, TheAnswerOfADaemonThatEndsAtOnceIsHeard) {
  const auto subscriber = makeDdsSubscriber({testDomain(0), 1, 0, {}});
  for (uint64_t id = 1; id <= 5; ++id) {
    auto publisher = makeDdsPublisher({testDomain(0), 1, 100 + id, {Codec::kFloat32}});
    Command command;
    command.id = id;
    command.kind = CommandKind::kShutdown;
    std::thread daemon([&] {
      ASSERT_TRUE(becomesTrue([&] { return publisher->takeCommand().has_value(); })) << id;
      Status status;
      status.last_command = id;
      publisher->publishStatus(status);
      publisher.reset();
    });
    // The previous daemon may get the command first: the end of a daemon is detected late.
    const auto deadline = std::chrono::steady_clock::now() + milliseconds(5000);
    EXPECT_EQ(ask(*subscriber, command, [&] { return std::chrono::steady_clock::now() > deadline; }), "")
        << id;
    daemon.join();
  }
}

TEST_F(Dds, ANewRevisionReplacesTheGroomForOldAndNewReaders) {
  const int domain = testDomain(1);
  const auto publisher = makeDdsPublisher({domain, 1, 11, {Codec::kFloat32}});
  const auto early = makeDdsSubscriber({domain, 1, 0, {}});
  GroomDescription groom = uniformGroom(6000, 10);
  publisher->announce(groom, sampleBody(100));
  ASSERT_TRUE(early->waitForGroom(milliseconds(5000)));
  GroomDescription smaller = uniformGroom(20, 5);
  smaller.revision = 2;
  publisher->announce(smaller, sampleBody(4));
  EXPECT_TRUE(becomesTrue([&] { return early->groom()->revision == 2 && early->body() != nullptr; }));
  const auto late = makeDdsSubscriber({domain, 1, 0, {}});
  ASSERT_TRUE(late->waitForGroom(milliseconds(5000)));
  EXPECT_EQ(late->groom()->guides.strands(), 20u);
  EXPECT_EQ(late->statistics().chunks_rejected, 0u);
  for (uint64_t number = 1; number <= 5; ++number) publisher->publish(sampleFrame(smaller, number));
  EXPECT_TRUE(becomesTrue([&] { return early->frame() && early->frame()->frame == 5; }));
  EXPECT_THROW(publisher->announce(smaller, sampleBody(4)), Error);
  for (smaller.revision = 3; smaller.revision < 5; ++smaller.revision) {
    publisher->announce(smaller, sampleBody(4));
    EXPECT_TRUE(becomesTrue([&] { return early->groom()->revision == smaller.revision; }))
        << "what was taken back does not hold what follows";
  }
}

TEST_F(Dds, GroomsDoNotMixButAllStatusesAreSeen) {
  const int domain = testDomain(2);
  const auto first = makeDdsPublisher({domain, 1, 11, {Codec::kFloat32}});
  auto second = makeDdsPublisher({domain, 2, 22, {Codec::kFloat32}});
  const auto reader = makeDdsSubscriber({domain, 2, 0, {}});
  first->announce(uniformGroom(10, 4), sampleBody(4));
  second->announce(uniformGroom(33, 4), sampleBody(4));
  ASSERT_TRUE(reader->waitForGroom(milliseconds(5000)));
  EXPECT_EQ(reader->groom()->guides.strands(), 33u);
  EXPECT_EQ(reader->groom()->session, 22u);
  EXPECT_TRUE(becomesTrue([&] { return reader->allStatuses().size() == 2; }));
  EXPECT_EQ(reader->status()->session, 22u);
  ASSERT_TRUE(becomesTrue([&] { return second->matchedReaders() == 1; }));
  EXPECT_EQ(first->matchedReaders(), 0u);
  EXPECT_FALSE(first->conflict());
  Command command;
  command.id = 5;
  reader->send(command);
  EXPECT_TRUE(becomesTrue([&] { return second->takeCommand().has_value(); }));
  EXPECT_FALSE(first->takeCommand());
  second.reset();
  EXPECT_TRUE(becomesTrue([&] { return reader->allStatuses().size() == 1; }))
      << "a daemon that ended has no status";
}

TEST_F(Dds, ARivalIsHeardAndForgotten) {
  const int domain = testDomain(3);
  const auto first = makeDdsPublisher({domain, 1, 11, {Codec::kFloat32}});
  auto second = makeDdsPublisher({domain, 1, 22, {Codec::kFloat32}});
  EXPECT_TRUE(becomesTrue([&] { return second->conflict() == ConflictingDaemon{11}; }, kConflictListenTime));
  EXPECT_TRUE(becomesTrue([&] { return first->conflict() == ConflictingDaemon{22}; }, kConflictListenTime));
  second.reset();
  EXPECT_TRUE(becomesTrue([&] { return !first->conflict(); }));
}

/// Makes a publisher that shares groom 1.
std::unique_ptr<Publisher> claimant(int domain, const GroomDescription& groom, uint64_t session,
                                    uint32_t strength) {
  auto publisher = makeDdsPublisher({domain, 1, session, {Codec::kFloat32}, strength});
  publisher->announce(groom, sampleBody(4));
  return publisher;
}

TEST_F(Dds, AStatusGoesWithTheTurnOfWhoSharesAGroom) {
  const int domain = testDomain(15);
  const GroomDescription groom = uniformGroom(10, 4);
  const auto first = claimant(domain, groom, 11, 1);
  const auto reader = makeDdsSubscriber({domain, 1, 0, {}});
  uint64_t number = 0;
  Status status;
  status.strands = 10;
  const auto isTheOne = [](const Subscriber& by, uint64_t session) {
    const std::vector<Status> all = by.allStatuses();
    return all.size() == 1 && all[0].session == session;
  };
  const auto becomesTheOne = [&](uint64_t session, const std::vector<Publisher*>& publishers) {
    return becomesTrue([&] {
      ++number;
      for (Publisher* const publisher : publishers) {
        publisher->publish(sampleFrame(groom, number));
        publisher->publishStatus(status);
        EXPECT_FALSE(publisher->conflict()) << "they share the groom";
      }
      return isTheOne(*reader, session);
    });
  };
  ASSERT_TRUE(becomesTheOne(11, {first.get()}));
  const auto second = claimant(domain, groom, 22, 2);
  EXPECT_TRUE(becomesTheOne(22, {first.get(), second.get()}));
  const auto late = makeDdsSubscriber({domain, 1, 0, {}});
  ASSERT_TRUE(becomesTrue([&] { return !late->allStatuses().empty(); }));
  std::this_thread::sleep_for(milliseconds(200));
  EXPECT_TRUE(isTheOne(*late, 22)) << "nor does who comes later hear of it";
}

TEST_F(Dds, AClaimantYieldsToOneOfItsStrengthThatCasts) {
  const int domain = testDomain(17);
  const GroomDescription groom = uniformGroom(10, 4);
  auto first = claimant(domain, groom, 11, 5);
  uint64_t number = 0;
  const auto becomesFirsts = [&](const Publisher& publisher) {
    return becomesTrue([&] {
      first->publish(sampleFrame(groom, ++number));
      return publisher.castingState() == CastingState::kOther;
    });
  };
  const auto equal = claimant(domain, groom, 22, 5), weaker = claimant(domain, groom, 33, 4),
             stronger = claimant(domain, groom, 44, 6);
  for (const Publisher* const other : {equal.get(), weaker.get(), stronger.get()})
    ASSERT_TRUE(becomesFirsts(*other));
  EXPECT_TRUE(equal->yields());
  EXPECT_FALSE(weaker->yields()) << "it stands by in any case";
  EXPECT_FALSE(stronger->yields());
  EXPECT_FALSE(first->yields()) << "to itself";
  first.reset();
  EXPECT_TRUE(becomesTrue([&] { return equal->castingState() == CastingState::kUnclaimed; }));
  EXPECT_FALSE(equal->yields());
}

TEST_F(Dds, AStrongerClaimantSilencesNobodyBeforeItHasFrames) {
  const int domain = testDomain(16);
  const GroomDescription groom = uniformGroom(10, 4);
  const auto first = claimant(domain, groom, 11, 1);
  const auto reader = makeDdsSubscriber({domain, 1, 0, {}});
  uint64_t number = 0, seen = 0;
  auto newest = std::chrono::steady_clock::now();
  std::chrono::steady_clock::duration longest{};
  const auto castsFor = [&](int ms, const std::vector<Publisher*>& publishers) {
    for (const auto end = std::chrono::steady_clock::now() + milliseconds(ms);
         std::chrono::steady_clock::now() < end; std::this_thread::sleep_for(milliseconds(10))) {
      ++number;
      for (Publisher* const publisher : publishers) publisher->publish(sampleFrame(groom, number));
      const auto frame = reader->frame();
      if (!frame || frame->frame == seen) continue;
      const auto now = std::chrono::steady_clock::now();
      if (seen != 0) longest = std::max(longest, now - newest);
      seen = frame->frame;
      newest = now;
    }
    return reader->frame() ? reader->frame()->session : 0;
  };
  ASSERT_EQ(castsFor(4000, {first.get()}), 11u);
  longest = {};
  auto second = claimant(domain, groom, 22, 2);
  EXPECT_EQ(castsFor(3000, {first.get()}), 11u) << "it listens, and makes its simulation";
  EXPECT_FALSE(second->conflict()) << "they share the groom";
  EXPECT_EQ(castsFor(1000, {first.get(), second.get()}), 22u);
  EXPECT_LT(longest, milliseconds(500));
  second.reset();
  EXPECT_EQ(castsFor(1000, {first.get()}), 11u);
}

TEST_F(Dds, WhoOnlySteersIsNoReader) {
  DdsOptions steering;
  steering.domain = testDomain(14);
  steering.frames = false;
  const auto publisher = makeDdsPublisher({steering.domain, 1, 11, {Codec::kFloat32}});
  expectSteersAlone(*publisher, *makeDdsSubscriber(steering));
}

TEST_F(Dds, SendSaysWhenNoDaemonAnswers) {
  const auto subscriber = makeDdsSubscriber({testDomain(4), 9, 0, {}});
  Command command;
  command.id = 1;
  const auto start = std::chrono::steady_clock::now();
  const std::string message = errorOf([&] { subscriber->send(command); });
  EXPECT_NE(message.find("no daemon answers"), std::string::npos) << message;
  EXPECT_NE(message.find("groom 9"), std::string::npos) << message;
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(4));
}

TEST_F(Dds, BadOptionsAreRefused) {
  EXPECT_NE(errorOf([] { makeDdsSubscriber({-1, 1, 0, {}}); }).find("0 to 232"), std::string::npos);
  EXPECT_NE(errorOf([] { makeDdsSubscriber({233, 1, 0, {}}); }).find("0 to 232"), std::string::npos);
  EXPECT_NE(errorOf([] {
              makeDdsPublisher({testDomain(5), 1, 0, {Codec::kFloat32}});
            }).find("session"),
            std::string::npos);
}

TEST_F(Dds, ADiscoveryPortHeldByAnotherProgramIsNamed) {
  const int domain = testDomain(6);
  const int holder = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(firstPort(domain)));
  ASSERT_EQ(bind(holder, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  const std::string message = errorOf([&] { makeDdsSubscriber({domain, 1, 0, {}}); });
  EXPECT_NE(message.find("UDP port " + std::to_string(firstPort(domain)) + " is in use"), std::string::npos)
      << message;
  EXPECT_NE(message.find("--domain"), std::string::npos) << message;
  close(holder);
  EXPECT_NO_THROW(makeDdsSubscriber({domain, 1, 0, {}}));
}

}  // namespace
}  // namespace strandcast
