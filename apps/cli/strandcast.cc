#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <utility>
#include <vector>

#include "apps/cli/verbs.h"
#include "options/console.h"
#include "validation/pose_suite.h"
#include "validation/wire_suite.h"

int main(int argc, char** argv) {
  using namespace strandcast;
  CLI::App app(
      "strandcast draws, inspects, converts, records and steers simulated hair.\n"
      "\nExamples:\n"
      "  strandcast view --scene curly              simulation and window in one process, no daemon\n"
      "  strandcast render --frames 60 --out out    draw the frames of a daemon as PNG files\n"
      "  strandcast info bob.tfx --json\n"
      "  strandcast check bob.tfx head.obj          are they ready for a show?\n"
      "  strandcast validate physics                the solver against exact solutions\n"
      "  strandcast ctl wind 3 0 0");
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  app.set_help_all_flag("--help-all", "print the help of every verb");
  std::vector<std::pair<CLI::App*, Verb>> verbs;
  auto add = [&](const char* name, const char* description, Verb (*declare)(CLI::App&)) {
    CLI::App* verb = app.add_subcommand(name, description);
    verbs.emplace_back(verb, declare(*verb));
  };
  add("info", "Print the contents of a groom file, or the backends of this machine", addInfo);
  add("convert", "Rewrite a groom in another format", addConvert);
  add("check", "Check groom, body and clip before a show: one verdict, numbers and a picture", addCheck);
  add("bake", "Bake the signed distance field of a body mesh", addBake);
#ifdef STRANDCAST_HAS_RENDER
  add("render", "Draw frames into PNG files, with or without a daemon", addRender);
  add("compare", "Compare solvers under a shaken head: numbers and pictures", addCompare);
#endif
#ifdef STRANDCAST_HAS_VIEW
  add("view", "Draw in a window, with or without a daemon", addView);
#endif
  add("validate", "Score the physics of strands against exact solutions", addValidate);
  add("record", "Record the frames of a daemon into a file", addRecord);
  add("replay", "Publish a recording again, check it, or repeat its simulation", addReplay);
  add("ctl", "Steer a running daemon", addCtl);
  add("keys", "Make the keys of a network that admits only known programs", addKeys);
  add("wire-reader", "Internal: the reading process of `validate wire`", addWireReader);
  verbs.back().first->group("");
  add("pose-sender", "Internal: the sending process of `validate poses`", addPoseSender);
  verbs.back().first->group("");
  if (const std::optional<int> ended = parseArguments(app, argc, argv)) return *ended;
  spdlog::set_default_logger(spdlog::stderr_color_mt("strandcast"));
  for (const auto& [verb, run] : verbs)
    if (verb->parsed()) {
      catchInterrupts();
      return runProgram(run);
    }
  return kExitBadInput;
}
