#include "collision/field_cache.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <vector>

#include "collision/field_bake.h"
#include "core/error.h"
#include "io/mesh_file.h"
#include "tests/collision/shapes.h"
#include "tests/full_disk.h"
#include "tests/io/sample_files.h"
#include "tests/io/scratch_folder.h"

namespace strandcast {
namespace {

TEST(FieldCache, FindsWhatItKeptAndNothingElse) {
  const ScratchFolder folder;
  const FieldCache cache(folder / "new" / "fields");
  EXPECT_FALSE(cache.find(7));
  cache.keep(7, samples::field());
  cache.keep(7, samples::field());
  const auto found = cache.find(7);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->samples, samples::field().samples);
  EXPECT_FALSE(cache.find(8));
  const std::filesystem::directory_iterator files(folder / "new" / "fields");
  EXPECT_EQ(std::distance(begin(files), end(files)), 1) << "no unfinished file is left";
}

TEST(FieldCache, KeepsWhatThereWasToWarnOf) {
  const ScratchFolder folder;
  const FieldCache cache(folder.path());
  EXPECT_TRUE(cache.warnings(7).empty());
  cache.keep(7, samples::field(), {"one triangle is turned", "inside is in doubt"});
  cache.keep(8, samples::field());
  EXPECT_EQ(cache.warnings(7), (std::vector<std::string>{"one triangle is turned", "inside is in doubt"}));
  EXPECT_TRUE(cache.warnings(8).empty());
  EXPECT_TRUE(FieldCache({}).warnings(7).empty());
  const TriangleMesh ball = shapes::sphere(0.05f, 1);
  FieldOptions options;
  options.cell = 0.02f;
  const auto progress = [](const std::string&, double) { return true; };
  for (const bool from_cache : {false, true}) {
    const SceneField field = fieldOf(shapes::together(ball, ball), options, cache, progress);
    EXPECT_EQ(field.from_cache, from_cache);
    ASSERT_EQ(field.warnings.size(), 1u);
    EXPECT_NE(field.warnings[0].find("80 of 160 triangles repeat"), std::string::npos) << field.warnings[0];
  }
}

TEST(FieldCache, ADamagedOrForeignFileCountsAsNone) {
  const ScratchFolder folder;
  const FieldCache cache(folder.path());
  cache.keep(7, samples::field());
  std::filesystem::path file = folder / "0000000000000007.sdf";
  ASSERT_TRUE(std::filesystem::exists(file));
  std::filesystem::copy_file(file, folder / "0000000000000008.sdf");
  EXPECT_FALSE(cache.find(8)) << "the key within is another";
  std::filesystem::resize_file(file, 100);
  EXPECT_FALSE(cache.find(7));
  cache.keep(7, samples::field());
  EXPECT_TRUE(cache.find(7));
}

TEST(FieldCache, AFileOfWhichOneBitIsAnotherIsBakedAnewAndReplaced) {
  const ScratchFolder folder;
  const FieldCache cache(folder.path());
  const TriangleMesh ball = shapes::sphere(0.05f, 2);
  FieldOptions options;
  options.cell = 0.01f;
  const auto progress = [](const std::string&, double) { return true; };
  const DistanceField baked = fieldOf(ball, options, cache, progress).field;
  const std::filesystem::path file = std::filesystem::directory_iterator(folder.path())->path();
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  const auto at = static_cast<std::streamoff>(std::filesystem::file_size(file) / 2);
  stream.seekg(at);
  const int byte = stream.get();
  stream.seekp(at);
  stream.put(static_cast<char>(byte ^ 4));
  stream.close();
  const SceneField again = fieldOf(ball, options, cache, progress);
  EXPECT_FALSE(again.from_cache);
  EXPECT_NE(again.note.find("baked again"), std::string::npos) << again.note;
  EXPECT_NE(again.trouble.find("damaged"), std::string::npos) << again.trouble;
  EXPECT_EQ(again.field.samples, baked.samples);
  EXPECT_TRUE(fieldOf(ball, options, cache, progress).from_cache) << "it has taken the damaged one's place";
}

TEST(FieldCache, TimeAndMemoryOfABakeAreReportedFromItsBeginningOn) {
  const ScratchFolder folder;
  FieldOptions options;
  options.cell = 0.01f;
  std::vector<std::string> told;
  const auto progress = [&](const std::string& what, double) {
    if (what.find(" s, ") != std::string::npos) told.push_back(what);
    return told.empty();  // stops at once
  };
  EXPECT_THROW(fieldOf(shapes::sphere(0.05f, 2), options, FieldCache(folder.path()), progress), BakeStopped);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("about"), std::string::npos) << told[0];
  EXPECT_NE(told[0].find("MiB"), std::string::npos) << told[0];
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "told before the field is made";
}

TEST(FieldCache, ABakeIsAnnouncedBeforeItBeginsAndNotWhereTheCacheHasTheField) {
  const ScratchFolder folder;
  const FieldCache cache(folder.path());
  FieldOptions options;
  options.cell = 0.01f;
  std::vector<std::string> said;
  bool bakes = false;
  const auto progress = [&](const std::string& what, double) {
    return bakes = bakes || what.find(" s, ") != std::string::npos, true;
  };
  const BakeAnnouncement begins = [&](const std::string& estimate, double seconds) {
    EXPECT_GT(seconds, 0);
    EXPECT_FALSE(bakes);
    said.push_back(estimate);
  };
  for (int i = 0; i < 2; ++i)
    fieldOf(shapes::sphere(0.05f, 2), options, cache, progress, bakesOf(begins, "ball.obj"));
  ASSERT_EQ(said.size(), 1u);
  EXPECT_TRUE(bakes);
  EXPECT_TRUE(said[0].starts_with("ball.obj: ")) << said[0];
  EXPECT_NE(said[0].find(" s, "), std::string::npos) << said[0];
  EXPECT_NE(said[0].find("MiB"), std::string::npos) << said[0];
}

TEST(FieldCache, SeveralBakesAreAnnouncedOnceWithWhatAllTake) {
  const ScratchFolder folder;
  const FieldCache cache(folder.path());
  FieldOptions options;
  options.cell = 0.01f;
  const std::vector<TriangleMesh> balls{shapes::sphere(0.05f, 2), shapes::sphere(0.04f, 2),
                                        shapes::sphere(0.03f, 2)};
  const std::vector<NamedMesh> bodies{{"arm", &balls[0]}, {"hand", &balls[1]}, {"finger", &balls[2]}};
  const DistanceField arm = fieldOf(balls[0], options, FieldCache({}), {}).field;
  fieldOf(balls[1], options, cache, {});
  std::vector<std::string> said, shown;
  double last = 0;
  const auto bake = [&] {
    return fieldsOf(
        bodies, options, cache,
        [&](const std::string& what, double part) {
          shown.push_back(what);
          EXPECT_GE(part, last);
          EXPECT_LE(last = part, 1);
          return true;
        },
        [&](const std::string& estimate, double seconds) {
          EXPECT_GT(seconds, 0);
          said.push_back(estimate);
        });
  };
  const std::vector<SceneField> fields = bake();
  ASSERT_EQ(fields.size(), 3u);
  EXPECT_EQ(fields[0].field.samples, arm.samples);
  EXPECT_TRUE(fields[1].from_cache);
  EXPECT_FALSE(fields[2].from_cache);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_TRUE(said[0].starts_with("baking 2 of 3 distance fields takes about ")) << said[0];
  EXPECT_TRUE(shown.back().starts_with("3 of 3, finger: ")) << shown.back();
  EXPECT_GT(last, 0.1) << "beyond what preparing them is taken for";
  said.clear();
  last = 0;
  for (const SceneField& field : bake()) EXPECT_TRUE(field.from_cache);
  EXPECT_TRUE(said.empty());
}

TEST(FieldCache, WhatCannotBeWrittenIsAnError) {
  const ScratchFolder folder;
  std::ofstream(folder / "file") << "no folder";
  EXPECT_THROW(FieldCache(folder / "file").keep(7, samples::field()), Error);
}

TEST(FieldCache, AFullDiskLeavesNothing) {
  const ScratchFolder folder;
  {
    const FullDisk disk(100);
    EXPECT_THROW(FieldCache(folder.path()).keep(7, samples::field()), Error);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(FieldCache, LiesWhereTheUsersCachesLie) {
  const char* before = std::getenv("XDG_CACHE_HOME");
  const std::string kept = before != nullptr ? before : "";
  setenv("XDG_CACHE_HOME", "/somewhere", 1);
  EXPECT_EQ(defaultFieldCache(), "/somewhere/strandcast");
  setenv("XDG_CACHE_HOME", "relative", 1);
  setenv("HOME", "/home/me", 1);
  EXPECT_EQ(defaultFieldCache(), "/home/me/.cache/strandcast");
  unsetenv("HOME");
  EXPECT_THROW(defaultFieldCache(), Error);
  if (before != nullptr) setenv("XDG_CACHE_HOME", kept.c_str(), 1);
}

/// A prism with a U-shaped base of 0.2 m. Each cap is one face that begins with corner `first`, or three
/// quads.
TriangleMesh prismOfU(int first, bool of_quads) {
  std::string text;
  for (const char* z : {"0.05", "-0.05"})
    for (const char* xy : {"0.1 0.1", "0.06 0.1", "0.06 -0.06", "-0.06 -0.06", "-0.06 0.1", "-0.1 0.1",
                           "-0.1 -0.1", "0.1 -0.1"})
      text += std::string("v ") + xy + " " + z + "\n";
  const auto face = [&](std::vector<int> corners) {
    text += "f";
    for (const int corner : corners) text += " " + std::to_string(corner);
    text += "\n";
  };
  if (of_quads) {
    for (const std::vector<int>& quad : {std::vector{1, 2, 3, 8}, {3, 4, 7, 8}, {4, 5, 6, 7}}) {
      face(quad);
      face({quad[3] + 8, quad[2] + 8, quad[1] + 8, quad[0] + 8});
    }
  } else {
    std::vector<int> top, bottom;
    for (int i = 0; i < 8; ++i) {
      top.push_back((first + i) % 8 + 1);
      bottom.push_back(16 - (first + i) % 8);
    }
    face(top);
    face(bottom);
  }
  for (int i = 0; i < 8; ++i) face({i + 1, i + 9, (i + 1) % 8 + 9, (i + 1) % 8 + 1});
  return readObjMesh(samples::fromText(text), "u.obj").mesh;
}

TEST(BodyFields, AConcaveFaceHasTheFieldOfItsOutlineFromEveryCorner) {
  FieldOptions options;
  options.cell = 0.02f;
  const DistanceField quads = FieldBaker(prismOfU(0, true), options).bake({});
  EXPECT_GT(quads.at(Vec3(0, 0.05f, 0)).distance, 0.04f) << "the gap is outside";
  EXPECT_LT(quads.at(Vec3(0.08f, 0.05f, 0)).distance, -0.01f);
  for (int first = 0; first < 8; ++first) {
    const DistanceField field = FieldBaker(prismOfU(first, false), options).bake({});
    for (int n = 0; n < 6 * 6 * 6; ++n) {
      const Vec3 p(0.05f * static_cast<float>(n % 6) - 0.125f, 0.05f * static_cast<float>(n / 6 % 6) - 0.125f,
                   0.03f * static_cast<float>(n / 36) - 0.075f);
      EXPECT_NEAR(field.at(p).distance, quads.at(p).distance, 1e-5f) << first << " at " << p.transpose();
    }
  }
}

}  // namespace
}  // namespace strandcast
