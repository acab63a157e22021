// Real grooms and bodies, if available: in STRANDCAST_DATA, or in a folder shared/data beside the project.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "core/strand_model.h"
#include "groom/bound_growth.h"
#include "groom/groom.h"
#include "groom/groom_operations.h"
#include "groom/hair_binding.h"
#include "io/mesh_file.h"
#include "tests/io/scratch_folder.h"
#include "tests/real_data.h"

namespace strandcast {
namespace {

class RealGrooms : public testing::Test {
 protected:
  void SetUp() override {
    data_ = dataFolder();
    if (!std::filesystem::is_directory(data_))
      GTEST_SKIP() << "no real data at " << data_ << "; set STRANDCAST_DATA";
  }
  std::vector<std::filesystem::path> ponytail() const {
    std::vector<std::filesystem::path> files;
    for (const char* part : {"tail", "side", "front_top", "back"})
      files.push_back(data_ / "ponytail" / (std::string(part) + ".tfx"));
    return files;
  }
  std::filesystem::path data_;
};

TEST_F(RealGrooms, PonytailHasItsFourPartsAndPinnedBack) {
  const Groom groom = loadGroom(ponytail(), {0.0025f, UpAxis::kAuto});
  EXPECT_EQ(groom.report.strands_read, 517u + 876 + 3066 + 474);
  EXPECT_EQ(groom.report.dropped_short, 0u);
  EXPECT_EQ(groom.report.both_ends_pinned, 517u);
  EXPECT_EQ(std::count(groom.strands.parts.begin(), groom.strands.parts.end(), 1), 3066);
  const GroomSummary summary = summarize(groom.strands);
  EXPECT_EQ(summary.min_vertices, 16u);
  EXPECT_EQ(summary.max_vertices, 16u);
  EXPECT_NEAR(summary.bounds.sizes().y(), 0.3171f, 1e-3f);
  EXPECT_NO_THROW(makeStrandModel(groom.strands));
  const Groom guessed = loadGroom(ponytail(), {});
  EXPECT_EQ(guessed.report.unit_meters, 0.0025f);
  EXPECT_EQ(guessed.report.warnings.size(), 1u);
}

TEST_F(RealGrooms, SintelHas11400StrandsInMetres) {
  const Groom groom = loadGroom({data_ / "sintel" / "sintel_hair_16pts.tfx"}, {});
  EXPECT_EQ(groom.strands.strands(), 11400u);
  EXPECT_EQ(groom.report.unit_meters, 1.0f);
  EXPECT_EQ(groom.report.both_ends_pinned, 0u);
  EXPECT_NO_THROW(makeStrandModel(groom.strands));
}

TEST_F(RealGrooms, HairsBoundToATwentiethOfThemKeepTheirRestShapeAndTheirPart) {
  const Groom groom = loadGroom(ponytail(), {0.0025f, UpAxis::kAuto});
  const StrandSet guides = subset(groom.strands, chooseGuides(groom.strands, groom.strands.strands() / 20));
  const std::vector<HairBinding> bindings = bindHairs(groom.strands, guides);
  const BoundHairReference reference(guides, guides.positions, std::vector<Pose>(guides.strands()), 32);
  double worst = 0;
  size_t blended = 0;
  for (size_t s = 0; s < bindings.size(); ++s) {
    const std::span<const Vec3> hair = groom.strands.strand(s);
    const auto grown = reference.grow(hair, bindings[s]);
    for (size_t j = 0; j < hair.size(); ++j)
      worst = std::max(worst, (grown[j].position - hair[j].cast<double>()).norm());
    for (const uint32_t g : bindings[s].guides) EXPECT_EQ(guides.parts[g], groom.strands.parts[s]) << s;
    blended += bindings[s].weights[1] > 0;
  }
  EXPECT_LT(worst, 1e-9);
  EXPECT_GT(blended, bindings.size() * 9 / 10);
}

TEST_F(RealGrooms, BearLosesItsShortStrandsAndKeepsTheRest) {
  const RawGroom raw = readRawGroom(data_ / "bear" / "bear.tfx");
  EXPECT_EQ(raw.strands.strands(), 48113u);
  EXPECT_EQ(summarize(raw.strands).degenerate_strands, 270u);
  const Groom groom = loadGroom({data_ / "bear" / "bear.tfx"}, {0.01f, UpAxis::kAuto});
  EXPECT_EQ(groom.report.dropped_short, 270u);
  EXPECT_EQ(groom.strands.strands(), 48113u - 270);
  EXPECT_NO_THROW(makeStrandModel(groom.strands));
}

TEST_F(RealGrooms, FiveThousandGuidesOfTheBearCoverIt) {
  const Groom groom = loadGroom({data_ / "bear" / "bear.tfx"}, {0.01f, UpAxis::kAuto});
  const std::vector<uint32_t> guides = chooseGuides(groom.strands, 5000);
  ASSERT_EQ(guides.size(), 5000u);
  // Property of farthest point sampling: no two guides are nearer to each other than any root is to its
  // nearest guide.
  double nearest = 1e9;
  for (size_t a = 0; a < guides.size(); ++a)
    for (size_t b = 0; b < a; ++b)
      nearest = std::min<double>(
          nearest, (groom.strands.strand(guides[a])[0] - groom.strands.strand(guides[b])[0]).norm());
  double worst = 0;
  for (size_t s = 0; s < groom.strands.strands(); s += 7) {
    double to_guide = 1e9;
    for (const uint32_t g : guides)
      to_guide = std::min<double>(to_guide, (groom.strands.strand(s)[0] - groom.strands.strand(g)[0]).norm());
    worst = std::max(worst, to_guide);
  }
  EXPECT_GT(nearest, 0);
  EXPECT_LE(worst, nearest * 1.0001);
}

TEST_F(RealGrooms, CurlsHaveTheirMixedCounts) {
  for (const char* frame : {"frame_00.obj", "frame_70.obj"}) {
    const RawGroom raw = readRawGroom(data_ / "curls" / frame);
    const GroomSummary summary = summarize(raw.strands);
    EXPECT_EQ(summary.strands, 98u);
    EXPECT_EQ(summary.vertices, 10589u);
    EXPECT_EQ(summary.min_vertices, 93u);
    EXPECT_EQ(summary.max_vertices, 123u);
    const Groom groom = loadGroom({data_ / "curls" / frame}, {0.01f, UpAxis::kAuto});
    EXPECT_EQ(groom.strands.strands(), 98u);
    EXPECT_NO_THROW(makeStrandModel(groom.strands));
  }
}

TEST_F(RealGrooms, TfxToHairToTfxIsBitEqual) {
  const ScratchFolder folder;
  std::vector<std::filesystem::path> files = ponytail();
  files.push_back(data_ / "sintel" / "sintel_hair_16pts.tfx");
  files.push_back(data_ / "bear" / "bear.tfx");
  for (const auto& file : files) {
    const RawGroom first = readRawGroom(file);
    const auto copied = [&](const RawGroom& groom, const char* name) {
      writeGroom(folder / name, groom.strands, groom.native_up);
      return readRawGroom(folder / name);
    };
    const RawGroom turned = copied(first, "a.hair"), second = copied(turned, "b.tfx"),
                   again = copied(turned, "c.hair");
    for (const auto& [one, other] : {std::pair{&first, &second}, std::pair{&turned, &again}}) {
      const StrandSet &a = one->strands, &b = other->strands;
      ASSERT_EQ(a.offsets, b.offsets) << file;
      EXPECT_EQ(std::memcmp(a.positions.data(), b.positions.data(), 12 * a.vertices()), 0) << file;
    }
  }
}

TEST_F(RealGrooms, BodiesLoadWithAllTheirTriangles) {
  struct Body {
    const char* file;
    float unit;
    size_t vertices, triangles;
  };
  // The counts are those of `v` and `f` lines of the files; for makehuman, without helper and joint groups,
  // in quads.
  for (const Body& body :
       {Body{"bear/bear_body.obj", 0.01f, 31175, 57784},
        Body{"ponytail/ponytail_body.obj", 0.0025f, 11744, 17894},
        Body{"sintel/sintel-collider.obj", 1, 341, 678}, Body{"sintel/sintel.obj", 1, 3046, 5952},
        Body{"makehuman/base.obj", 0.1f, 13380, 26756}}) {
    const TriangleMesh mesh = loadMesh(data_ / body.file, {body.unit, UpAxis::kAuto}).mesh;
    EXPECT_EQ(mesh.positions.size(), body.vertices) << body.file;
    EXPECT_EQ(mesh.triangles.size(), body.triangles) << body.file;
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  }
}

TEST_F(RealGrooms, FoxLoadsFromGlb) {
  const TriangleMesh fox = loadMesh(data_ / "motion" / "Fox.glb", {0.01f, UpAxis::kAuto}).mesh;
  EXPECT_EQ(fox.triangles.size(), 576u);
  EXPECT_EQ(fox.positions.size(), 1728u);
  EXPECT_GT(fox.bounds().sizes().z(), 1.0f);
  EXPECT_LT(fox.bounds().sizes().z(), 2.0f);
}

}  // namespace
}  // namespace strandcast
