#include "scenes/part_rules.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/expect_error.h"

namespace strandcast {
namespace {

std::string errorOf(const std::string& name, const std::vector<double>& values) {
  return strandcast::errorOf([&] {
    Material material;
    setMaterial(material, name, values, "hair.toml line 7");
  });
}

TEST(PartMaterials, RulesChangeTheirPartsInOrder) {
  const std::vector<MaterialRule> rules = {{{}, {{"density", {1500}, "a"}}, "a"},
                                           {{"tail", "2"}, {{"radius", {5e-5}, "b"}}, "b"},
                                           {{"tail"}, {{"density", {900}, "c"}}, "c"}};
  const std::vector<Material> materials = partMaterials(rules, {"cap", "tail", "fringe"});
  ASSERT_EQ(materials.size(), 3u);
  EXPECT_EQ(materials[0].density, 1500);
  EXPECT_EQ(materials[1].density, 900);
  EXPECT_EQ(materials[2].density, 1500);
  EXPECT_EQ(materials[0].radius, Material().radius);
  EXPECT_FLOAT_EQ(materials[1].radius, 5e-5f);
  EXPECT_FLOAT_EQ(materials[2].radius, 5e-5f);
}

TEST(PartMaterials, ASettingThatLaterRulesReplaceIsRefused) {
  const auto refusal = [](const std::vector<MaterialRule>& rules) {
    return strandcast::errorOf([&] { partMaterials(rules, {"cap", "tail"}); });
  };
  const auto rule = [](std::vector<std::string> parts, const char* name, double value,
                       bool is_option = false) {
    return MaterialRule{
        std::move(parts), {{name, {value}, is_option ? "--material" : "line 2"}}, "", is_option};
  };
  EXPECT_EQ(refusal({rule({"tail"}, "radius", 5e-5), rule({"1"}, "radius", 6e-5)}),
            "'radius' is set twice for the same hair, to different values: line 2 and line 2; leave one of "
            "them out");
  EXPECT_NE(refusal({rule({"tail"}, "radius", 5e-5), rule({}, "radius", 6e-5)}), "")
      << "all hair is tail too";
  EXPECT_NE(refusal({rule({}, "radius", 5e-5), rule({}, "radius", 6e-5)}), "");
  EXPECT_NE(refusal({rule({"cap"}, "poisson_ratio", 0.3), rule({"cap"}, "shear_modulus", 1.5e9)}), "");
  EXPECT_EQ(
      refusal({rule({}, "radius", 5e-5), rule({"cap"}, "radius", 6e-5), rule({"tail"}, "radius", 7e-5)}), "")
      << "a rule of all is what parts differ from";
  EXPECT_EQ(refusal({rule({"cap", "tail"}, "radius", 5e-5), rule({"tail"}, "radius", 6e-5)}), "")
      << "the cap has it";
  EXPECT_EQ(refusal({rule({}, "radius", 5e-5), rule({}, "radius", 5e-5)}), "") << "they say the same";
  EXPECT_EQ(refusal({rule({}, "radius", 5e-5), rule({}, "radius", 6e-5, true)}), "")
      << "options win over files";
  EXPECT_NE(refusal({rule({}, "radius", 5e-5, true), rule({}, "radius", 6e-5, true)}), "");
}

TEST(PartMaterials, AnUnknownPartIsAnErrorThatNamesThoseThereAre) {
  const std::string error = strandcast::errorOf([] {
    partMaterials({{{"tale"}, {}, "hair.toml line 3"}}, {"cap", "tail"});
  });
  EXPECT_EQ(error, "the groom has no part 'tale': hair.toml line 3; its parts are cap (0), tail (1)");
}

TEST(PartMaterials, NamesGoBeforeNumbersAndMustBeOne) {
  EXPECT_EQ(partOf("0", {"1", "0", "2"}, "a"), 1u);
  EXPECT_EQ(partOf("3", {"1", "0", "2", "x"}, "a"), 3u);
  const std::vector<std::string> names = {"cap", "tail", "cap"};
  EXPECT_EQ(partOf("2", names, "a"), 2u);
  EXPECT_EQ(strandcast::errorOf([&] { partOf("cap", names, "hair.toml line 3"); }),
            "2 parts of the groom are called 'cap': hair.toml line 3; choose by number: 0, 2");
}

TEST(PartMaterials, AShearModulusGoesWithTheYoungsModulusOfItsRule) {
  const std::vector<MaterialRule> rules = {
      {{}, {{"shear_modulus", {0.4e9}, "a"}, {"youngs_modulus", {1e9}, "a"}}, "a"}};
  EXPECT_FLOAT_EQ(partMaterials(rules, {"hair"})[0].poisson_ratio, 0.25f);
  const std::string both = strandcast::errorOf([] {
    checkRule({{}, {{"shear_modulus", {1e9}, "line 1"}, {"poisson_ratio", {0.3}, "line 2"}}, ""});
  });
  EXPECT_NE(both.find("twice: line 1"), std::string::npos) << both;
  EXPECT_NE(errorOf("shear_modulus", {1e9}).find("give 1.33333e+09 to 2e+10 Pa"), std::string::npos);
  EXPECT_EQ(errorOf("shear_modulus", {1.33333e9}), "");
  EXPECT_EQ(errorOf("shear_modulus", {2e10}), "");
}

TEST(PartMaterials, ATaperThatFloatsCannotSolveIsRefused) {
  const auto taken = [](const std::vector<double>& radii, const std::vector<double>& stiffnesses) {
    return strandcast::errorOf([&] {
      partMaterials({{{}, {{"radius_curve", radii, "a"}, {"stiffness_curve", stiffnesses, "a"}}, "a"}},
                    {"cap", "tail"});
    });
  };
  EXPECT_EQ(taken({0, 10, 1, 0.1}, {0, 10, 1, 0.1}), "");
  EXPECT_EQ(taken({0, 1, 0.5, 0.1, 1, 1}, {0, 0.001, 1, 1000}), "");
  EXPECT_EQ(taken({0, 0.1, 1, 1000}, {1}),
            "'radius_curve' makes hair 10000 times as thick at one place as at another: material of part "
            "'cap'; make its factors differ by a factor of at most 100");
  EXPECT_NE(taken({0, 1, 1, 100}, {0, 0.001, 1, 1000}).find("1e+14 times as stiff"), std::string::npos);
}

TEST(PartMaterials, MassesThatFloatsCannotSolveAreRefused) {
  const auto taken = [](const std::vector<double>& radii, const std::vector<double>& densities) {
    return strandcast::errorOf([&] {
      partMaterials({{{}, {{"radius_curve", radii, "a"}, {"density_curve", densities, "a"}}, "a"}}, {"cap"});
    });
  };
  EXPECT_EQ(taken({1}, {0, 0.1, 1, 10}), "");
  EXPECT_EQ(taken({0, 1, 1, 100}, {0, 1, 1, 0.1}), "") << "they make up for each other";
  EXPECT_EQ(taken({0, 100, 1, 1}, {0, 2, 1, 1}),
            "'radius_curve' and 'density_curve' make hair 20000 times as heavy at one place as at another: "
            "material of part 'cap'; make radius^2 x density differ by a factor of at most 10000");
  EXPECT_NE(taken({0.5, 1, 0.5, 50}, {0.5, 1, 0.5, 10}).find("25000 times as heavy"), std::string::npos)
      << "two jumps at one place";
}

TEST(PartMaterials, AScaleTimesItsCurveHasTheRangeOfEither) {
  const auto taken = [](double scale, const std::vector<double>& curve) {
    return strandcast::errorOf([&] {
      partMaterials({{{}, {{"friction_scale", {scale}, "a"}, {"friction_curve", curve, "a"}}, "a"}}, {"cap"});
    });
  };
  EXPECT_EQ(taken(10, {0, 0, 1, 100}), "");
  EXPECT_EQ(taken(20, {0, 0, 1, 100}),
            "'friction_scale' x 'friction_curve' is up to 2000: material of part 'cap'; give at most 1000");
}

TEST(MaterialSettings, EveryOneTakesTheLimitsOfItsRangeAndNothingBeyond) {
  for (const MaterialSettingInfo& info : materialSettingList()) {
    EXPECT_FALSE(info.help.empty()) << info.name;
    const size_t to = info.range.find(" to ");
    if (info.name == "shear_modulus") continue;  // its range depends on another setting
    const double low = std::stod(info.range.substr(0, to)), high = std::stod(info.range.substr(to + 4));
    EXPECT_EQ(errorOf(info.name, {low}), "");
    EXPECT_EQ(errorOf(info.name, {high}), "");
    for (const double bad : {low - 0.01 * std::fabs(low) - (low == 0 ? 0.01 : 0.0), 1.01 * high}) {
      const std::string error = errorOf(info.name, {bad});
      EXPECT_NE(error.find("out of range: hair.toml line 7"), std::string::npos) << info.name << " " << error;
    }
    EXPECT_NE(errorOf(info.name, {std::numeric_limits<double>::quiet_NaN()}).find("not finite"),
              std::string::npos);
    EXPECT_NE(errorOf(info.name, {}), "");
    EXPECT_NE(errorOf(info.name, {low, low, low}), "");
    EXPECT_EQ(errorOf(info.name, {0, low, 1, high}) == "", info.curve) << info.name;
  }
  EXPECT_EQ(errorOf("raduis", {1}),
            "unknown material setting 'raduis': hair.toml line 7; did you mean 'radius'?");
}

TEST(MaterialSettings, ACurveIsGivenByItsKnots) {
  Material material;
  setMaterial(material, "radius_curve", {0, 1, 0.5, 0.8, 1, 0.4}, "test");
  EXPECT_FLOAT_EQ(material.radius_scale.at(0.25f), 0.9f);
  EXPECT_FLOAT_EQ(material.radius_scale.at(0.75f), 0.6f);
  setMaterial(material, "radius_curve", {0.5}, "test");
  EXPECT_FLOAT_EQ(material.radius_scale.at(0.75f), 0.5f);
  EXPECT_NE(errorOf("radius_curve", {1, 1, 0, 1}).find("places in order"), std::string::npos);
  EXPECT_NE(errorOf("radius_curve", {0, 1, 1.5, 1}).find("places in order"), std::string::npos);
  for (const std::vector<double>& knots :
       {std::vector<double>{0, 1, 0, 0.5}, {0, 1, 1, 0.5, 1, 0.4}, {0.5, 1, 0.5, 0.8, 0.5, 0.4}})
    EXPECT_NE(errorOf("radius_curve", knots).find("more than it can use"), std::string::npos);
  EXPECT_EQ(errorOf("radius_curve", {0.5, 1, 0.5, 0.4}), "") << "a step";
}

}  // namespace
}  // namespace strandcast
