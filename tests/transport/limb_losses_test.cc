// Simulated fur on an arm that bends as fast as a walker's limbs, sent over a link that loses chunks:
// measures the error of concealed strands. docs/architecture.md has the numbers.
#include "transport/concealment.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <random>

#include "sample_messages.h"
#include "service/colliders.h"
#include "tests/scenes/furry_arm.h"
#include "transport/assembler.h"
#include "transport/body_binding.h"

namespace strandcast {
namespace {

/// The frames of a daemon at 60 Hz, and their chunks.
struct Cast {
  std::shared_ptr<const GroomDescription> groom;
  std::shared_ptr<const ColliderSet> colliders;
  std::vector<GuideFrame> frames;
  std::vector<std::vector<GuideChunk>> chunks;
  std::vector<std::array<Vec3, 2>> corners;  // of each part at rest, m
};

/// The strands of each chunk are spread over the arm, as in most files. The arm bends by 60 degrees and back
/// twice a second. The fixed joint is the head.
Cast furryLimb() {
  constexpr double kStart = 0.5, kSeconds = 1.5;  // s; the clip begins from rest
  const ScratchFolder folder;
  std::vector<std::vector<Vec3>> strands = fur(3000, -0.02f, 0.52f, 0.04f, 0.04f);
  std::shuffle(strands.begin(), strands.end(), std::minstd_rand(5));
  writeStrands(folder / "hair.obj", strands);
  SceneOptions options = bendingArm(folder, UpAxis::kY);
  samples::ArmOptions arm;
  arm.seconds = 0.25f;
  arm.interpolation = "CUBICSPLINE";
  writeFileBytes(folder / "arm.glb", samples::armGlb(arm));
  const Scene scene = makeScene(options);
  Simulation simulation = simulated(scene);
  auto groom = std::make_shared<GroomDescription>();
  groom->groom_id = 1;
  groom->session = 11;
  groom->guides = scene.groom.strands;
  auto colliders = std::make_shared<ColliderSet>();
  colliders->groom_id = 1;
  colliders->session = 11;
  colliders->revision = 1;
  colliders->colliders = collidersOf(simulation);
  Cast cast{groom, colliders, {}, {}, {}};
  for (const BodyPart& part : bodyParts(*colliders)) {
    const FieldGrid& grid = part.field->grid;
    cast.corners.push_back({samplePosition(grid, 0, 0, 0),
                            samplePosition(grid, kBrickCells * grid.bricks[0], kBrickCells * grid.bricks[1],
                                           kBrickCells * grid.bricks[2])});
  }
  while (simulation.time() < kStart + kSeconds) {
    stepWith(scene, simulation);
    simulation.resetDiverged();
    if (simulation.time() < kStart) continue;
    GuideFrame& frame = cast.frames.emplace_back();
    frame.groom_id = 1;
    frame.session = 11;
    frame.frame = cast.frames.size();
    frame.simulation_time = simulation.time();
    frame.head = simulation.headPose();
    frame.positions.assign(simulation.guides().begin(), simulation.guides().end());
    frame.colliders = placedColliders(simulation);
    cast.chunks.push_back(splitFrame(*groom, frame));
  }
  return cast;
}

using Lost = std::function<bool(size_t frame, size_t chunk)>;

/// m: error of concealed strands, over their vertices and over their roots.
struct Off {
  double mean = 0, most = 0, roots = 0;
  double limb = 0;  ///< largest error of the parts' corners
};

Off offWhere(const Cast& cast, const Lost& lost) {
  GuideAssembler assembler(true);
  assembler.setGroom(cast.groom);
  assembler.setColliders(cast.colliders);
  Off off;
  size_t vertices = 0, strands = 0;
  const StrandSet& guides = cast.groom->guides;
  const auto look = [&](const GuideFrame& shown) {
    const size_t f = shown.frame - 1;
    const GuideFrame& sent = cast.frames[f];
    for (size_t i = 0; i < sent.colliders.size(); ++i) {
      for (const Vec3& corner : cast.corners[i]) {
        const Vec3 way = shown.colliders.at(i).pose.apply(corner) - sent.colliders[i].pose.apply(corner);
        off.limb = std::max(off.limb, static_cast<double>(way.norm()));
      }
    }
    for (const GuideChunk& chunk : cast.chunks[f]) {
      if (!lost(f, chunk.chunk_index)) continue;
      for (uint32_t s = chunk.first_strand; s < chunk.first_strand + chunk.strand_count; ++s, ++strands) {
        for (uint32_t v = guides.offsets[s]; v < guides.offsets[s + 1]; ++v, ++vertices) {
          const auto error = static_cast<double>((shown.positions[v] - sent.positions[v]).norm());
          off.mean += error;
          off.most = std::max(off.most, error);
          off.roots += v == guides.offsets[s] ? error : 0;
        }
      }
    }
  };
  for (size_t f = 0; f < cast.frames.size(); ++f) {
    for (size_t c = 0; c < cast.chunks[f].size(); ++c) {
      if (lost(f, c)) continue;
      for (const auto& shown : {assembler.add(cast.chunks[f][c]), assembler.concealOverdue()})
        if (shown) look(*shown);
    }
  }
  off.mean /= static_cast<double>(vertices);
  off.roots /= static_cast<double>(strands);
  return off;
}

Off report(const Cast& cast, const char* what, const Lost& lost) {
  const Off off = offWhere(cast, lost);
  std::printf("%s: %.2f mm in the mean, %.1f at most; roots %.3f; the limb %.1f at most\n", what,
              1e3 * off.mean, 1e3 * off.most, 1e3 * off.roots, 1e3 * off.limb);
  return off;
}

class LimbLosses : public ::testing::Test {
 protected:
  static const Cast& cast() {
    static const Cast made = furryLimb();
    return made;
  }
  /// Loses one chunk of `frames` consecutive frames, repeatedly.
  static Lost inARow(size_t frames, size_t chunk) {
    return [=](size_t f, size_t c) { return c == chunk && f > 5 && f % (frames + 5) < frames; };
  }
};

TEST_F(LimbLosses, AFrameOfAChunkIsHardlySeen) {
  for (const size_t chunk : {0, 1}) {
    const Off off = report(cast(), chunk == 0 ? "1 frame, chunk 0" : "1 frame", inARow(1, chunk));
    EXPECT_LT(off.mean, 0.3e-3) << "m";
    EXPECT_LT(off.roots, 0.05e-3);
    EXPECT_LT(off.limb, 2e-3);
  }
}

TEST_F(LimbLosses, FurThatIsLostForLongStaysOnTheLimb) {
  for (const size_t frames : {3, 6, 12, 30}) {
    for (const size_t chunk : {0, 1}) {
      const std::string what = std::to_string(frames) + " frames" + (chunk == 0 ? ", chunk 0" : "");
      const Off off = report(cast(), what.c_str(), inARow(frames, chunk));
      EXPECT_LT(off.mean, 2e-3) << "m; " << what;
      EXPECT_LT(off.roots, 0.5e-3) << what;
      EXPECT_LT(off.most, 40e-3) << "what the strands themselves, 40 mm long, are off: " << what;
      EXPECT_LT(off.limb, 5e-3) << what;
    }
  }
}

TEST_F(LimbLosses, AnyChunks) {
  for (const double rate : {0.05, 0.3}) {
    std::mt19937 random(3);
    std::vector<std::vector<bool>> drop(cast().frames.size(), std::vector<bool>(cast().chunks[0].size()));
    for (size_t f = 5; f < drop.size(); ++f)
      for (size_t c = 0; c < drop[f].size(); ++c)
        drop[f][c] = std::uniform_real_distribution<double>()(random) < rate;
    const Off off = report(cast(), rate < 0.1 ? "5 % of chunks" : "30 % of chunks",
                           [&](size_t f, size_t c) { return bool(drop[f][c]); });
    EXPECT_LT(off.mean, 0.5e-3) << "m";
    EXPECT_LT(off.roots, 0.1e-3);
  }
}

}  // namespace
}  // namespace strandcast
