#include "core/parameters.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

std::string errorOfParameter(const std::string& name, const std::vector<double>& value) {
  Parameters parameters;
  return errorOf([&] { setParameter(parameters, name, value, "config.toml:7"); });
}

TEST(Parameters, EveryOneCanBeReadAndSetAgain) {
  EXPECT_GE(parameterList().size(), 9u);
  for (const ParameterInfo& info : parameterList()) {
    Parameters parameters;
    const std::vector<double> value = parameter(parameters, info.name);
    ASSERT_EQ(value.size(), static_cast<size_t>(info.components)) << info.name;
    setParameter(parameters, info.name, value, "test");
    EXPECT_EQ(parameter(parameters, info.name), value) << info.name;
    EXPECT_FALSE(info.help.empty() || info.range.empty()) << info.name;
  }
}

TEST(Parameters, SettingOneChangesThatOneOnly) {
  Parameters parameters;
  setParameter(parameters, "wind", {1, 2, 3}, "test");
  setParameter(parameters, "substeps", {7}, "test");
  EXPECT_EQ(parameters.wind, Vec3(1, 2, 3));
  EXPECT_EQ(parameters.substeps, 7);
  EXPECT_EQ(parameters.iterations, Parameters().iterations);
  EXPECT_EQ(parameters.gravity, Parameters().gravity);
}

TEST(Parameters, WhatIsOfTheMaterialIsSaidToBe) {
  EXPECT_NE(errorOfParameter("youngs_modulus", {1e9}).find("--material all:youngs_modulus=VALUE"),
            std::string::npos);
}

TEST(Parameters, TheLimitsOfTheRangeAreInIt) {
  EXPECT_EQ(errorOfParameter("substeps", {1}), "");
  EXPECT_EQ(errorOfParameter("substeps", {64}), "");
  EXPECT_EQ(errorOfParameter("time_step", {1.0 / 30}), "");
  EXPECT_EQ(errorOfParameter("time_step", {1.0 / 2000}), "");
  EXPECT_EQ(errorOfParameter("air_drag", {0}), "");
}

TEST(Parameters, AnUnknownNameIsAnErrorThatNamesTheNearest) {
  const std::string error = errorOfParameter("air_darg", {1});
  EXPECT_NE(error.find("air_darg"), std::string::npos) << error;
  EXPECT_NE(error.find("config.toml:7"), std::string::npos) << error;
  EXPECT_NE(error.find("did you mean 'air_drag'"), std::string::npos) << error;
  EXPECT_THROW(parameter(Parameters(), "air_darg"), Error);
  for (const char* far : {"foo", "", "temperature"}) {
    const std::string none = errorOfParameter(far, {1});
    EXPECT_EQ(none.find("did you mean"), std::string::npos) << none;
    EXPECT_NE(none.find("--help"), std::string::npos) << none;
  }
}

TEST(Parameters, AWrongNumberOfComponentsIsAnError) {
  EXPECT_NE(errorOfParameter("gravity", {1, 2}).find("takes 3 numbers, not 2"), std::string::npos);
  EXPECT_NE(errorOfParameter("air_drag", {}).find("takes 1 number, not 0"), std::string::npos);
}

TEST(Parameters, AValueOutOfRangeIsAnError) {
  for (const auto& [name, value] :
       std::vector<std::pair<std::string, double>>{{"substeps", 0},
                                                   {"substeps", 65},
                                                   {"substeps", 2.5},
                                                   {"iterations", -1},
                                                   {"time_step", 0},
                                                   {"time_step", 1},
                                                   {"air_drag", -0.1},
                                                   {"hair_radius", 0.5},
                                                   {"air_drag", std::numeric_limits<double>::quiet_NaN()},
                                                   {"air_drag", std::numeric_limits<double>::infinity()}}) {
    const std::string error = errorOfParameter(name, {value});
    EXPECT_NE(error.find("out of range"), std::string::npos) << name << " " << value << ": " << error;
    EXPECT_NE(error.find("config.toml:7"), std::string::npos) << error;
  }
}

TEST(Parameters, AFailedSetChangesNothing) {
  Parameters parameters;
  EXPECT_THROW(setParameter(parameters, "wind", {1, 2, 1e9}, "test"), Error);
  EXPECT_EQ(parameters.wind, Parameters().wind);
}

}  // namespace
}  // namespace strandcast
