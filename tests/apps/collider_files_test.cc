// Colliders that a daemon makes from mesh files by command, over the in-process channel.
#include "service/colliders.h"
#include "service/daemon.h"

#include <CLI/CLI.hpp>
#include <fstream>

#include "options/scene_loading.h"
#include "service/replay.h"
#include "tests/apps/daemon_fixture.h"
#include "tests/collision/shapes.h"
#include "tests/expect_error.h"
#include "tests/io/sample_files.h"
#include "tests/io/scratch_folder.h"
#include "transport/chunks.h"
#include "transport/parameter_table.h"
#include "transport/recording/recorder.h"

namespace strandcast {
namespace {

// Other refusals: tests/io/folder_files_test.cc.
TEST(FilesWithin, AreThoseOfTheFolderAlone) {
  const ScratchFolder scratch;
  std::filesystem::create_directories(scratch / "open");
  for (const auto& file : {scratch / "open" / "a b.obj", scratch / "outside.obj"})
    std::ofstream(file) << "v 0 0 0\n";
  std::filesystem::create_symlink("../outside.obj", scratch / "open" / "outer.obj");
  const auto refusal = [&](const std::string& name, const std::filesystem::path& folder) {
    return errorOf([&] { checkFileWithin(folder, name, "here"); });
  };
  EXPECT_EQ(refusal("a b.obj", scratch / "open"), "");
  for (const auto& [name, words] :
       {std::pair{"../outside.obj", "is no name within the daemon's collider folder"},
        {"outer.obj", "is a link out of the daemon's collider folder"},
        {"absent.obj", "is not in the daemon's collider folder"}}) {
    EXPECT_NE(refusal(name, scratch / "open").find(words), std::string::npos)
        << refusal(name, scratch / "open");
    EXPECT_NE(refusal(name, scratch / "open").find("here"), std::string::npos);
  }
  EXPECT_NE(refusal("a b.obj", {}).find("--collider-folder"), std::string::npos);
  EXPECT_NE(refusal("a b.obj", scratch / "gone").find("cannot be read"), std::string::npos);
}

ColliderFile chair() {
  ColliderFile chair;
  chair.name = "a chair, 100 %";
  chair.file = "more/arm chair%20.obj";
  chair.pose = {Vec3(1, 2, 3), Quat(Eigen::AngleAxisf(0.5f, Vec3::UnitY()))};
  chair.friction = 0.5f;
  chair.unit_meters = 1e-6f;
  chair.cell = 1e3f;
  return chair;
}

TEST(ColliderFileCommands, SayWhatWasAskedFor) {
  ColliderFile asked = chair();
  for (const bool convex : {false, true}) {
    asked.kind = convex ? PrimitiveKind::kConvex : PrimitiveKind::kField;
    asked.follows_head = convex;
    if (convex) asked.cell = 0;
    Command command = colliderFileCommand(asked);
    command.id = 5;
    ASSERT_TRUE(isSound(command));
    const ColliderFile back = colliderFileOf(command, "here");
    EXPECT_EQ(back.name, asked.name);
    EXPECT_EQ(back.file, asked.file);
    EXPECT_EQ(back.kind, asked.kind);
    EXPECT_EQ(back.follows_head, asked.follows_head);
    EXPECT_EQ(back.pose.position, asked.pose.position);
    EXPECT_TRUE(back.pose.rotation.isApprox(asked.pose.rotation, 1e-6f));
    EXPECT_EQ(back.friction, asked.friction);
    EXPECT_EQ(back.unit_meters, asked.unit_meters);
    EXPECT_EQ(back.cell, asked.cell);
  }
  asked.file = std::string(kMaxTextBytes, 'x');
  EXPECT_NE(errorOf([&] { colliderFileCommand(asked); }).find("too long"), std::string::npos);
}

TEST(ColliderFileCommands, ThoseThatMakeNoSenseAreRefused) {
  const Command sound = colliderFileCommand(chair());
  const auto refusal = [](const Command& command) {
    return errorOf([&] { colliderFileOf(command, "here"); });
  };
  EXPECT_EQ(refusal(sound), "");
  for (const char* name : {"", "chair", " chair.obj", "chair ", "a chair chair.obj", "chair  chair.obj"}) {
    Command bad = sound;
    bad.name = name;
    EXPECT_NE(refusal(bad).find("two names"), std::string::npos) << name;
  }
  const std::pair<size_t, double> numbers[] = {{0, 5},    {0, 8},   {0, 6.5},  {0, 6},  {1, 2},
                                               {2, 2000}, {8, 9},   {9, -1},   {9, 11}, {10, -1},
                                               {10, 2e3}, {11, -1}, {11, 1e-9}};
  for (const auto& [at, number] : numbers) {
    Command bad = sound;
    bad.values[at] = number;
    EXPECT_NE(refusal(bad), "") << at << " " << number;
  }
  for (const size_t count : {0, 11, 13}) {
    Command bad = sound;
    bad.values.resize(count);
    EXPECT_NE(refusal(bad).find("12 numbers"), std::string::npos) << count;
  }
}

class DaemonColliderFiles : public DaemonFixture {
 protected:
  void SetUp() override {
    writeObj(scratch_ / "ball.obj", shapes::sphere(0.04f, 3));
    writeObj(scratch_ / "pebble.obj", shapes::sphere(0.04f, 2));  // few enough planes for a convex body
    writeObj(scratch_ / "cube.obj", shapes::box(Vec3(0.05f, 0.02f, 0.03f)));
    TriangleMesh open = shapes::sphere(0.04f, 2);
    open.triangles.resize(open.triangles.size() / 2);
    writeObj(scratch_ / "bowl.obj", open);
    std::ofstream(scratch_ / "broken.obj") << "v 0 0 0\nf 1 2 x\n";
    std::ofstream(scratch_ / "text.txt") << "no mesh\n";
    const samples::Bytes gltf = samples::gltf();
    const std::string text(reinterpret_cast<const char*>(gltf.data()), gltf.size());
    std::ofstream(scratch_ / "linked.gltf") << text.substr(0, text.find("data:")) << "buffer.bin\"}]}";
    std::ofstream(elsewhere_ / "buffer.bin") << std::string(60, '\0');
    std::filesystem::create_symlink(elsewhere_ / "buffer.bin", scratch_ / "buffer.bin");
    settings_ = fewStrands();
    settings_.scene.body_contact = BodyContact::kSpheres;
    settings_.collider_folder = scratch_.path();
    static const Scene scene = makeScene(settings_.scene);
    scene_bodies_ = scene.bodies.size();
    start(settings_, scene);
  }
  static ColliderFile of(const std::string& name, const std::string& file,
                         PrimitiveKind kind = PrimitiveKind::kField) {
    ColliderFile collider;
    collider.name = name;
    collider.file = file;
    collider.kind = kind;
    if (kind == PrimitiveKind::kField) collider.cell = 4e-3f;
    return collider;
  }
  /// A collider whose bake takes many seconds.
  static ColliderFile slow(const std::string& name) {
    ColliderFile collider = of(name, "ball.obj");
    collider.cell = 1e-4f;
    return collider;
  }
  uint64_t send(const ColliderFile& collider) {
    Command command = colliderFileCommand(collider);
    command.id = ++file_id_;
    subscriber_->send(command);
    return command.id;
  }
  std::optional<std::string> answerTo(uint64_t command) {
    return subscriber_->waitForAnswer(command, std::chrono::milliseconds(0));
  }
  /// Waits for the answer, casting frames meanwhile.
  std::string finalAnswer(uint64_t command) {
    for (int i = 0; i < 3000; ++i) {
      cast(1);
      if (const auto answer = answerTo(command)) return *answer;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return "no answer";
  }
  std::string add(const ColliderFile& collider) { return finalAnswer(send(collider)); }
  std::string command(CommandKind kind, const std::string& name, std::vector<double> values = {}) {
    return order(kind, std::move(values), name);
  }
  static std::vector<double> at(const Vec3& p, double seconds) {
    return {static_cast<double>(p.x()),
            static_cast<double>(p.y()),
            static_cast<double>(p.z()),
            0,
            0,
            0,
            1,
            seconds};
  }
  /// Distance from the surface of the newest collider, m, as readers receive it.
  float distance(const Vec3& p) const {
    const Collider& collider = subscriber_->colliders()->colliders.back();
    Pose pose;
    for (const PlacedCollider& placed : subscriber_->frame()->colliders)
      if (placed.id == collider.id) pose = placed.pose;
    ShapeData data;
    const uint32_t first = data.add(collider.shapes.at(0));
    return signedDistance(moved(collider.shapes[0], pose, pose, 1, first), p, data.words);
  }
  size_t colliders() const { return subscriber_->colliders()->colliders.size(); }

  const ScratchFolder scratch_, elsewhere_;
  Settings settings_;
  size_t scene_bodies_ = 0;

 private:
  uint64_t file_id_ = 1000;
};

TEST_F(DaemonColliderFiles, AreWhereTheyAreToldToBe) {
  const Pose pose{Vec3(0.3f, 0.4f, 0.5f), Quat(Eigen::AngleAxisf(0.7f, Vec3(1, 2, 3).normalized()))};
  for (const PrimitiveKind kind : {PrimitiveKind::kConvex, PrimitiveKind::kField})
    for (const bool follows_head : {false, true}) {
      SCOPED_TRACE(static_cast<int>(kind) * 10 + follows_head);
      ColliderFile cube = of("cube", "cube.obj", kind);
      cube.pose = pose;
      cube.follows_head = follows_head;
      cube.friction = 0.7f;
      ASSERT_EQ(add(cube), "");
      ASSERT_EQ(colliders(), scene_bodies_ + 1);
      const Collider& added = subscriber_->colliders()->colliders.back();
      EXPECT_EQ(added.follows_head, follows_head);
      EXPECT_EQ(added.shapes[0].kind, kind);
      EXPECT_EQ(added.shapes[0].friction, 0.7f);
      for (const float side : {-1.0f, 1.0f}) {
        EXPECT_NEAR(distance(pose.apply(Vec3(side * 0.05f, 0.005f, 0.01f))), 0, 2e-4f);
        EXPECT_NEAR(distance(pose.apply(Vec3(0.01f, side * 0.02f, 0.01f))), 0, 2e-4f);
        EXPECT_NEAR(distance(pose.apply(Vec3(0.01f, 0.005f, side * 0.03f))), 0, 2e-4f);
        EXPECT_NEAR(distance(pose.apply(Vec3(0, side * 0.023f, 0))), 0.003f, 2e-4f);
      }
      EXPECT_EQ(command(CommandKind::kRemoveCollider, "cube"), "");
      EXPECT_EQ(colliders(), scene_bodies_);
    }
  ColliderFile tiny = of("tiny", "cube.obj", PrimitiveKind::kConvex);
  tiny.unit_meters = 0.1f;
  ASSERT_EQ(add(tiny), "");
  EXPECT_NEAR(distance(Vec3(0.005f, 0, 0)), 0, 1e-5f);
}

TEST_F(DaemonColliderFiles, KeepHairOutAndAreMoved) {
  cast(1);
  const auto before = subscriber_->frame();
  size_t tip = 0;
  for (size_t v = 0; v < before->positions.size(); ++v)
    if (before->positions[v].norm() > before->positions[tip].norm()) tip = v;
  const Vec3 place = before->positions[tip];
  for (const PrimitiveKind kind : {PrimitiveKind::kConvex, PrimitiveKind::kField}) {
    ColliderFile ball = of("ball", kind == PrimitiveKind::kConvex ? "pebble.obj" : "ball.obj", kind);
    ball.pose.position = 3 * place;
    ASSERT_EQ(add(ball), "");
    const NamedValues told = entriesOf(subscriber_->status()->parameters, kColliderEntry);
    ASSERT_EQ(told.size(), 1u);
    EXPECT_EQ(told[0].first, "ball");
    cast(60);
    EXPECT_LT((subscriber_->frame()->positions[tip] - place).norm(), 0.01f) << "it is not near yet";
    EXPECT_EQ(command(CommandKind::kMoveCollider, "ball", at(place, 0.5)), "");
    cast(60);
    EXPECT_NEAR(distance(place), -0.04f, 1e-3f);
    EXPECT_GT((subscriber_->frame()->positions[tip] - place).norm(), 0.037f);
    EXPECT_EQ(command(CommandKind::kRemoveCollider, "ball"), "");
    EXPECT_EQ(command(CommandKind::kReset, ""), "");
  }
}

// docs/wire.md: only fields in their own frame carry the body's vertices.
TEST_F(DaemonColliderFiles, MeshesAreNoPartsOfTheBody) {
  ASSERT_EQ(add(of("ball", "ball.obj")), "");
  const ContactPrimitive& shape = subscriber_->colliders()->colliders.back().shapes[0];
  EXPECT_NE(shape.a, Vec3(Vec3::Zero()));
  for (const Vec3& p : subscriber_->body()->mesh.positions) ASSERT_GT(shape.field->at(p).distance, 1);
}

TEST_F(DaemonColliderFiles, FramesGoOnWhileTheyAreMade) {
  const uint64_t long_bake = send(slow("slow"));
  cast(1);
  const uint64_t frame = subscriber_->frame()->frame;
  EXPECT_NE(add(of("slow", "cube.obj", PrimitiveKind::kConvex)).find("is being made"), std::string::npos);
  std::vector<double> ball = {0, 0, 0, 0, 5, 0, 0, 0, 1};
  ContactPrimitive shape;
  shape.radius = 0.04f;
  shapeNumbers(shape, [&](float n) { ball.push_back(static_cast<double>(n)); });
  EXPECT_NE(command(CommandKind::kAddCollider, "slow", ball).find("is being made"), std::string::npos);
  EXPECT_EQ(command(CommandKind::kAddCollider, "ball", ball), "");
  cast(30);
  EXPECT_GE(subscriber_->frame()->frame, frame + 30);
  EXPECT_FALSE(answerTo(long_bake));
  EXPECT_EQ(command(CommandKind::kRemoveCollider, "slow"), "");
  EXPECT_NE(finalAnswer(long_bake).find("removed meanwhile"), std::string::npos);
  EXPECT_EQ(colliders(), scene_bodies_ + 1);
  EXPECT_NE(command(CommandKind::kRemoveCollider, "slow").find("unknown collider"), std::string::npos);
  EXPECT_EQ(add(of("slow", "cube.obj", PrimitiveKind::kConvex)), "") << "the name is free again";
}

TEST_F(DaemonColliderFiles, AreRefusedWhenTheDaemonEnds) {
  const uint64_t baked = send(slow("baked")), waits = send(of("waits", "cube.obj", PrimitiveKind::kConvex));
  cast(1);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(command(CommandKind::kShutdown, ""), "");
  for (const uint64_t command : {baked, waits})
    EXPECT_NE(answerTo(command).value_or("no answer").find("the daemon ends"), std::string::npos);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  EXPECT_EQ(colliders(), scene_bodies_);
  send(slow("another"));
  cast(1);
  daemon_.reset();  // does not wait for the bake
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

TEST_F(DaemonColliderFiles, SoManyAtMostWait) {
  std::vector<uint64_t> sent;
  for (size_t i = 0; i <= ColliderMaker::kMaxQueuedJobs; ++i)
    sent.push_back(send(slow("n" + std::to_string(i))));
  cast(1);
  EXPECT_NE(answerTo(sent.back()).value_or("no answer").find("wait for their answers"), std::string::npos);
  for (size_t i = 0; i < ColliderMaker::kMaxQueuedJobs; ++i) EXPECT_FALSE(answerTo(sent[i])) << i;
}

TEST_F(DaemonColliderFiles, WhatCannotBeMadeIsRefused) {
  const auto refusal = [&](const std::string& file, PrimitiveKind kind) {
    return add(of("bad", file, kind));
  };
  const struct {
    const char *file, *told;
    PrimitiveKind kind;
  } bad[] = {{"absent.obj", "is not in", PrimitiveKind::kField},
             {"../x.obj", "no name within", PrimitiveKind::kField},
             {"broken.obj", "broken.obj, line 2", PrimitiveKind::kField},
             {"broken.obj", "broken.obj, line 2", PrimitiveKind::kConvex},
             {"text.txt", "no known mesh format", PrimitiveKind::kConvex},
             {".", "is a folder", PrimitiveKind::kField},
             {"linked.gltf", "'buffer.bin' is a link out of its folder", PrimitiveKind::kField},
             {"bowl.obj", "is open", PrimitiveKind::kConvex}};
  for (const auto& [file, told, kind] : bad)
    EXPECT_NE(refusal(file, kind).find(told), std::string::npos) << file << "\n" << refusal(file, kind);
  ColliderFile fine = of("fine", "ball.obj");
  fine.cell = 1e-6f;
  EXPECT_NE(add(fine), "") << "its grid would have too many bricks";
  EXPECT_NE(add(of("", "cube.obj")), "");
  ASSERT_EQ(add(of("cube", "cube.obj", PrimitiveKind::kConvex)), "");
  EXPECT_NE(add(of("cube", "ball.obj")).find("unique name"), std::string::npos);
  EXPECT_EQ(colliders(), scene_bodies_ + 1);
  settings_.collider_folder.clear();
  start(settings_, makeScene(settings_.scene));
  EXPECT_NE(add(of("cube", "cube.obj", PrimitiveKind::kConvex)).find("--collider-folder"), std::string::npos);
}

// Bodies appear when they are made, which depends on timing: the recording must store when.
TEST_F(DaemonColliderFiles, ARunIsRepeated) {
  const std::filesystem::path run = scratch_ / "run.rec";
  const std::vector<std::string> words{"--scene",           "straight",
                                       "--strands",         "20",
                                       "--vertices",        "8",
                                       "--backend",         "reference",
                                       "--collider-folder", scratch_.path().string()};
  CLI::App app;
  const SettingsOptions options(app, SettingsUse::kServe);
  app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  std::vector<Vec3> with, without;
  for (const bool adds : {false, true}) {
    auto [channel, subscriber] = makeInProcessChannel(1);
    subscriber_ = std::move(subscriber);
    auto recording = std::make_unique<RecordingPublisher>(std::move(channel), false);
    RecordingPublisher& publisher = *recording;
    const Settings settings = options.resolve();
    daemon_ = std::make_unique<Daemon>(settings, makeSceneWithProgress(settings.scene), publisher, 77);
    publisher_ = std::move(recording);
    publisher.open(run, {1, {Codec::kFloat32}, simulationSource(words, options, "reference", "")});
    daemon_->announce();
    cast(3);
    if (adds) {
      ColliderFile ball = of("ball", "ball.obj");
      ball.cell = 1.5e-3f;
      ball.pose.position = Vec3(0, -0.05f, -0.12f);
      const uint64_t mesh = send(ball);
      // Refused because the name is taken. It must not be recorded: a resimulation, where the body appears
      // later, would accept it.
      EXPECT_NE(add(of("ball", "cube.obj", PrimitiveKind::kConvex)), "");
      EXPECT_EQ(finalAnswer(mesh), "");
      EXPECT_EQ(command(CommandKind::kMoveCollider, "ball", at(Vec3(0.05f, -0.1f, -0.1f), 0.2)), "");
    }
    const uint64_t end = adds ? subscriber_->frame()->frame + 20 : 100;
    while (subscriber_->frame()->frame < end) cast(1);
    EXPECT_EQ(publisher.close(), "");
    (adds ? with : without) = subscriber_->frame()->positions;
    daemon_.reset();
  }
  EXPECT_NE(with, without);
  Recording recording(run);
  const std::atomic<bool> stop{false};
  const ResimulationReport report = resimulate(recording, "run.rec", stop, [](uint64_t, Simulation&) {});
  EXPECT_EQ(report.frames, recording.frames());
  EXPECT_EQ(report.inputs, 2u) << "what was refused is not among them";
  EXPECT_EQ(report.different, 0u);
}

}  // namespace
}  // namespace strandcast
