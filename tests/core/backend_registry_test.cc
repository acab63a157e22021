#include "core/backend.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

BackendInfo works(const std::string& name, int score) {
  return {name, true, "a device", score, [](int) { return makeReferenceBackend(); }};
}
BackendInfo breaks(const std::string& name, int score) {
  return {name, true, "a device", score, [](int) -> std::unique_ptr<Backend> {
            throw Error("the device is gone", "device 0", "plug it in");
          }};
}
BackendInfo absent(const std::string& name, int score) {
  return {name, false, "no driver", score, [](int) -> std::unique_ptr<Backend> { return nullptr; }};
}

std::string errorOfBackend(const std::vector<BackendInfo>& known, const std::string& name) {
  return errorOf([&] { createBackend(known, name, 0); });
}

TEST(BackendRegistry, AutoTakesTheHighestScore) {
  std::string taken;
  std::vector<BackendInfo> known = {works("a", 1), works("b", 3), works("c", 2)};
  for (BackendInfo& info : known)
    info.create = [&taken, name = info.name](int) { return taken = name, makeReferenceBackend(); };
  createBackend(known, "auto", 0);
  EXPECT_EQ(taken, "b");
}

TEST(BackendRegistry, AutoFallsThroughWhatIsAbsentOrBreaks) {
  EXPECT_EQ(createBackend({works("simd", 50), absent("cuda", 200), breaks("gpu", 100)}, "auto", 0)->name(),
            "reference");
}

TEST(BackendRegistry, AutoIsAnErrorWhenNothingRuns) {
  EXPECT_NE(errorOfBackend({absent("gpu", 1), breaks("simd", 2)}, "auto").find("no backend can run"),
            std::string::npos);
  EXPECT_NE(errorOfBackend({}, "auto"), "");
}

TEST(BackendRegistry, ANamedBackendIsNeverReplaced) {
  EXPECT_NE(errorOfBackend({works("simd", 50), absent("gpu", 100)}, "gpu").find("no driver"),
            std::string::npos);
  EXPECT_NE(errorOfBackend({works("simd", 50), breaks("gpu", 100)}, "gpu").find("the device is gone"),
            std::string::npos);
}

TEST(BackendRegistry, AnUnknownNameIsAnErrorThatListsTheKnown) {
  EXPECT_NE(errorOfBackend({works("simd", 50), absent("gpu", 100)}, "gppu").find("auto, simd, gpu"),
            std::string::npos);
}

TEST(BackendRegistry, ThreadsArePassedOn) {
  int seen = 0;
  BackendInfo info = works("simd", 1);
  info.create = [&](int threads) { return seen = threads, makeReferenceBackend(); };
  createBackend({info}, "simd", 3);
  EXPECT_EQ(seen, 3);
}

}  // namespace
}  // namespace strandcast
