// Grids of a simulation as a recording stores them.
#include "service/recorded_air.h"

#include <gtest/gtest.h>

namespace strandcast {
namespace {

/// Linear fields, which interpolation reproduces exactly.
class SlantedAir final : public AirFields {
 public:
  SlantedAir(bool has_density, bool has_wind) : has_density_(has_density), has_wind_(has_wind) {}
  bool hasDensity() const override { return has_density_; }
  bool hasWind() const override { return has_wind_; }
  Box box() const override { return {Vec3(-1, 0, 2), Vec3(3, 4, 6)}; }
  float cell() const override { return 0.25f; }
  AirSample at(const Vec3& p) const override {
    AirSample out;
    if (has_density_) out.density = 5 + p.x() - 0.5f * p.z();
    if (!has_wind_) return out;
    out.wind = Vec3(p.y(), 2 * p.z(), 1 - p.x());
    out.solid = p.y() > 3;
    out.pressure = p.x() * p.y();
    out.divergence = p.z();
    return out;
  }

 private:
  const bool has_density_, has_wind_;
};

TEST(RecordedAirTest, IsWhatWasThere) {
  const SlantedAir air(true, true);
  const AirGrids grids = gridsOf(air);
  EXPECT_TRUE(isSound(grids));
  EXPECT_EQ(grids.cells, 16u);
  const RecordedAir recorded(grids);
  EXPECT_TRUE(recorded.hasDensity() && recorded.hasWind());
  EXPECT_EQ(recorded.box().min(), air.box().min());
  EXPECT_EQ(recorded.box().max(), air.box().max());
  for (const Vec3& point : {Vec3(0.1f, 1.3f, 4), Vec3(-0.8f, 0.2f, 2.2f), Vec3(2.8f, 3.7f, 5.8f)}) {
    const AirSample is = recorded.at(point), was = air.at(point);
    EXPECT_LT((is.wind - was.wind).norm(), 1e-5f);
    EXPECT_EQ(is.solid, was.solid);
    Vec3 middle = point;
    for (int c = 0; c < 3; ++c) middle[c] = 0.25f * (std::floor(point[c] / 0.25f) + 0.5f);
    EXPECT_NEAR(is.density, air.at(middle).density, 1e-5f);
    EXPECT_NEAR(is.pressure, air.at(middle).pressure, 1e-5f);
    EXPECT_NEAR(is.divergence, air.at(middle).divergence, 1e-5f);
  }
  EXPECT_EQ(recorded.at(Vec3(9, 9, 9)).density, 0) << "beyond the box";
}

TEST(RecordedAirTest, HoldsWhatIsOnAGridOnly) {
  const AirGrids hair = gridsOf(SlantedAir(true, false)), wind = gridsOf(SlantedAir(false, true));
  EXPECT_TRUE(isSound(hair) && isSound(wind));
  EXPECT_TRUE(RecordedAir(hair).hasDensity() && !RecordedAir(hair).hasWind());
  EXPECT_TRUE(!RecordedAir(wind).hasDensity() && RecordedAir(wind).hasWind());
  EXPECT_EQ(RecordedAir(hair).at(Vec3(0, 1, 3)).wind, Vec3(Vec3::Zero()));
  EXPECT_EQ(RecordedAir(wind).at(Vec3(0, 1, 3)).density, 0);
}

}  // namespace
}  // namespace strandcast
