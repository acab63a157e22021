#include "options/console.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "options/number_range.h"
#include "options/scene_loading.h"
#include "options/settings.h"
#include "tests/expect_error.h"

namespace strandcast {
namespace {

/// The error of a program with a few verbs for these arguments; empty where it accepts them.
std::string saidOf(std::vector<const char*> words) {
  CLI::App app("a program");
  app.require_subcommand(1);
  double zoom = 1;
  std::string file;
  CLI::App* render = app.add_subcommand("render", "draw");
  CLI::Option_group* group = render->add_option_group("Picture");
  group->add_option("--zoom", zoom);
  app.add_subcommand("info", "tell")->add_option("FILE", file)->required();
  CLI::App* ctl = app.add_subcommand("ctl", "steer");
  ctl->require_subcommand(1);
  ctl->fallthrough();
  ctl->add_option("--domain", file);
  CLI::App* collider = ctl->add_subcommand("collider", "bodies");
  collider->require_subcommand(1);
  for (const char* verb : {"add", "move", "remove"}) collider->add_subcommand(verb, "it");
  for (const char* verb : {"status", "wind", "reset"}) ctl->add_subcommand(verb, "it");
  words.insert(words.begin(), "/usr/bin/strandcast");
  ::testing::internal::CaptureStderr();
  const std::optional<int> ended = parseArguments(app, static_cast<int>(words.size()), words.data());
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(ended.value_or(0), said.empty() ? 0 : kExitBadInput);
  return said;
}

TEST(Console, AWordThatIsNoVerbHasTheNearestOneNamed) {
  EXPECT_EQ(saidOf({"rendr"}),
            "error: 'rendr' is not a verb: strandcast; did you mean 'render'? see "
            "`strandcast --help`\n");
  EXPECT_EQ(saidOf({"ctl", "colider"}),
            "error: 'colider' is not a verb: strandcast ctl; did you mean "
            "'collider'? see `strandcast ctl --help`\n");
  EXPECT_EQ(saidOf({"ctl", "--domain", "3", "collider", "mvoe", "rod"}),
            "error: 'mvoe' is not a verb: strandcast ctl collider; did you mean 'move'? see `strandcast ctl "
            "collider --help`\n");
  EXPECT_EQ(saidOf({"ctl", "nonsense"}),
            "error: 'nonsense' is not a verb: strandcast ctl; choose one of collider, status, wind, reset; "
            "see `strandcast ctl --help`\n");
}

TEST(Console, AnUnknownOptionHasTheNearestOneNamed) {
  EXPECT_EQ(saidOf({"render", "--zom", "2"}),
            "error: '--zom' is not an option: strandcast render; did you mean "
            "'--zoom'? see `strandcast render --help`\n");
  EXPECT_EQ(saidOf({"ctl", "wind", "--domian=3"}),
            "error: '--domian=3' is not an option: strandcast ctl wind; "
            "did you mean '--domain'? see `strandcast ctl wind --help`\n");
  EXPECT_EQ(saidOf({"render", "--frobnicate"}),
            "error: '--frobnicate' is not an option: strandcast render; see "
            "`strandcast render --help`\n");
  EXPECT_EQ(saidOf({"info", "a.tfx", "b.tfx"}),
            "error: 'b.tfx' is not expected: strandcast info; see `strandcast info --help`\n");
  EXPECT_EQ(saidOf({"render", "--zoom", "2"}), "");
}

TEST(Console, TheMarkdownPageHasValuesDefaultsAndConditionsOfOptions) {
  CLI::App app("a program");
  std::string file, kind = "a";
  int count = 1;
  std::vector<double> place;
  CLI::App* draw = app.add_subcommand("draw", "draw|paint");
  draw->add_option("FILE", file, "what to draw")->required();
  CLI::Option* kinds = draw->add_option("--kind", kind, "one of:\n  a: the first\n  b     the second")
                           ->check(CLI::IsMember({"a", "b"}))
                           ->capture_default_str();
  draw->add_option("--count", count, "[pixels] size")->transform(wholeRange(1, 9))->needs(kinds);
  draw->add_option_group("Place", "where")->add_option("--at", place, "middle, m")->expected(3);
  app.add_subcommand("secret", "internal")->group("");
  EXPECT_EQ(markdownHelp(app, "tool"),
            "### tool\n\na program\n\n"
            "| verb | meaning |\n|---|---|\n| `draw` | draw\\|paint |\n\n"
            "### tool draw\n\ndraw|paint\n\n"
            "| argument | value | meaning |\n|---|---|---|\n| `FILE` | text; required | what to draw |\n\n"
            "| option | value | default | meaning |\n|---|---|---|---|\n"
            "| `--kind` | `a`, `b` | `a` | one of:<br>`a`: the first<br>`b`: the second |\n"
            "| `--count` | whole number, 1 to 9 pixels |  | size; needs `--kind` |\n\n"
            "**Place**: where\n\n"
            "| option | value | meaning |\n|---|---|---|\n| `--at` | 3 numbers | middle, m |\n\n");
}

TEST(Console, TheMarkdownPageNamesOptionsOfTheDaemonOnly) {
  CLI::App app("a program");
  const SettingsOptions options(app, SettingsUse::kServe);
  const std::string page = markdownHelp(app, "tool");
  EXPECT_NE(page.find("| [strandcastd](#strandcastd) | `--transport`, "), std::string::npos) << page;
  EXPECT_EQ(page.find("| `--transport` |"), std::string::npos) << page;
  EXPECT_NE(markdownHelp(app, "strandcastd").find("| `--groom` | `groom.files` |"), std::string::npos);
}

TEST(HairEstimate, TellsOfLargeGroomsAndNotOfSmallOnes) {
  SceneOptions options;
  EXPECT_FALSE(estimateOfGroom(options).isNotable());
  options.strands = 1000000;
  options.vertices = 100;
  const HairEstimate large = estimateOfGroom(options);
  EXPECT_TRUE(large.isNotable());
  EXPECT_EQ(large.vertices, 100000000u);
  EXPECT_GT(large.seconds, 1);
  EXPECT_NE(large.text().find(" s, 23842 MiB"), std::string::npos) << large.text();
}

TEST(Settings, FilesNamedAsArgumentsCountAsOptions) {
  CLI::App app("a program");
  SettingsOptions options(app, SettingsUse::kCheck);
  app.parse("--unit-meters 0.01 --rate 50");
  options.nameFiles({"front.tfx", "back.tfx"}, "head.glb", "walk");
  const Settings settings = options.resolve();
  ASSERT_EQ(settings.scene.groom.size(), 2u);
  EXPECT_EQ(settings.scene.groom[1], "back.tfx");
  EXPECT_EQ(settings.scene.body, "head.glb");
  ASSERT_TRUE(settings.scene.skinned);
  EXPECT_EQ(settings.scene.skinned->clip, "walk");
  EXPECT_EQ(settings.given.at("body.file"), "--body");
  EXPECT_EQ(settings.rate, 50);

  CLI::App again("a program");
  SettingsOptions twice(again, SettingsUse::kCheck);
  again.parse("--body head.glb --clip walk");
  expectError([&] { twice.nameFiles({"front.tfx"}, "other.glb", ""); }, {"--body", "leave one of them out"});
  twice.nameFiles({"front.tfx"}, "", "");
  EXPECT_EQ(twice.resolve().scene.skinned->clip, "walk");
}

}  // namespace
}  // namespace strandcast
