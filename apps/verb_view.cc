#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/interrupt.h"
#include "apps/number_range.h"
#include "apps/picture_options.h"
#include "apps/unused_picture_options.h"
#include "apps/verbs.h"
#include "apps/viewer/viewer.h"

namespace strandcast {

Verb addView(CLI::App& app) {
  const auto o = std::make_shared<ViewerOptions>();
  const auto settings = std::make_shared<std::unique_ptr<SettingsOptions>>();
  app.footer(
      "Drag with the left button to orbit, scroll to zoom; the panel has everything else. Keys: Space pauses "
      "the simulation, . takes a single step, R resets the hair, P takes a screenshot, 1 to 5 choose what "
      "dragging does (orbit, move head, turn head, pull, comb), Tab hides the panel, Escape quits.\n"
      "With --scene, --groom or --config the simulation runs inside this process; without them, the verb "
      "draws a daemon's stream. For a simulation in this process the panel \"Air\" draws slices through the "
      "grids of wind and hair.");
  app.add_option("--timeout", o->timeout, "seconds to wait for a daemon")
      ->check(finiteRange(0.1, 3600.0))
      ->capture_default_str();
  app.add_option_function<std::string>(
         "--playout",
         [o](const std::string& name) {
           o->playout = name == "latest" ? Playout::kLatest : Playout::kSmooth;
         },
         "smooth: interpolated motion, one frame late; latest: the newest frame on arrival")
      ->check(CLI::IsMember({"smooth", "latest"}))
      ->default_str("smooth");
  app.add_option("--max-fps", o->max_fps, "limit of pictures per second; 0 = the display's refresh rate")
      ->check(finiteRange(0.0, 1000.0))
      ->capture_default_str();
  app.add_option("--preset-file", o->preset_file, "preset that the panel saves and loads")
      ->capture_default_str();
  addPictureOptions(app, o->picture);
  *settings = std::make_unique<SettingsOptions>(app);
  return [o, settings] {
    (*settings)->refuseWithoutScene();
    (*settings)->warnOfUnusedNetwork();
    warnOfUnusedPictureOptions(o->picture);
    o->settings = (*settings)->resolve();
    o->here = (*settings)->namesScene();
    return runViewer(*o);
  };
}

}  // namespace strandcast
