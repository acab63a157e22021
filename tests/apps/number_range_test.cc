#include "options/number_range.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <clocale>

#include "tests/expect_error.h"

namespace strandcast {
namespace {

const NumberRange kRate{1, 1000, false, "Hz"}, kCount{1, 1e6, true};

std::string refused(const std::string& text, const NumberRange& range) {
  return errorOf([&] { numberIn(text, range, "--rate"); });
}

TEST(NumberRange, OneMessageSaysWhatWasGivenAndWhatIsExpected) {
  EXPECT_EQ(refused("fast", kRate), "'fast' is not a number from 1 to 1000 Hz: --rate");
  EXPECT_EQ(refused("2000", kRate), "'2000' is not a number from 1 to 1000 Hz: --rate");
  EXPECT_EQ(refused("1.5", kCount), "'1.5' is not a whole number from 1 to 1000000: --rate");
  EXPECT_EQ(refused("x", {}), "'x' is not a number: --rate");
}

TEST(NumberRange, OnlyDecimalNumbersAreNumbers) {
  for (const char* text : {"", " ", "nan", "-nan", "inf", "-inf", "infinity", "0x10", "1,5", "1.5.2", "5 ",
                           " 5", "5m", "1e", "++1", "1e999", "\xd9\xa3", "1_000"}) {
    EXPECT_NE(refused(text, {}), "") << "'" << text << "'";
    EXPECT_NE(refused(text, kCount), "") << "'" << text << "'";
  }
  EXPECT_EQ(numberIn("+2.5e2", kRate, ""), 250);
  EXPECT_EQ(numberIn("-.5", {}, ""), -0.5);
  EXPECT_EQ(numberIn("1e-999", {}, ""), 0) << "too small for a double";
  EXPECT_EQ(numberIn("1000", kRate, ""), 1000) << "limits are in the range";
}

TEST(NumberRange, OptionsReadTheSameNumbers) {
  const auto parsed = [](const std::string& word) {
    CLI::App app;
    int count = 0;
    double rate = 0;
    app.add_option("--count", count)->transform(wholeRange(1, 1e6));
    app.add_option("--rate", rate)->check(finiteRange(1, 1000, "Hz"));
    try {
      app.parse("--count=" + word + " --rate=" + word);
    } catch (const CLI::ParseError& error) {
      return std::string(error.what());
    }
    return std::to_string(count) + " " + std::to_string(rate);
  };
  EXPECT_EQ(parsed("1e2"), "100 100.000000");
  EXPECT_EQ(parsed("010"), "10 10.000000") << "not eight";
  EXPECT_EQ(parsed("+7.0"), "7 7.000000");
  EXPECT_EQ(parsed("0x10"), "--count: '0x10' is not a whole number from 1 to 1000000");
  EXPECT_EQ(parsed("nan"), "--count: 'nan' is not a whole number from 1 to 1000000");
  EXPECT_EQ(parsed("5000"), "--rate: '5000' is not a number from 1 to 1000 Hz");
}

TEST(NumberRange, NoLocaleMakesAnotherNumberOfIt) {
  const char* const before = std::setlocale(LC_NUMERIC, nullptr);
  const std::string kept = before == nullptr ? "C" : before;
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"}) {
    if (std::setlocale(LC_NUMERIC, name) == nullptr) continue;
    EXPECT_EQ(numberIn("1.5", {}, ""), 1.5) << name;
    EXPECT_NE(refused("1,5", {}), "") << name;
  }
  std::setlocale(LC_NUMERIC, kept.c_str());
}

}  // namespace
}  // namespace strandcast
