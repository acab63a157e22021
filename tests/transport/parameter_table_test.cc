#include "transport/parameter_table.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace strandcast {
namespace {

ParameterTable sample() { return parameterTable(NamedValues{{"wind", {1, 2, 3}}, {"speed", {0.5}}}); }

TEST(ParameterTable, TellsEveryParameterOfASimulation) {
  Parameters parameters;
  setParameter(parameters, "wind", {1, -2.5, 0.1}, "test");
  setParameter(parameters, "time_step", {1e-5}, "test");
  setParameter(parameters, "wind_seed", {999999}, "test");
  const ParameterTable table = parameterTable(parameters);
  EXPECT_TRUE(isSound(table));
  const NamedValues values = namedValues(table);
  ASSERT_EQ(values.size(), parameterList().size());
  Parameters told;
  for (const auto& [name, components] : values) setParameter(told, name, components, "what was told");
  for (const ParameterInfo& info : parameterList())
    EXPECT_EQ(parameter(told, info.name), parameter(parameters, info.name)) << info.name;
}

TEST(ParameterTable, TellsBehindThemWhatElseIsSteered) {
  ParameterTable table = sample();
  EXPECT_TRUE(appendEntry(table, "fan", "left", {1, 2}));
  EXPECT_TRUE(appendEntry(table, "collider", "a %20: b", {7}));
  EXPECT_TRUE(isSound(table));
  EXPECT_EQ(entriesOf(table, ""), namedValues(sample()));
  EXPECT_EQ(entriesOf(table, "fan"), (NamedValues{{"left", {1, 2}}}));
  EXPECT_EQ(entriesOf(table, "collider"), (NamedValues{{"a %20: b", {7}}}));
  EXPECT_TRUE(entriesOf(table, "hat").empty());
  for (int i = 0;
       appendEntry(table, "fan", std::string(50, 'x') + std::to_string(i), std::vector<double>(13)); ++i)
    ASSERT_TRUE(isSound(table)) << i;
  EXPECT_TRUE(isSound(table)) << "what does not fit any more is left out";
  ParameterTable names = sample();
  while (appendEntry(names, "fan", std::to_string(names.components.size()) + std::string(200, 'x'), {1}))
    ASSERT_TRUE(isSound(names));
  EXPECT_GT(names.names.size(), kMaxTableNameBytes - 300);
}

TEST(ParameterTable, SoundOnesHaveNamesAndValuesThatFit) {
  EXPECT_TRUE(isSound(ParameterTable()));
  EXPECT_TRUE(isSound(sample()));
  const std::function<void(ParameterTable&)> damages[] = {
      [](ParameterTable& t) { t.names = "wind"; },
      [](ParameterTable& t) { t.names = "wind speed "; },
      [](ParameterTable& t) { t.names = " wind speed"; },
      [](ParameterTable& t) { t.names = "wind  speed"; },
      [](ParameterTable& t) {
        t.names =
            "wind spe\x7f"
            "ed";
      },
      [](ParameterTable& t) { t.names = "wind sp\need"; },
      [](ParameterTable& t) { t.names = "wind wind"; },
      [](ParameterTable& t) { t.names.clear(); },
      [](ParameterTable& t) { t.components[1] = 0; },
      [](ParameterTable& t) { t.components[1] = 2; },
      [](ParameterTable& t) { t.components.pop_back(); },
      [](ParameterTable& t) { t.components.clear(); },
      [](ParameterTable& t) { t.values.push_back(1); },
      [](ParameterTable& t) { t.values.clear(); },
      [](ParameterTable& t) { t.values[2] = std::numeric_limits<float>::quiet_NaN(); },
      [](ParameterTable& t) { t.values[0] = std::numeric_limits<float>::infinity(); },
      [](ParameterTable& t) { t.names = "wind " + std::string(kMaxTableNameBytes, 'x'); }};
  for (const auto& damage : damages) {
    ParameterTable table = sample();
    damage(table);
    EXPECT_FALSE(isSound(table)) << &damage - damages;
  }
}

TEST(ParameterTable, ItsLimitsAreThoseOfTheWire) {
  NamedValues values;
  for (size_t i = 0; i < kMaxTableEntries; ++i) values.push_back({"p" + std::to_string(i), {1, 2, 3, 4}});
  EXPECT_TRUE(isSound(parameterTable(values)));
  values.push_back({"one-more", {1}});
  EXPECT_FALSE(isSound(parameterTable(values)));
  const std::vector<double> many(kMaxTableComponents, 1.0);
  EXPECT_TRUE(isSound(parameterTable(NamedValues{{"a", many}})));
  EXPECT_FALSE(
      isSound(parameterTable(NamedValues{{"a", std::vector<double>(kMaxTableComponents + 1, 1.0)}})));
  NamedValues wide;
  for (size_t i = 0; i <= kMaxTableValues / kMaxTableComponents; ++i)
    wide.push_back({"w" + std::to_string(i), many});
  EXPECT_FALSE(isSound(parameterTable(wide)));
}

}  // namespace
}  // namespace strandcast
