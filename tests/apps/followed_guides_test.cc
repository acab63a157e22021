// Hairs that follow guides: from files and options through a daemon to its readers and recordings.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>

#include "daemon_fixture.h"
#include "groom/bound_growth.h"
#include "groom/groom_operations.h"
#include "io/groom_file.h"
#include "service/replay.h"
#include "service/stream.h"
#include "tests/expect_error.h"
#include "tests/io/scratch_folder.h"
#include "tests/real_data.h"
#include "transport/codec/guide_decoder.h"
#include "transport/codec/guide_encoder.h"
#include "transport/codec/hair_codec.h"
#include "transport/message_bytes.h"
#include "transport/recording/recorder.h"

namespace strandcast {
namespace {

constexpr size_t kStrands = 120;

/// Strands of 8 vertices and 14 cm that lean a little, on a plate of 12 x 10 cm; every tenth is marked as a
/// guide.
StrandSet plate(bool is_marked = true) {
  StrandSet strands;
  for (size_t s = 0; s < kStrands; ++s) {
    std::vector<Vec3> points;
    const auto x = static_cast<float>(s % 12), z = static_cast<float>(s / 12);
    for (int i = 0; i < 8; ++i)
      points.emplace_back(0.01f * x + 0.002f * static_cast<float>(i) * std::sin(x),
                          1.5f + 0.02f * static_cast<float>(i), 0.01f * z);
    strands.append(points);
    strands.ids.push_back(static_cast<uint32_t>(1000 + s));
    strands.colours.emplace_back(0.5f, 0, 1);
    if (is_marked) strands.is_guide.push_back(s % 10 == 0 ? 1 : 0);
  }
  return strands;
}

class FollowedGuides : public DaemonFixture {
 protected:
  void SetUp() override {
    spdlog::set_level(spdlog::level::off);
    writeGroom(folder_ / "marked.usda", plate());
    writeGroom(folder_ / "plain.usda", plate(false));
    writeGroom(folder_ / "few.usda", subset(plate(false), {0, 30, 60, 90, 119}));
  }
  void TearDown() override { spdlog::set_level(spdlog::level::info); }

  /// Of these options, FOLDER/ being that of the files.
  Settings settingsOf(std::string options) const {
    for (size_t at = 0; (at = options.find("FOLDER", at)) != std::string::npos;)
      options.replace(at, 6, (folder_ / "").string());
    CLI::App app;
    SettingsOptions settings(app, SettingsUse::kServe);
    app.parse(options);
    Settings resolved = settings.resolve();
    resolved.backend = "reference";
    resolved.scene.motion = "still";
    return resolved;
  }
  Scene sceneOf(const std::string& options) const { return makeScene(settingsOf(options).scene); }
  std::string refusalOf(const std::string& options) const {
    return errorOf([&] { sceneOf(options); });
  }

  const ScratchFolder folder_;
};

/// Expects that the hairs are these strands of plate(), in any order, with what belongs to them, bound to
/// guides of the scene.
void expectHairs(const Scene& scene, size_t guides, size_t hairs) {
  EXPECT_EQ(scene.groom.strands.strands(), guides);
  const StrandSet& strands = scene.hairs.strands;
  ASSERT_EQ(strands.strands(), hairs);
  ASSERT_EQ(scene.hairs.bindings.size(), hairs);
  ASSERT_EQ(strands.ids.size(), hairs);
  const StrandSet all = plate();
  for (size_t h = 0; h < hairs; ++h) {
    const size_t s = strands.ids[h] - 1000;
    ASSERT_LT(s, kStrands);
    EXPECT_TRUE(std::ranges::equal(strands.strand(h), all.strand(s))) << h;
    for (const uint32_t guide : scene.hairs.bindings[h].guides) EXPECT_LT(guide, guides);
    EXPECT_TRUE(h == 0 || scene.hairs.bindings[h - 1].guides[0] <= scene.hairs.bindings[h].guides[0]);
  }
}

TEST_F(FollowedGuides, ThatAreMarkedCarryTheOthers) {
  expectHairs(sceneOf("--groom FOLDER/marked.usda"), 12, kStrands - 12);
  expectHairs(sceneOf("--groom FOLDER/marked.usda --guides all"), kStrands, 0);
  expectHairs(sceneOf("--groom FOLDER/plain.usda"), kStrands, 0);
  expectHairs(sceneOf("--groom FOLDER/marked.usda --strands 6"), 6, kStrands - 12);
}

TEST_F(FollowedGuides, OfAShareCarryAllStrandsAndThemselves) {
  const Scene scene = sceneOf("--groom FOLDER/marked.usda --guides 5%");
  expectHairs(scene, 6, kStrands);
  size_t same = 0;
  for (size_t h = 0; h < kStrands; ++h) {
    const HairBinding& binding = scene.hairs.bindings[h];
    if (!std::ranges::equal(scene.hairs.strands.strand(h), scene.groom.strands.strand(binding.guides[0])))
      continue;
    ++same;
    EXPECT_EQ(binding.weight(0), 1);
  }
  EXPECT_EQ(same, 6u);
  expectHairs(sceneOf("--groom FOLDER/plain.usda --guides 0.01%"), 1, kStrands);
}

TEST_F(FollowedGuides, AndHairsMayBeInFilesOfTheirOwn) {
  expectHairs(sceneOf("--groom FOLDER/marked.usda --guides FOLDER/few.usda"), 5, kStrands);
  expectHairs(sceneOf("--groom FOLDER/few.usda --hair-files FOLDER/marked.usda"), 5, kStrands);
  expectHairs(sceneOf("--groom FOLDER/few.usda --hair-files FOLDER/plain.usda --strands 3"), 3, kStrands);
  const Scene resampled = sceneOf("--groom FOLDER/few.usda --hair-files FOLDER/plain.usda --vertices 5");
  expectHairs(resampled, 5, kStrands);
  EXPECT_EQ(resampled.groom.strands.verticesOf(0), 5u);
}

TEST_F(FollowedGuides, OptionsThatMakeNoSenseAreRefused) {
  EXPECT_NE(refusalOf("--hair-files FOLDER/plain.usda").find("a procedural scene has no hairs"),
            std::string::npos);
  EXPECT_NE(refusalOf("--groom FOLDER/plain.usda --guides 5").find("a share of the strands such as 5%"),
            std::string::npos);
  EXPECT_NE(refusalOf("--guides 5%").find("a procedural scene has no hairs"), std::string::npos);
  for (const std::string guides : {"5%", "all", "FOLDER/few.usda"})
    EXPECT_NE(refusalOf("--groom FOLDER/few.usda --hair-files FOLDER/plain.usda --guides " + guides)
                  .find("all strands of the groom are guides"),
              std::string::npos)
        << guides;
  EXPECT_NE(refusalOf("--groom FOLDER/plain.usda --guides 5% --strands 7").find("--strands"),
            std::string::npos);
  for (const std::string share : {"0%", "100%", "-3%", "x%", "%"})
    EXPECT_NE(refusalOf("--groom FOLDER/plain.usda --guides " + share).find("--guides"), std::string::npos)
        << share;
  EXPECT_NE(refusalOf("--groom FOLDER/plain.usda --guides FOLDER/absent.usda").find("absent.usda"),
            std::string::npos);
}

TEST_F(FollowedGuides, AreReadFromAConfiguration) {
  Settings settings;
  readConfigText(
      "[groom]\nfiles = \"a.usda\"\nhair_files = [\"b.usda\", \"c.usda\"]\n[transport]\nhair_error_mm = "
      "0.1\n",
      "/x/hair.toml", settings);
  ASSERT_EQ(settings.scene.hairs.size(), 2u);
  EXPECT_EQ(settings.scene.hairs[1], "/x/c.usda");
  EXPECT_FLOAT_EQ(settings.codec.hair_error, 1e-4f);
  readConfigText("[groom]\nguides = \"5%\"\n", "/x/hair.toml", settings);
  EXPECT_DOUBLE_EQ(settings.scene.guides.share, 0.05);
  readConfigText("[groom]\nguides = \"few.usda\"\n", "/x/hair.toml", settings);
  EXPECT_EQ(settings.scene.guides.file, "/x/few.usda");
  expectError([&] { readConfigText("[groom]\nguides = \"200%\"\n", "hair.toml", settings); },
              {"hair.toml line 2", "share"});
}

TEST_F(FollowedGuides, ADaemonAnnouncesTheirHairs) {
  const Settings settings = settingsOf("--groom FOLDER/marked.usda");
  const Scene scene = makeScene(settings.scene);
  start(settings, scene);
  const auto hairs = subscriber_->hairs();
  ASSERT_TRUE(hairs);
  EXPECT_EQ(hairs->session, subscriber_->groom()->session);
  EXPECT_EQ(hairs->revision, subscriber_->groom()->revision);
  EXPECT_EQ(hairs->hairs.positions, scene.hairs.strands.positions);
  EXPECT_EQ(hairs->ids, scene.hairs.strands.ids);
  ASSERT_EQ(hairs->colours.size(), hairs->hairs.strands());
  EXPECT_EQ(hairs->colours[0], (std::array<uint8_t, 3>{188, 0, 255})) << "linear 0.5 is 188 in sRGB";
  ASSERT_EQ(hairs->bindings.size(), scene.hairs.bindings.size());
  EXPECT_EQ(hairs->bindings[7].guides, scene.hairs.bindings[7].guides);
  EXPECT_EQ(subscriber_->groom()->growth, GroomDescription::kHairs);
  const StreamScene stream = StreamScene::of(*subscriber_);
  EXPECT_EQ(stream.hairs, hairs);
  cast(1);
  EXPECT_EQ(subscriber_->hairs(), hairs) << "once";
}

TEST_F(FollowedGuides, HairsOutOfReachAreRefusedWithFileOptionAndRemedy) {
  StrandSet far = plate(false);
  for (Vec3& p : far.strand(7)) p.x() += 3;
  writeGroom(folder_ / "far.usda", far);
  for (const auto& [options, source] :
       {std::pair("--groom FOLDER/few.usda --hair-files FOLDER/far.usda", "far.usda (--hair-files)"),
        std::pair("--groom FOLDER/far.usda --guides FOLDER/few.usda", "far.usda (--groom)")}) {
    const Settings settings = settingsOf(options);
    RecordingPublisher publisher(std::move(makeInProcessChannel(1).first));
    publisher.open(folder_ / "far.rec", {});
    Daemon daemon(settings, makeScene(settings.scene), publisher, newSession());
    daemon.announce();
    const std::string error = publisher.close();
    for (const std::string part : {source, "root at 3.0", "--unit-meters", "--hair-error"})
      EXPECT_NE(error.find(part), std::string::npos) << error;
  }
}

TEST_F(FollowedGuides, AndTheirHairsAreRecordedAndReplayed) {
  const Settings settings = settingsOf("--groom FOLDER/marked.usda");
  const Scene scene = makeScene(settings.scene);
  {
    RecordingPublisher publisher(std::move(makeInProcessChannel(1).first));
    publisher.open(folder_ / "a.rec", {});
    Daemon daemon(settings, scene, publisher, newSession());
    daemon.announce();
    const std::atomic<bool> stop{false};
    for (int i = 0; i < 3; ++i) daemon.castFrame(stop);
    EXPECT_EQ(publisher.close(), "");
  }
  Recording recording(folder_ / "a.rec");
  auto [publisher, subscriber] = makeInProcessChannel(1);
  Replay(recording, *publisher, 1, 77, {100}).run(std::atomic<bool>{false});
  const auto hairs = subscriber->hairs();
  ASSERT_TRUE(hairs);
  EXPECT_EQ(hairs->session, 77u);
  ASSERT_EQ(hairs->hairs.offsets, scene.hairs.strands.offsets);
  for (size_t v = 0; v < hairs->hairs.vertices(); ++v)
    EXPECT_LE((hairs->hairs.positions[v] - scene.hairs.strands.positions[v]).norm(),
              1.001f * CodecOptions().hair_error);
  StreamRecording again(*subscriber, folder_ / "b.rec", {});
  again.take(std::chrono::milliseconds(100));
  again.close();
  RecordedFrame frame;
  Recording(folder_ / "b.rec").read(0, frame);
  EXPECT_TRUE(frame.hairs);
}

TEST_F(FollowedGuides, ARecordingReplaysWithoutHairsThatAreDamaged) {
  const Settings settings = settingsOf("--groom FOLDER/marked.usda");
  {
    RecordingPublisher publisher(std::move(makeInProcessChannel(1).first));
    publisher.open(folder_ / "a.rec", {});
    Daemon daemon(settings, makeScene(settings.scene), publisher, newSession());
    daemon.announce();
    const std::atomic<bool> stop{false};
    for (int i = 0; i < 3; ++i) daemon.castFrame(stop);
    EXPECT_EQ(publisher.close(), "");
  }
  std::fstream file(folder_ / "a.rec", std::ios::binary | std::ios::in | std::ios::out);
  for (uint64_t at = sizeof kRecordingMagic;;) {
    uint8_t head[kRecordHeadBytes];
    file.seekg(static_cast<std::streamoff>(at));
    ASSERT_TRUE(file.read(reinterpret_cast<char*>(head), sizeof head));
    if (loadBigEndian<RecordKind>(head) == RecordKind::kHairs) {
      file.seekp(static_cast<std::streamoff>(at + kRecordHeadBytes + 100));
      file.write("damage", 6);
      break;
    }
    at += kRecordHeadBytes + loadBigEndian<uint32_t>(head + 4);
  }
  file.close();
  Recording recording(folder_ / "a.rec");
  auto [publisher, subscriber] = makeInProcessChannel(1);
  const ReplaySummary summary = Replay(recording, *publisher, 1, 77, {100}).run(std::atomic<bool>{false});
  EXPECT_EQ(summary.frames, 3u);
  EXPECT_EQ(summary.damaged, 0u);
  EXPECT_TRUE(subscriber->waitForGroom(std::chrono::milliseconds(100))) << "it waits for no hairs";
  EXPECT_FALSE(subscriber->hairs());
  EXPECT_EQ(subscriber->groom()->seeded, std::vector<uint8_t>(12, 0)) << "none from a seed instead";
}

/// Real grooms: 5 % of the strands carry all; at rest each is within the codec's error of the artist's hair.
class RealHairs : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(RealHairs, AreTheArtistsAtRestAndSmallOnTheWire) {
  SceneOptions options;
  for (const std::string& file : GetParam()) options.groom.push_back(dataFolder() / file);
  for (const auto& file : options.groom)
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  options.units.unit_meters = GetParam()[0].starts_with("ponytail") ? 0.0025f : 0;
  options.guides.share = 0.05;
  const Scene scene = makeScene(options);
  HairDescription sent;
  sent.session = 1;
  sent.hairs = scene.hairs.strands;
  sent.bindings = scene.hairs.bindings;
  const StrandSet& guides = scene.groom.strands;
  ASSERT_NO_THROW(checkHairs(sent, guides, "test"));
  const std::vector<HairChunk> chunks = encodeHairs(sent, guides, kDefaultHairError);
  HairDescription got;
  size_t bytes = 0;
  for (const HairChunk& chunk : chunks) {
    bytes += chunk.payload.size();
    ASSERT_TRUE(decodeHairs(chunk, guides, got));
  }
  // Guides as they come over the network, by the default codec.
  GuideFrame frame;
  frame.positions = guides.positions;
  GuideEncoder encoder{CodecOptions()};
  encoder.setGroom(guides);
  GuideDecoder decoder;
  decoder.setGroom(guides);
  std::vector<Vec3> received(guides.vertices());
  encoder.encodeAll(frame, [&](GuideChunk& chunk) {
    EXPECT_EQ(decoder.decode(chunk, std::span(received).subspan(chunk.first_vertex, chunk.vertex_count)),
              DecodeResult::kDone);
  });
  EXPECT_NE(received, guides.positions);
  const std::vector<Pose> still(guides.strands());
  const BoundHairReference reference(guides, received, still, 32);
  double worst = 0;
  for (size_t h = 0; h < got.hairs.strands(); h += 7) {
    const auto grown = reference.grow(got.hairs.strand(h), got.bindings[h]);
    ASSERT_EQ(grown.size(), sent.hairs.verticesOf(h));
    for (size_t j = 0; j < grown.size(); ++j)
      worst = std::max(worst, (grown[j].position - sent.hairs.strand(h)[j].cast<double>()).norm());
  }
  EXPECT_LE(worst, 1.001 * static_cast<double>(kDefaultHairError));
  const double each = static_cast<double>(bytes) / static_cast<double>(got.hairs.strands());
  EXPECT_LT(each, 50) << "bytes a hair";
  std::printf("%zu hairs, %zu guides: %.1f B a hair, %zu chunks, worst %.4f mm\n", got.hairs.strands(),
              guides.strands(), each, chunks.size(), 1e3 * worst);
}

INSTANTIATE_TEST_SUITE_P(Grooms, RealHairs,
                         testing::Values(std::vector<std::string>{"sintel/sintel_hair_16pts.tfx"},
                                         std::vector<std::string>{"ponytail/tail.tfx", "ponytail/side.tfx",
                                                                  "ponytail/front_top.tfx",
                                                                  "ponytail/back.tfx"}));

}  // namespace
}  // namespace strandcast
