// A daemon's simulation that live sources move.
#include "service/live_poses.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <cstring>
#include <deque>
#include <functional>
#include <memory>
#include <thread>

#include "core/error.h"
#include "options/settings.h"
#include "scenes/scene.h"
#include "service/command_executor.h"
#include "service/controls.h"
#include "service/daemon.h"
#include "service/frame_pacer.h"
#include "service/replay.h"
#include "service/show_state.h"
#include "tests/io/scratch_folder.h"
#include "tests/scenes/furry_arm.h"
#include "transport/commands.h"
#include "transport/frame_queue.h"
#include "transport/recording/recorder.h"

namespace strandcast {
namespace {

/// A channel whose sender of poses is the test, and which keeps what is published.
class PosedChannel final : public Publisher {
 public:
  std::deque<PoseSamples> waiting;
  std::deque<Command> commands;
  std::vector<GuideFrame> frames;
  std::vector<StepPoses> recorded;
  Status status;

  PoseInbox inbox{1};  ///< of another thread

  std::optional<PoseSamples> takePoses() override { return waiting.empty() ? inbox.take() : next(waiting); }
  std::optional<Command> takeCommand() override { return next(commands); }
  void publish(const GuideFrame& frame) override { frames.push_back(frame); }
  void recordPoses(const StepPoses& poses) override { recorded.push_back(poses); }
  void publishStatus(const Status& sent) override { status = sent; }
  void announce(const GroomDescription&, const BodyDescription&) override {}
  void announceColliders(const ColliderSet&) override {}
  uint32_t matchedReaders() const override { return 0; }
  EncodingReport encoding() const override { return {}; }
  std::optional<ConflictingDaemon> conflict() const override { return std::nullopt; }

 private:
  template <class Message>
  static std::optional<Message> next(std::deque<Message>& queue) {
    if (queue.empty()) return std::nullopt;
    Message message = std::move(queue.front());
    queue.pop_front();
    return message;
  }
};

void append(std::vector<float>& poses, const Pose& pose) {
  poses.insert(poses.end(), pose.position.data(), pose.position.data() + 3);
  poses.insert(poses.end(), pose.rotation.coeffs().data(), pose.rotation.coeffs().data() + 4);
}

/// A program that sends a sample for each step of a simulation at 60 Hz.
struct Sender {
  PosedChannel& channel;
  uint64_t source = 7;
  std::string names = "head", weight_names = {};
  uint64_t time = 5'000'000'000;  ///< ns, of the next sample
  uint32_t number = 0, epoch = 0;
  uint64_t period = 16'666'667, later = 0;  ///< ns; by which messages arrive later than now

  /// Sends a sample with these poses, and the names each time.
  void send(const std::vector<Pose>& poses, const std::vector<float>& weights = {},
            const std::vector<float>& scales = {}) {
    channel.waiting.push_back(message(poses, weights, scales));
  }
  PoseSamples message(const std::vector<Pose>& poses, const std::vector<float>& weights = {},
                      const std::vector<float>& scales = {}) {
    PoseSamples message;
    message.source = source;
    message.time = time;
    message.newest = number++;
    message.epoch = epoch;
    message.names_revision = 3;
    message.names = names;
    message.weight_names = weight_names;
    message.ages = {0};
    for (const Pose& pose : poses) append(message.poses, pose);
    message.scales = scales;
    message.weights = weights;
    message.arrival_time = steadyTime() + later;
    EXPECT_TRUE(isSound(message));
    time += period;
    return message;
  }
};

/// A head that shakes at 2 Hz by 0.05 m, and nods.
Pose nodding(double t) {
  const double phase = 2 * EIGEN_PI * 2 * t;
  return {Vec3(static_cast<float>(0.05 * std::sin(phase)), 0, 0.01f),
          Quat(Eigen::AngleAxisf(static_cast<float>(0.3 * std::sin(phase)), Vec3(Vec3::UnitX())))};
}

/// As a receiver does it.
Pose normalized(Pose pose) {
  auto& numbers = pose.rotation.coeffs();
  float square = 0;
  for (const float n : numbers) square += n * n;
  for (float& n : numbers) n /= std::sqrt(square);
  return pose;
}

bool areSame(const Pose& a, const Pose& b) { return std::memcmp(&a, &b, sizeof(Pose)) == 0; }

Settings fewStrands() {
  Settings settings;
  settings.scene.name = "straight";
  settings.scene.strands = 20;
  settings.scene.vertices = 8;
  settings.scene.motion = "still";
  settings.scene.body_contact = BodyContact::kSpheres;
  settings.backend = "reference";
  return settings;
}

const Scene& fewStrandsScene() {
  static const Scene scene = makeScene(fewStrands().scene);
  return scene;
}

class LivePosesTest : public testing::Test {
 protected:
  void start(const Settings& settings, const Scene& scene) {
    controlled_ = std::make_unique<ControlledSimulation>(settings, scene, channel_, 5);
    report_ = std::make_unique<StatusReport>(1, 5, "test", controlled_->simulation);
    executor_ = std::make_unique<CommandExecutor>(
        *controlled_, *report_, [this](uint64_t, const std::string& refusal) { refusal_ = refusal; });
  }
  void SetUp() override { start(fewStrands(), fewStrandsScene()); }
  const Pose& head() const { return controlled_->simulation.headPose(); }
  PoseMetrics metrics() const { return controlled_->poses.metrics(static_cast<int64_t>(steadyTime())); }
  /// Executes a command and returns the refusal.
  std::string order(CommandKind kind, const std::string& name, std::vector<double> values) {
    executor_->execute({.id = ++id_, .kind = kind, .name = name, .values = std::move(values)});
    return refusal_;
  }
  double nextEnd() const {
    return controlled_->simulation.time() + double{controlled_->simulation.parameters().time_step};
  }
  /// Lets the sources be silent for so long, ns, without a step.
  void passTime(int64_t ns) { controlled_->poses.idle(nextEnd(), static_cast<int64_t>(steadyTime()) + ns); }
  /// As `passTime`, with a step.
  void stepAfter(int64_t ns) {
    if (controlled_->poses.advance(nextEnd(), static_cast<int64_t>(steadyTime()) + ns))
      controlled_->simulation.jumpToPoses();
    controlled_->moveTo(nextEnd());
    controlled_->simulation.step();
  }

  PosedChannel channel_;
  Sender sender_{channel_};
  std::unique_ptr<ControlledSimulation> controlled_;
  std::unique_ptr<StatusReport> report_;
  std::unique_ptr<CommandExecutor> executor_;

 private:
  std::string refusal_;
  uint64_t id_ = 0;
};

TEST_F(LivePosesTest, AStepTakesTheSampleOfItsTimeBitForBit) {
  for (int step = 0; step < 300; ++step) {
    const Pose sent = nodding(step / 60.0);
    sender_.send({sent});
    controlled_->advance();
    ASSERT_TRUE(areSame(head(), sent)) << step;
  }
  EXPECT_EQ(metrics().samples, 300u);
  EXPECT_EQ(metrics().jumps, 1u) << "the first step";
  EXPECT_EQ(metrics().interpolated + metrics().extrapolated + metrics().late + metrics().lost, 0u);
  EXPECT_EQ(metrics().state, PoseState::kLive);
  EXPECT_EQ(controlled_->poses.source(), 7u);
  EXPECT_EQ(controlled_->poses.time(), sender_.time - sender_.period);
}

/// The hair of a simulation whose head is moved by setHeadPose(), and of one that poses of a source move.
TEST_F(LivePosesTest, HairDoesAsUnderTheSamePosesSetByHand) {
  Simulation& live = controlled_->simulation;
  ControlledSimulation by_hand(fewStrands(), fewStrandsScene(), channel_, 5);
  sender_.send({nodding(0)});
  controlled_->advance();
  by_hand.simulation.setHeadPose(nodding(0));
  by_hand.simulation.jumpToPoses();
  by_hand.simulation.step();
  for (int step = 1; step < 100; ++step) {
    sender_.send({nodding(step / 60.0)});
    controlled_->advance();
    by_hand.simulation.setHeadPose(nodding(step / 60.0));
    by_hand.simulation.step();
    by_hand.simulation.resetDiverged();
  }
  const std::span<const Vec3> a = live.guides(), b = by_hand.simulation.guides();
  EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin()));
}

TEST_F(LivePosesTest, WithoutASourceNothingDiffersFromTheMotionOfTheScene) {
  Settings settings = fewStrands();
  settings.scene.motion = "shake";
  const Scene scene = makeScene(settings.scene);
  PosedChannel channel;
  Daemon daemon(settings, scene, channel, 5);
  daemon.announce();
  ControlledSimulation by_hand(settings, scene, channel_, 5);
  const std::atomic<bool> stop{false};
  for (int frame = 0; frame < 60; ++frame) {
    daemon.castFrame(stop);
    while (by_hand.simulation.time() < channel.frames.back().simulation_time) {
      by_hand.simulation.setHeadPose(
          scene.motion(by_hand.simulation.time() + double{by_hand.simulation.parameters().time_step}));
      by_hand.simulation.step();
      by_hand.simulation.resetDiverged();
    }
  }
  EXPECT_TRUE(channel.recorded.empty());
  const std::vector<Vec3>& cast = channel.frames.back().positions;
  EXPECT_TRUE(std::equal(cast.begin(), cast.end(), by_hand.simulation.guides().begin()));
}

/// Two simulations, one of which is moved rigidly by a cut at `cut`; the hair of both for 40 steps.
/// `poses(step, motion)`: of the sender.
void expectRigidCut(const Settings& settings, const Scene& scene, const std::string& names, bool with_epoch,
                    const std::function<std::vector<Pose>(int step, const Pose& motion)>& poses) {
  PosedChannel channels[2];
  ControlledSimulation here(settings, scene, channels[0], 5), far(settings, scene, channels[1], 5);
  Sender senders[2] = {{channels[0], 7, names}, {channels[1], 7, names}};
  constexpr int kCut = 20;
  Pose motion;
  for (int step = 0; step < 40; ++step) {
    if (step == kCut) {
      motion = {Vec3(3, 1, -2), Quat(Eigen::AngleAxisf(2, Vec3::UnitY()))};  // gravity keeps its direction
      for (Sender& sender : senders) sender.epoch += with_epoch ? 1 : 0;
    }
    senders[0].send(poses(step, {}));
    senders[1].send(poses(step, motion));
    if (step == kCut && !with_epoch) here.simulation.jumpToPoses();
    here.advance();
    far.advance();
    const std::span<const Vec3> a = here.simulation.guides(), b = far.simulation.guides();
    if (step == kCut) {
      EXPECT_EQ(far.cuts, 2u) << "the first step is one, too";
      EXPECT_TRUE(channels[1].recorded.back().is_cut);
    }
    for (size_t v = 0; v < a.size(); ++v)
      ASSERT_LT((b[v] - motion.apply(a[v])).norm(), 1e-5f) << step << ", vertex " << v;
  }
}

/// Without bodies: those that stand would touch the hair before the cut only.
Scene sceneWithoutBodies() {
  Scene scene = fewStrandsScene();
  scene.bodies.clear();
  scene.named_parts = 0;
  scene.named_bodies.clear();
  return scene;
}

TEST_F(LivePosesTest, ANewEpochIsACutOfTheHead) {
  expectRigidCut(fewStrands(), sceneWithoutBodies(), "head", true, [](int step, const Pose& motion) {
    return std::vector<Pose>{motion * nodding(step / 60.0)};
  });
}

TEST_F(LivePosesTest, AnImpossibleSpeedIsACutOfTheHead) {
  // The step of the cut has no motion: both stand still around it.
  expectRigidCut(fewStrands(), sceneWithoutBodies(), "head", false, [](int step, const Pose& motion) {
    return std::vector<Pose>{motion * nodding(std::min(step, 15) / 60.0)};
  });
}

/// Motions from rest of the joints of a body's clip.
std::vector<Pose> paletteOf(const SkinnedBody& body, double seconds) {
  const Skeleton& skeleton = body.skin().skeleton;
  const std::vector<Placement> rest = skeleton.worldTransforms(skeleton.rest()),
                               joints = body.at(seconds, {}).joints;
  std::vector<Pose> palette;
  for (size_t j = 0; j < joints.size(); ++j) {
    const Placement motion = joints[j] * rest[j].inverse();
    palette.push_back({Vec3(motion.translation().cast<float>()), nearestRotation(motion.linear())});
  }
  return palette;
}

std::string jointNames(const SkinnedBody& body) {
  std::string names;
  for (const SkeletonJoint& joint : body.skin().skeleton.joints)
    names += (names.empty() ? "joint:" : " joint:") + joint.name;
  return names;
}

class LivePalette : public LivePosesTest {
 protected:
  void SetUp() override {
    settings_ = fewStrands();
    settings_.scene = bendingArm(folder_, UpAxis::kY);
    writeStrands(folder_ / "hair.obj", fur(24, 0.1f, 0.45f, 0.04f, 0.12f));
    scene_ = makeScene(settings_.scene);
    start(settings_, scene_);
  }
  const SkinnedBody& body() const { return *scene_.skinned; }

  const ScratchFolder folder_;
  Settings settings_;
  Scene scene_;
};

TEST_F(LivePalette, GivesTheHairOfTheClip) {
  PosedChannel other;
  ControlledSimulation by_clip(settings_, scene_, other, 5);
  sender_.names = jointNames(body());
  double farthest = 0;
  for (int step = 0; step < 120; ++step) {
    sender_.send(paletteOf(body(), nextEnd()));
    controlled_->advance();
    if (step > 0) {
      by_clip.advance();
    } else {  // a source begins with a cut
      by_clip.moveTo(by_clip.simulation.time() + double{by_clip.simulation.parameters().time_step});
      by_clip.simulation.jumpToPoses();
      by_clip.simulation.step();
    }
    const std::span<const Vec3> a = by_clip.simulation.guides(), b = controlled_->simulation.guides();
    for (size_t v = 0; v < a.size(); ++v) farthest = std::max<double>(farthest, (a[v] - b[v]).norm());
  }
  std::printf("a clip sent as a palette moves hair by %.2g um at most\n", 1e6 * farthest);
  EXPECT_LT(farthest, 1e-6);
  EXPECT_EQ(metrics().interpolated, 0u);
}

TEST_F(LivePalette, ANewEpochIsACutOfTheSkin) {
  expectRigidCut(settings_, scene_, jointNames(body()), true, [&](int step, const Pose& motion) {
    std::vector<Pose> palette = paletteOf(body(), step / 60.0);
    for (Pose& joint : palette) {
      joint = motion * joint;
      joint.rotation.normalize();
    }
    return palette;
  });
}

TEST_F(LivePalette, StaysAfterItsSourceUnderACommandedHead) {
  sender_.names = jointNames(body());
  for (int step = 0; step < 30; ++step) {
    sender_.send(paletteOf(body(), 0.8));
    controlled_->advance();
  }
  const Pose held = head();
  EXPECT_NE(order(CommandKind::kHeadMotion, "still", {}).find("moves the head's joint"), std::string::npos);
  passTime(4 * kNsPerSecond);
  EXPECT_EQ(metrics().sources, 0u);
  EXPECT_EQ(order(CommandKind::kHeadMotion, "still", {}), "");
  for (int step = 0; step < 60; ++step) controlled_->advance();
  EXPECT_LT((head().position - held.position).norm(), 1e-6f);
  EXPECT_LT(head().rotation.angularDistance(held.rotation), 1e-3f);
}

TEST_F(LivePalette, IsTheWholeMotionOfTheHead) {
  const std::vector<Pose> palette = paletteOf(body(), 0.8);
  sender_.names = jointNames(body());
  for (int step = 0; step < 30; ++step) {
    sender_.send(palette);
    controlled_->advance();
  }
  const Pose still = head();
  settings_.scene.motion = "shake";
  scene_ = makeScene(settings_.scene);
  start(settings_, scene_);
  Sender both{channel_, 8, "head " + jointNames(body())};
  for (int step = 0; step < 30; ++step) {
    std::vector<Pose> poses = {nodding(step / 60.0)};
    poses.insert(poses.end(), palette.begin(), palette.end());
    both.send(poses);
    controlled_->advance();
    ASSERT_TRUE(areSame(head(), still)) << step << ": neither --motion nor the sender's head is added";
  }
}

TEST_F(LivePalette, HasWeightsAndScales) {
  samples::ArmOptions swelling;
  swelling.bulge = 0.01f;
  writeFileBytes(folder_ / "arm.glb", samples::armGlb(swelling));
  settings_.scene.skinned->clip = "swell";
  scene_ = makeScene(settings_.scene);
  start(settings_, scene_);
  sender_.names = "joint:upper";
  sender_.weight_names = "bulge frown";
  sender_.send({{}}, {0.75f, 3}, {1.5f, 1, 1});
  controlled_->advance();
  Simulation expected = simulated(scene_, makeReferenceBackend());
  std::vector<std::optional<Placement>> palette(body().skin().skeleton.joints.size());
  Placement scaled = Placement::Identity();
  scaled.scale(Eigen::Vector3d(1.5, 1, 1));
  palette[static_cast<size_t>(body().skin().skeleton.find("upper"))] = scaled;
  place(body(), body().fromPalette(palette, std::vector<float>{0.75f}, {}), {}, expected);
  expected.step();
  for (const BodyId id : expected.bodyIds()) {
    EXPECT_TRUE(areSame(controlled_->simulation.bodyPose(id), expected.bodyPose(id))) << id;
    EXPECT_EQ(controlled_->simulation.bodyBend(id).isNone(), expected.bodyBend(id).isNone());
  }
  EXPECT_FALSE(expected.bodyBend(0).isNone() && expected.bodyBend(1).isNone());
  EXPECT_EQ(channel_.recorded.back().poses.weight_names, "bulge");
  // Weights alone leave the joints to the clip.
  sender_.names = "";
  start(settings_, scene_);
  for (int step = 0; step < 3; ++step) {
    sender_.send({}, {0.75f, 3});
    controlled_->advance();
  }
  const double now = controlled_->simulation.time();
  place(body(), body().at(now, {}, std::vector<float>{0.75f}), {}, expected);
  expected.step();
  for (const BodyId id : expected.bodyIds())
    EXPECT_TRUE(areSame(controlled_->simulation.bodyPose(id), expected.bodyPose(id))) << id;
}

TEST_F(LivePalette, WeighsTargetsThatTheClipDoesNotPlay) {
  samples::ArmOptions swelling;
  swelling.bulge = 0.01f;
  writeFileBytes(folder_ / "arm.glb", samples::armGlb(swelling));
  settings_.scene.skinned->clip.clear();
  sender_.names = "";
  sender_.weight_names = "bulge";
  for (const char* targets : {"clip", "all"}) {
    readConfigText(std::string("[body]\ntargets = \"") + targets + "\"\n", "a.toml", settings_);
    scene_ = makeScene(settings_.scene);
    start(settings_, scene_);
    sender_.send({}, {0.75f});
    controlled_->advance();
    bool is_bent = false;
    for (const BodyId id : controlled_->simulation.bodyIds())
      is_bent = is_bent || !controlled_->simulation.bodyBend(id).isNone();
    EXPECT_EQ(metrics().samples, std::string(targets) == "all" ? 1u : 0u);
    EXPECT_EQ(is_bent, std::string(targets) == "all");
    const PoseTargets named(scene_, controlled_->simulation, controlled_->head, controlled_->colliders);
    EXPECT_EQ(named.isUnreadWeight("bulge"), std::string(targets) == "clip");
    EXPECT_FALSE(named.isUnreadWeight("frown"));
  }
}

TEST_F(LivePalette, JointsOfAFileThatIsReadWithoutItsSkinAreToldFromOthers) {
  const PosedName upper{PosedKind::kJoint, "upper"}, tail{PosedKind::kJoint, "tail"};
  const auto targets = [&] {
    return PoseTargets(scene_, controlled_->simulation, controlled_->head, controlled_->colliders);
  };
  EXPECT_FALSE(targets().isUnreadJoint(upper)) << "it is read";
  settings_.scene.skinned.reset();
  scene_ = makeScene(settings_.scene);
  start(settings_, scene_);
  EXPECT_EQ(targets().find(upper).kind, PosedKind::kOther);
  EXPECT_TRUE(targets().isUnreadJoint(upper));
  EXPECT_FALSE(targets().isUnreadJoint(tail));
  EXPECT_FALSE(targets().isUnreadJoint({PosedKind::kBone, "upper"}));
  EXPECT_EQ(std::count_if(scene_.notes.begin(), scene_.notes.end(),
                          [](const std::string& note) {
                            return note.find("arm.glb has ") == 0 && note.find("--body-joint") < note.size();
                          }),
            1);
}

TEST_F(LivePosesTest, MovesTheBonesOfPins) {
  Settings settings = fewStrands();
  settings.scene.pins = {{.parts = {}, .bone = "ribbon", .from = 0.8f, .to = 1, .where = "a test"}};
  const Scene scene = makeScene(settings.scene);
  start(settings, scene);
  sender_.names = "bone:ribbon bone:bow";
  const Pose tied{Vec3(0.01f, 0.02f, 0), Quat::Identity()};
  sender_.send({tied, {}});
  controlled_->advance();
  EXPECT_TRUE(areSame(controlled_->simulation.bonePose(1), tied));
  EXPECT_TRUE(areSame(head(), {}));
  EXPECT_EQ(channel_.recorded.back().poses.names, "bone:ribbon") << "no pin has a bow";
}

TEST_F(LivePosesTest, OneOfTwoSourcesMovesTheHeadUntilItIsSilent) {
  Sender other{channel_, 8};
  const Pose left{Vec3(-0.1f, 0, 0), Quat::Identity()}, right{Vec3(0.1f, 0, 0), Quat::Identity()};
  for (int step = 0; step < 20; ++step) {
    sender_.send({left});
    other.send({right});
    controlled_->advance();
    ASSERT_TRUE(areSame(head(), left)) << step;
  }
  EXPECT_GE(metrics().refused, 19u);
  EXPECT_EQ(metrics().sources, 2u);
  stepAfter(4 * kNsPerSecond / 10);
  EXPECT_TRUE(areSame(head(), left)) << "both are silent, for less than half a second";
  other.send({right});
  channel_.waiting.back().arrival_time += 6 * kNsPerSecond / 10;
  stepAfter(6 * kNsPerSecond / 10);
  EXPECT_EQ(head().position.x(), 0.1f);
  EXPECT_TRUE(channel_.recorded.back().is_cut) << "the head is somewhere else";
  EXPECT_EQ(controlled_->poses.source(), 8u);
}

TEST_F(LivePosesTest, SourcesOfDifferentThingsMoveTogether) {
  std::vector<double> ball = {0, 0, 0, 0, 0.5, 0, 0, 0, 1};
  ContactPrimitive shape;
  shape.radius = 0.04f;
  shapeNumbers(shape, [&](float n) { ball.push_back(static_cast<double>(n)); });
  Sender other{channel_, 8, "body:a%20ball joint:tail"};
  const Pose moved{Vec3(0.3f, 0.2f, 0.1f), Quat::Identity()};
  other.send({moved, {}});
  controlled_->advance();
  ASSERT_EQ(order(CommandKind::kAddCollider, "a ball", ball), "") << "a body may come after its poses";
  for (int step = 0; step < 10; ++step) {
    sender_.send({nodding(step / 60.0)});
    other.send({moved, {}});
    controlled_->advance();
  }
  EXPECT_TRUE(areSame(head(), nodding(9 / 60.0)));
  const BodyId body = controlled_->colliders.named().at("a ball").body;
  EXPECT_TRUE(areSame(controlled_->simulation.bodyPose(body), moved));
  EXPECT_EQ(metrics().refused, 0u);
  EXPECT_NE(order(CommandKind::kMoveCollider, "a ball", {0, 0, 0, 0, 0, 0, 1})
                .find("live source 0000000000000008 moves collider 'a ball'"),
            std::string::npos);
  EXPECT_EQ(order(CommandKind::kRemoveCollider, "a ball", {}), "");
  other.send({moved, {}});
  controlled_->advance();
}

TEST_F(LivePosesTest, CommandsMoveTheHeadAgainThreeSecondsAfterItsLastPose) {
  for (int step = 0; step < 20; ++step) {
    sender_.send({nodding(step / 60.0)});
    controlled_->advance();
  }
  const std::vector<double> pose = {0, 0.1, 0, 0, 0, 0, 1};
  const Pose last = nodding(19 / 60.0);
  EXPECT_NE(order(CommandKind::kHeadPose, "", pose).find("live source 0000000000000007 moves the head"),
            std::string::npos);
  EXPECT_NE(order(CommandKind::kHeadMotion, "nod", {}).find("3 s after its last poses"), std::string::npos);
  passTime(29 * kNsPerSecond / 10);
  EXPECT_NE(order(CommandKind::kHeadPose, "", pose), "");
  passTime(31 * kNsPerSecond / 10);
  for (int step = 0; step < 20; ++step) controlled_->advance();
  EXPECT_TRUE(areSame(head(), last)) << "nothing has moved it since";
  EXPECT_EQ(order(CommandKind::kHeadPose, "", pose), "");
  Pose before = head();
  for (int step = 0; step < 20; ++step) {
    controlled_->advance();
    EXPECT_LT((head().position - before.position).norm(), 0.02f) << "from where it was";
    before = head();
  }
  EXPECT_LT((head().position - Vec3(0, 0.1f, 0)).norm(), 1e-6f);
}

TEST_F(LivePosesTest, AfterAPauseTheNewestPosesAreTakenWithoutAJump) {
  for (int step = 0; step < 20; ++step) {
    sender_.send({nodding(step / 60.0)});
    controlled_->advance();
  }
  for (int step = 20; step < 95; ++step) {
    sender_.send({nodding(step / 60.0)});
    passTime(0);
  }
  sender_.later = 2 * kNsPerSecond;  // locks are half a second apart
  Pose before = head();
  for (int step = 95; step < 140; ++step) {
    sender_.send({nodding(step / 60.0)});
    controlled_->advance();
    EXPECT_LT((head().position - before.position).norm(), 0.03f) << step;
    before = head();
  }
  EXPECT_TRUE(areSame(head(), nodding(139 / 60.0)));
  EXPECT_EQ(metrics().jumps, 1u);
  EXPECT_EQ(metrics().relocks, 1u);
}

TEST_F(LivePosesTest, MessagesWithoutKnownNamesAreRefused) {
  const std::string names = std::exchange(sender_.names, "");
  sender_.send({nodding(0)});
  controlled_->advance();
  EXPECT_EQ(metrics().refused, 1u);
  EXPECT_TRUE(areSame(head(), {}));
  sender_.names = names;
  sender_.send({nodding(0.1)});
  controlled_->advance();
  sender_.names = "";
  sender_.send({nodding(0.2)});
  controlled_->advance();
  EXPECT_EQ(metrics().refused, 1u) << "this revision's names were here";
  EXPECT_TRUE(areSame(head(), nodding(0.2)));
}

TEST_F(LivePosesTest, MessagesOfUnknownThingsAreRefused) {
  sender_.names = "joint:nobody";
  for (int step = 0; step < 3; ++step) {
    sender_.send({nodding(0)});
    controlled_->advance();
  }
  EXPECT_EQ(metrics().refused, 3u);
  EXPECT_EQ(metrics().samples, 0u);
  EXPECT_EQ(metrics().state, PoseState::kNone);
}

TEST_F(LivePosesTest, AJumpOfTheNumbersIsNoLoss) {
  sender_.send({nodding(0)});
  controlled_->advance();
  sender_.number += 4;
  sender_.send({nodding(0.1)});
  sender_.number += 2'000'000'000;
  sender_.send({nodding(0.2)});
  controlled_->advance();
  EXPECT_EQ(metrics().lost, 4u);
}

TEST_F(LivePosesTest, AStandbyTakesTheSamplesOfTheDaemonThatCasts) {
  PosedChannel channel;
  ControlledSimulation standby(fewStrands(), fewStrandsScene(), channel, 6);
  StatusReport report(1, 6, "test", standby.simulation);
  ShowState show(fewStrands(), {}, *controlled_, *report_), standby_show(fewStrands(), {}, standby, report);
  for (int step = 0; step < 60; ++step) {
    sender_.send({nodding(step / 60.0)});
    channel.waiting.push_back(channel_.waiting.back());
    controlled_->advance();
    if (step % 3 > 0) standby.advance();
    if (step % 3 == 2) standby.advance();  // as many steps, at other times
    if (step == 30) {
      const std::optional<Show> sent = showOf(showBytes(show.make(false)));
      ASSERT_TRUE(sent);
      (void)standby_show.restoreFrom(*sent);
    }
  }
  ASSERT_EQ(channel.recorded.size(), channel_.recorded.size());
  for (size_t step = 31; step < channel.recorded.size(); ++step)
    EXPECT_EQ(channel.recorded[step].poses.time, channel_.recorded[step].poses.time) << step;
}

/// Takes over from a daemon whose sources are silent, by a show with hair. Both then go on alone.
void expectSameAfterTakeOver(const Settings& settings, const Scene& scene, ControlledSimulation& caster,
                             StatusReport& report) {
  PosedChannel channel;
  ControlledSimulation standby(settings, scene, channel, 6);
  StatusReport standby_report(1, 6, "test", standby.simulation);
  ShowState show(settings, {}, caster, report), standby_show(settings, {}, standby, standby_report);
  const std::optional<Show> sent = showOf(showBytes(show.make(true)));
  ASSERT_TRUE(sent);
  (void)standby_show.restoreFrom(*sent);
  for (int step = 0; step < 30; ++step) {
    caster.advance();
    standby.advance();
    Simulation &a = caster.simulation, &b = standby.simulation;
    ASSERT_TRUE(areSame(b.headPose(), a.headPose())) << step;
    for (size_t bone = 1; bone < a.model().bones.size(); ++bone)
      ASSERT_TRUE(areSame(b.bonePose(bone), a.bonePose(bone))) << step << ", bone " << bone;
    for (const BodyId id : a.bodyIds()) ASSERT_TRUE(areSame(b.bodyPose(id), a.bodyPose(id))) << step;
    for (size_t v = 0; v < a.guides().size(); ++v)
      ASSERT_LT((a.guides()[v] - b.guides()[v]).norm(), 1e-5f) << step << ", vertex " << v;
  }
}

TEST_F(LivePosesTest, AStandbyTakesTheHeadAndBonesOfASourceThatIsGone) {
  Settings settings = fewStrands();
  settings.scene.pins = {{.parts = {}, .bone = "a ribbon", .from = 0.8f, .to = 1, .where = "a test"}};
  const Scene scene = makeScene(settings.scene);
  start(settings, scene);
  sender_.names = "head bone:a%20ribbon";
  for (int step = 0; step < 20; ++step) {
    sender_.send({nodding(step / 60.0), {Vec3(0.01f, 0.02f, 0), Quat::Identity()}});
    controlled_->advance();
  }
  EXPECT_TRUE(controlled_->poses.held().empty()) << "a standby hears the source itself";
  passTime(4 * kNsPerSecond);
  EXPECT_EQ(controlled_->poses.held().size(), 2u);
  expectSameAfterTakeOver(settings, scene, *controlled_, *report_);
  EXPECT_LT((head().position - nodding(19 / 60.0).position).norm(), 1e-6f);
  ASSERT_EQ(order(CommandKind::kHeadMotion, "shake", {}), "");
  expectSameAfterTakeOver(settings, scene, *controlled_, *report_);
  EXPECT_EQ(controlled_->poses.held().size(), 1u) << "the bone";
}

TEST_F(LivePalette, IsTakenOverByAStandby) {
  samples::ArmOptions swelling;
  swelling.bulge = 0.01f;
  writeFileBytes(folder_ / "arm.glb", samples::armGlb(swelling));
  settings_.scene.skinned->clip = "swell";
  settings_.scene.motion = "shake";
  scene_ = makeScene(settings_.scene);
  start(settings_, scene_);
  sender_.names = jointNames(body());
  sender_.weight_names = "bulge";
  const std::vector<Pose> palette = paletteOf(body(), 0.8);
  for (int step = 0; step < 10; ++step) {
    std::vector<float> scales;
    for (size_t joint = 0; joint < palette.size(); ++joint) scales.insert(scales.end(), {1.1f, 1, 1});
    sender_.send(palette, {0.5f}, scales);
    controlled_->advance();
  }
  passTime(4 * kNsPerSecond);
  EXPECT_EQ(controlled_->poses.held().size(), palette.size() + 1);
  expectSameAfterTakeOver(settings_, scene_, *controlled_, *report_);
  ASSERT_EQ(order(CommandKind::kHeadMotion, "nod", {}), "") << "from now on it is added to the palette";
  expectSameAfterTakeOver(settings_, scene_, *controlled_, *report_);
}

TEST_F(LivePosesTest, HeldPosesOutOfRangeAreRefused) {
  const auto refusal = [&](const std::string& name, std::vector<double> values) {
    return errorTextOf([&] { controlled_->poses.restore({name, std::move(values)}, "a show"); });
  };
  EXPECT_EQ(refusal("bone:nobody", {0, 0, 0, 0, 0, 0, 1}), "");
  for (const std::vector<double>& values : std::vector<std::vector<double>>{
           {}, {0, 0, 0, 0, 0, 0}, {2000, 0, 0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 0, 0}})
    EXPECT_NE(refusal("head", values).find("'head'"), std::string::npos);
  EXPECT_NE(refusal("weight:smile", {1e300}).find("a show"), std::string::npos);
  EXPECT_NE(refusal("joint:upper", std::vector<double>(13)), "") << "it cannot be inverted";
  EXPECT_NE(refusal("", {0}), "");
  EXPECT_TRUE(areSame(head(), {}));
}

TEST_F(LivePosesTest, SixteenSourcesAreHeard) {
  for (uint64_t source = 1; source <= 20; ++source) {
    Sender{channel_, source}.send({nodding(0)});
    controlled_->advance();
  }
  EXPECT_EQ(metrics().sources, 16u);
  EXPECT_EQ(controlled_->poses.source(), 1u);
}

TEST_F(LivePosesTest, FramesAreWantedWhenTheirPosesAreHere) {
  EXPECT_FALSE(controlled_->poses.wantedAt(nextEnd()));
  for (int step = 0; step < 70; ++step) {
    sender_.send({nodding(step / 60.0)});
    channel_.waiting.back().arrival_time = 1'000'000'000'000 + sender_.time + (step % 2) * 4'000'000;
    controlled_->poses.advance(nextEnd(), static_cast<int64_t>(channel_.waiting.back().arrival_time));
    controlled_->moveTo(nextEnd());
    controlled_->simulation.step();
  }
  const auto wanted = controlled_->poses.wantedAt(nextEnd());
  ASSERT_TRUE(wanted);
  const int64_t here = 1'000'000'000'000 + static_cast<int64_t>(sender_.time + sender_.period);
  EXPECT_NEAR(static_cast<double>(wanted->time_since_epoch().count() - here), 5e6, 1e5)
      << "its lateness, and 1 ms";
}

/// A daemon at 60 Hz over a sender, by a clock of the test. A head slides at 2 Hz by 0.01 m.
class LivePace : public LivePosesTest {
 protected:
  static Pose sliding(int64_t ns) {
    const double phase = 2 * EIGEN_PI * 2 * 1e-9 * static_cast<double>(ns);
    return {Vec3(static_cast<float>(0.01 * std::sin(phase)), 0, 0), Quat::Identity()};
  }
  /// Starts daemon and sender anew. `repeated`: samples that messages repeat; `earlier`: messages that were
  /// sent before.
  void begin(double rate, int repeated, int earlier) {
    start(fewStrands(), fewStrandsScene());
    channel_.waiting.clear();
    sender_.number = 0;
    sender_.time = 5 * kNsPerSecond;
    sender_.period = static_cast<uint64_t>(1e9 / rate);
    repeated_ = repeated;
    for (int i = 0; i < earlier; ++i) (void)message();
    next_ = now_ + 3 * kNsPerMillisecond;
  }
  /// The next message, which repeats `repeated_` samples before its own.
  PoseSamples message() {
    const auto time = static_cast<int64_t>(sender_.time), period = static_cast<int64_t>(sender_.period);
    PoseSamples message = sender_.message({sliding(time)});
    for (int i = 1; i <= std::min<int>(repeated_, static_cast<int>(message.newest)); ++i) {
      message.ages.push_back(static_cast<uint32_t>(i * period));
      append(message.poses, sliding(time - i * period));
    }
    EXPECT_TRUE(isSound(message));
    return message;
  }
  /// Passes time, in which messages come but no frame is made.
  void wait(int64_t ns) {
    now_ += ns;
    for (; next_ <= now_; next_ += static_cast<int64_t>(sender_.period)) {
      channel_.waiting.push_back(message());
      channel_.waiting.back().arrival_time = static_cast<uint64_t>(next_);
    }
  }
  /// Makes the step of a frame, then waits for the next one. False where the step's poses are not those of
  /// the motion within 0.03 mm: 1 % of a step at 0.13 m/s, and the error of splines at 24 Hz.
  bool frame() {
    const double end = nextEnd();
    (void)controlled_->poses.advance(end, now_);
    controlled_->moveTo(end);
    controlled_->simulation.step();
    wait(pacer_.next(wall(now_), controlled_->poses.wantedAt(nextEnd())).time_since_epoch().count() - now_);
    const std::vector<LivePoses::Delay> delays = controlled_->poses.delays();
    if (delays.empty()) return false;
    const int64_t time = std::llround(1e9 * end) - delays[0].ns;
    return (head().position - sliding(time).position).norm() < 3e-5f;
  }
  static FramePacer::Clock::time_point wall(int64_t ns) {
    return FramePacer::Clock::time_point(std::chrono::nanoseconds(ns));
  }

  int64_t now_ = 1000 * kNsPerSecond, next_ = now_;  ///< steady clock; `next_`: arrival of the next message
  int repeated_ = 0;                                 ///< samples
  FramePacer pacer_{60, wall(now_)};
};

TEST_F(LivePace, StepsOverASlowerSenderHaveSamplesOnBothSidesFromTheSecondOneOn) {
  for (const double rate : {24.0, 30.0, 50.0, 59.0}) {
    for (const int earlier : {0, 1, 9}) {  // messages that are sent before the daemon listens
      begin(rate, earlier > 0 ? 2 : 0, earlier);
      int steps = 0;
      float before = 0;
      for (; steps < 120; ++steps) {
        const bool is_right = frame();
        if (metrics().state == PoseState::kNone || head().position.x() == before) continue;
        before = head().position.x();
        EXPECT_LE(metrics().extrapolated, earlier > 0 ? 0u : 3u) << rate << " Hz, step " << steps;
        if (steps > 20) {
          ASSERT_TRUE(is_right) << rate << " Hz, step " << steps;
        }
      }
      EXPECT_LE(metrics().rested + metrics().late + metrics().relocks, 0u);
      EXPECT_NEAR(metrics().delay_ms, 1000 / rate + 1, 0.2) << "one period, and the reserve";
      EXPECT_EQ(metrics().jumps, 1u) << "the first step";
    }
  }
}

TEST_F(LivePace, ASenderAsFastAsTheStepsIsNotHeldBack) {
  for (const double rate : {59.94, 60.0, 120.0}) {
    for (const int repeated : {0, 2}) {
      begin(rate, repeated, 9);
      for (int step = 0; step < 120; ++step) {
        const bool is_right = frame();
        if (metrics().state != PoseState::kNone) {
          ASSERT_TRUE(is_right) << rate << " Hz, step " << step;
        }
      }
      EXPECT_EQ(metrics().extrapolated + metrics().interpolated, 0u);
      EXPECT_NEAR(metrics().delay_ms, 1, 0.2) << "the reserve alone";
    }
  }
}

TEST_F(LivePace, FollowsASenderThatBecomesSlower) {
  for (int step = 0; step < 120; ++step) frame();
  sender_.period = 33'333'334;
  for (int step = 0; step < 180; ++step) frame();
  const uint64_t extrapolated = metrics().extrapolated;
  for (int step = 0; step < 60; ++step) EXPECT_TRUE(frame()) << step;
  EXPECT_EQ(metrics().extrapolated, extrapolated) << "the pace waits for both samples";
}

TEST_F(LivePace, PosesAfterAReleaseAreAsGoodAsBefore) {
  for (const bool is_paused : {false, true}) {
    begin(30, 0, 0);  // every other step is between samples
    for (int step = 0; step < 120; ++step) frame();
    for (int step = 0; step < 30; ++step) ASSERT_TRUE(frame()) << "before";
    const uint64_t extrapolated = metrics().extrapolated;
    // The machine stands for 0.3 s; or messages are left alone for 5 s.
    for (int i = 0; i < (is_paused ? 300 : 1); ++i) {
      wait(is_paused ? 16'666'667 : 300'000'000);
      if (is_paused) controlled_->poses.idle(nextEnd(), now_);
    }
    controlled_->poses.release();
    int rejoined = 0;
    for (int step = 0; step < 60; ++step) {
      const bool is_right = frame();
      rejoined += metrics().state == PoseState::kRejoining;
      if (metrics().state == PoseState::kLive) {
        ASSERT_TRUE(is_right) << (is_paused ? "after a pause, " : "after a stop, ") << step;
      }
    }
    EXPECT_GE(rejoined, 1);
    EXPECT_LE(rejoined, 4);
    EXPECT_EQ(metrics().relocks, 1u);
    EXPECT_EQ(metrics().extrapolated, extrapolated);
    EXPECT_EQ(metrics().jumps, 1u) << "the first step";
  }
}

TEST(LiveDaemon, FramesHaveThePosesOfTheirSteps) {
  PosedChannel channel;
  Sender sender{channel};
  Daemon daemon(fewStrands(), fewStrandsScene(), channel, 5);
  daemon.announce();
  const std::atomic<bool> stop{false};
  for (int frame = 0; frame < 200; ++frame) {
    sender.send({nodding(frame / 60.0)});
    const size_t steps = channel.recorded.size();
    daemon.castFrame(stop);
    ASSERT_FALSE(channel.recorded.empty());
    const auto shown = static_cast<int>((channel.recorded.back().poses.time - 5'000'000'000) / sender.period);
    EXPECT_EQ(shown + 1, static_cast<int>(channel.recorded.size())) << "each sample once";
    EXPECT_TRUE(areSame(channel.frames.back().head, nodding(shown / 60.0))) << frame;
    EXPECT_EQ(channel.frames.back().pose_source, 7u);
    EXPECT_EQ(channel.frames.back().pose_time, channel.recorded.back().poses.time);
    EXPECT_EQ(channel.frames.back().continuity, 1u) << "the cut of the first step";
    EXPECT_LE(channel.recorded.size() - steps, 1u);
  }
  EXPECT_GE(channel.recorded.size(), 199u) << "a step is 1 / 60 s as a float: some frame has none";
}

TEST(LiveDaemon, KeepsThePaceOfASenderOfAnotherClock) {
  PosedChannel channel;
  Settings settings = fewStrands();
  settings.duration = 2;
  Daemon daemon(settings, fewStrandsScene(), channel, 5);
  daemon.announce();
  const std::atomic<bool> stop{false};
  std::atomic<bool> is_over{false};
  std::thread thread([&] {
    Sender sender{channel};
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; !is_over; ++i) {
      std::this_thread::sleep_until(start + i * std::chrono::nanoseconds(sender.period + 1000));
      channel.inbox.push(sender.message({nodding(i / 60.0)}));
    }
  });
  daemon.run(stop);
  is_over = true;
  thread.join();
  size_t exact = 0;
  for (const GuideFrame& frame : channel.frames) {
    int sample = 0;
    while (sample < 130 && !areSame(frame.head, normalized(nodding(sample / 60.0)))) ++sample;
    exact += sample < 130 ? 1 : 0;
  }
  std::printf("%zu of %zu frames show a sample bit for bit\n", exact, channel.frames.size());
  EXPECT_GT(exact, channel.frames.size() / 3) << "how many depends on the load of the machine";
}

/// Records a run of 120 frames, started with the arguments `words`, that a source moves; resimulates it.
/// `poses(frame, motion)`: of the sender, all under `motion`.
void expectRepeated(const std::vector<std::string>& words, const std::string& names,
                    const std::function<std::vector<Pose>(int frame, const Pose& motion)>& poses) {
  const ScratchFolder folder;
  const std::filesystem::path run = folder / "live.rec";
  CLI::App app;
  const SettingsOptions options(app, SettingsUse::kServe);
  app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  auto owned = std::make_unique<PosedChannel>();
  PosedChannel& channel = *owned;
  RecordingPublisher publisher(std::move(owned), false);
  const Settings settings = options.resolve();
  Daemon daemon(settings, makeScene(settings.scene), publisher, 77);
  publisher.open(run, {1, {Codec::kFloat32}, simulationSource(words, options, "reference", "")});
  daemon.announce();
  Sender sender{channel, 7, names};
  uint64_t id = 0;
  const auto order = [&](CommandKind kind, std::vector<double> values) {
    channel.commands.push_back({.id = ++id, .kind = kind, .name = "", .values = std::move(values)});
  };
  const std::vector<double> pose = {0.01, 0.02, 0, 0, 0, 0, 1};
  const std::atomic<bool> stop{false};
  Pose motion;
  for (int frame = 0; frame < 120; ++frame) {
    if (frame == 20) order(CommandKind::kHeadPose, pose);  // refused where the source moves the head
    if (frame == 30 || frame == 35) order(CommandKind::kPause, {frame == 30 ? 1.0 : 0.0});
    if (frame == 50) {
      motion.position.x() = 2;
      ++sender.epoch;
    }
    if (frame == 95) sender.later = static_cast<uint64_t>(-4 * kNsPerSecond);  // it is dropped at once
    if (frame == 97) order(CommandKind::kHeadPose, pose);
    const std::vector<Pose> now = poses(frame, motion);
    // Samples between steps, a loss, and silence of a sixth of a second.
    if (frame == 60) sender.time += sender.period / 2;
    if (frame == 40) sender.message(now);
    if ((frame < 70 || frame >= 80) && frame != 40 && frame <= 95) sender.send(now);
    daemon.castFrame(stop);
  }
  EXPECT_EQ(publisher.close(), "");
  Recording recording(run);
  const ResimulationReport report = resimulate(recording, "live.rec", stop, [](uint64_t, Simulation&) {});
  EXPECT_EQ(report.frames, 120u);
  EXPECT_EQ(report.different, 0u) << "first: " << report.first_different;
  EXPECT_EQ(report.inputs, 3u) << "without the refused one";
  RecordedFrame read;
  recording.read(55, read);
  ASSERT_EQ(read.poses.size(), 1u);
  EXPECT_EQ(read.poses[0].poses.names, names);
  recording.read(5, read);
  EXPECT_FALSE(read.poses.at(0).is_cut);
}

TEST(LiveRecording, OfAHeadIsSimulatedAgainBitForBit) {
  expectRepeated({"--scene", "straight", "--strands", "20", "--vertices", "8", "--motion", "still",
                  "--body-contact", "spheres", "--backend", "reference"},
                 "head", [](int frame, const Pose& motion) {
                   return std::vector<Pose>{motion * nodding(frame / 60.0)};
                 });
}

TEST_F(LivePalette, ARecordingIsSimulatedAgainBitForBit) {
  expectRepeated({"--groom", (folder_ / "hair.obj").string(), "--unit-meters", "1", "--up", "y", "--body",
                  (folder_ / "arm.glb").string(), "--body-joint", "upper", "--body-cell", "0.01", "--backend",
                  "reference"},
                 "joint:upper joint:lower", [&](int frame, const Pose& motion) {
                   const Pose turn{Vec3::Zero(), Quat(Eigen::AngleAxisf(0.005f * static_cast<float>(frame),
                                                                        Vec3(Vec3::UnitY())))};
                   return std::vector<Pose>{motion, motion * turn};
                 });
}

}  // namespace
}  // namespace strandcast
