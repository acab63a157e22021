// Runs the fuzzers' entry points on thousands of seeded damages of small valid files: flipped bits, replaced
// bytes and words, cut ends, spliced pieces of two files, repeated pieces. A violated invariant aborts
// (reader_checks.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "tests/io/gltf_builder.h"
#include "tests/io/reader_checks.h"
#include "tests/io/sample_files.h"
#include "tests/io/skinned_arm.h"

namespace strandcast {
namespace {

using samples::Bytes;

constexpr int kDamages = 4000;

class Damager {
 public:
  explicit Damager(std::vector<Bytes> files) : files_(std::move(files)), random_(20240229) {}

  Bytes next() {
    Bytes bytes = files_[below(files_.size())];
    for (size_t times = 1 + below(4); times > 0; --times) damage(bytes);
    return bytes;
  }

 private:
  size_t below(size_t end) { return end == 0 ? 0 : random_() % end; }

  void damage(Bytes& bytes) {
    if (bytes.empty()) return;
    const size_t at = below(bytes.size());
    switch (below(7)) {
      case 0:
        bytes[at] ^= static_cast<std::byte>(1u << below(8));
        break;
      case 1:
        bytes[at] = static_cast<std::byte>(below(256));
        break;
      case 2:
        overwriteWord(bytes);
        break;
      case 3:
        bytes.resize(at);
        break;
      case 4:
        splice(bytes, at);
        break;
      case 5:
        repeat(bytes, at);
        break;
      case 6:
        std::swap(bytes[at], bytes[below(bytes.size())]);
        break;
    }
  }

  /// Replaces an aligned 32-bit word, often in the header, by a value likely to break arithmetic.
  void overwriteWord(Bytes& bytes) {
    constexpr std::array<uint32_t, 12> kWords{0,          1,          4,          159,
                                              0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0xFFFFFFF0,
                                              0x7FC00000, 0x7F800000, 0x10000000, 65536};
    if (bytes.size() < 4) return;
    const size_t words = below(2) == 0 ? std::min<size_t>(bytes.size() / 4, 8) : bytes.size() / 4;
    samples::overwrite(bytes, 4 * below(words), kWords[below(kWords.size())]);
  }

  void splice(Bytes& bytes, size_t at) {
    const Bytes& other = files_[below(files_.size())];
    bytes.resize(at);
    bytes.insert(bytes.end(), other.begin() + static_cast<std::ptrdiff_t>(below(other.size())), other.end());
  }

  void repeat(Bytes& bytes, size_t at) {
    const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const Bytes piece(first,
                      first + static_cast<std::ptrdiff_t>(below(std::min<size_t>(bytes.size() - at, 64))));
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size())), piece.begin(),
                 piece.end());
  }

  std::vector<Bytes> files_;
  std::mt19937 random_;
};

/// Each sample is accepted. Of its damaged versions some are refused and some accepted, otherwise the damage
/// would test nothing.
template <class Check>
void expectDamageIsTolerated(Check check, const std::vector<Bytes>& files) {
  for (const Bytes& file : files) EXPECT_TRUE(check(file));
  Damager damager(files);
  int accepted = 0;
  for (int i = 0; i < kDamages; ++i) accepted += check(damager.next()) ? 1 : 0;
  EXPECT_GT(accepted, kDamages / 100);
  EXPECT_LT(accepted, kDamages * 99 / 100);
  testing::Test::RecordProperty("accepted", accepted);
}

TEST(DamagedFiles, Tfx) {
  expectDamageIsTolerated(checkTfxReader, {samples::tfx3(), samples::tfx3(true), samples::tfx4()});
}
TEST(DamagedFiles, Hair) {
  expectDamageIsTolerated(checkHairReader, {samples::hair(), samples::hairDefaultSegments()});
}
TEST(DamagedFiles, ObjStrands) { expectDamageIsTolerated(checkObjStrandsReader, {samples::objStrands()}); }
TEST(DamagedFiles, Usda) {
  expectDamageIsTolerated(checkUsdaReader, {samples::usda(), samples::usdaStage(), samples::usdaLabels()});
}
TEST(DamagedFiles, ObjMesh) { expectDamageIsTolerated(checkObjMeshReader, {samples::objMesh()}); }
TEST(DamagedFiles, Sdf) { expectDamageIsTolerated(checkSdfReader, {samples::sdf()}); }
TEST(DamagedFiles, Gltf) {
  expectDamageIsTolerated(checkGltfReader, {samples::glb(), samples::gltf(), samples::gltfOfAllKinds()});
}
TEST(DamagedFiles, GltfSkin) {
  samples::ArmOptions cubic = samples::smallArm();
  cubic.interpolation = "CUBICSPLINE";
  samples::ArmOptions swelling = samples::smallArm();
  swelling.bulge = 0.05f;
  swelling.bulge_at_rest = 0.5f;
  expectDamageIsTolerated(checkGltfSkinReader, {samples::armGlb(samples::smallArm()), samples::armGltf(cubic),
                                                samples::armGltf(swelling)});
}

}  // namespace
}  // namespace strandcast
