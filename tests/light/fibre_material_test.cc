#include "light/fibre_material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/expect_error.h"

namespace strandcast {
namespace {

std::string refusalOf(const FibreMaterial& material) {
  return errorOf([&] { checkFibreMaterial(material, "here"); });
}

TEST(FibreMaterial, ValuesOutOfRangeAreRefusedInOneLine) {
  EXPECT_EQ(refusalOf({}), "");
  FibreMaterial material;
  material.sigma_a[1] = -0.5;
  EXPECT_EQ(refusalOf(material),
            "absorption per radius (sigma_a) is -0.5: here; give a number from 0 to 1000");
  for (const double bad :
       {-1.0, 1e4, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (double FibreMaterial::*member :
         {&FibreMaterial::longitudinal_roughness, &FibreMaterial::azimuthal_roughness, &FibreMaterial::tilt,
          &FibreMaterial::index, &FibreMaterial::axis_ratio}) {
      FibreMaterial wrong;
      wrong.*member = bad;
      EXPECT_NE(refusalOf(wrong), "") << bad;
    }
    FibreMaterial wrong;
    wrong.sigma_a[2] = bad;
    EXPECT_NE(refusalOf(wrong), "") << bad;
  }
  material = {};
  material.azimuthal_roughness = 0;
  EXPECT_EQ(refusalOf(material), "azimuthal roughness is 0: here; give a number from 0.001 to 1");
}

TEST(FibreMaterial, DefaultsAreBrownHair) {
  EXPECT_TRUE(FibreMaterial{}.sigma_a.isApprox(absorptionOfMelanin(1.3, 0), 1e-4));
  EXPECT_TRUE(fibrePreset("brown").sigma_a.isApprox(absorptionOfMelanin(1.3, 0)));
}

TEST(FibreMaterial, EveryPresetIsValidAndTheirColoursAreInOrder) {
  for (const std::string& name : fibrePresetNames()) EXPECT_EQ(refusalOf(fibrePreset(name)), "") << name;
  double last = std::numeric_limits<double>::infinity();
  for (const char* name : {"black", "brown", "dark_blond", "light_blond", "white"}) {
    const double sigma = fibrePreset(name).sigma_a.mean();
    EXPECT_LT(sigma, last) << name;
    last = sigma;
  }
  const Eigen::Array3d grey = fibrePreset("grey").sigma_a;
  EXPECT_LT(grey.maxCoeff() / grey.minCoeff(), 1.1);
  expectError([] { fibrePreset("purple"); }, {"unknown hair material 'purple'", "light_blond"});
}

TEST(FibreMaterial, ReflectanceIsInvertedByThePublishedFit) {
  // ln(0.5) / (5.969 - 0.215 b + 2.532 b^2 - 10.73 b^3 + 5.574 b^4 + 0.245 b^5) at b = 0.5, by hand.
  const double scale = 5.969 - 0.1075 + 0.633 - 1.34125 + 0.348375 + 0.00765625;
  EXPECT_NEAR(absorptionOfReflectance({0.5, 0.5, 0.5}, 0.5)[0], std::pow(std::log(0.5) / scale, 2), 1e-12);
  const Eigen::Array3d ends = absorptionOfReflectance({0, 1, 1e-3}, 0.3);
  EXPECT_EQ(ends[0], 1000);
  EXPECT_EQ(ends[1], 0);
  EXPECT_GT(ends[2], 1);
  EXPECT_THROW(absorptionOfReflectance({0.5, -0.1, 0.5}, 0.3), Error);
  EXPECT_THROW(absorptionOfMelanin(std::numeric_limits<double>::quiet_NaN(), 0), Error);
  EXPECT_THROW(absorptionOfMelanin(0, 21), Error);
}

}  // namespace
}  // namespace strandcast
