#include <gtest/gtest.h>

#include "core/backend.h"
#include "simd/simd_backend.h"
#include "tests/thorough.h"
#include "validation/suite.h"

namespace strandcast {
namespace {

const Laboratory kLaboratory(makeReferenceBackend, SolverKind::kRod);

void expectPasses(const Laboratory& laboratory, std::initializer_list<const char*> experiments) {
  for (const char* only : experiments)
    for (const Case& c : runSuite(validationSuite("contact"), laboratory, only))
      EXPECT_TRUE(c.passed) << c.name << ": " << c.error << ' ' << c.error_unit;
}

TEST(ContactSuite, TheRodPassesInLanes) {
  expectPasses(Laboratory([] { return makeSimdBackend(0); }, SolverKind::kRod),
               {"slope", "capstan", "energy", "dropped on a sphere", "stick-slip", "dropped on a mesh",
                "mesh tilted", "head shaken", "hand through"});
}

TEST(ContactSuite, TheRodPasses) {
  if (!thorough()) GTEST_SKIP() << kSkippedUnlessThorough;
  expectPasses(kLaboratory, {"slope", "capstan", "energy", "dropped on a sphere"});
}

TEST(ContactSuite, NoStrandPassesThroughAFastPlate) {
  for (const Case& c : runSuite(validationSuite("tunnel"), kLaboratory, "tilt=0")) {
    EXPECT_EQ(c.measured, 0) << c.name;
  }
}

}  // namespace
}  // namespace strandcast
