#pragma once
#include <string>

#include "apps/picture_options.h"
#include "apps/settings.h"
#include "transport/subscriber.h"

namespace strandcast {

/// The options of `strandcast view`.
struct ViewerOptions {
  Settings settings;
  bool here = false;  ///< simulate in this process
  PictureOptions picture;
  double timeout = 20;  ///< s, to wait for a daemon
  double max_fps = 0;   ///< pictures per second at most; 0 = the display's rate
  Playout playout = Playout::kSmooth;
  std::string preset_file = "preset.toml";
};

/// Runs the window until it is closed or settings.duration has passed; returns the program's exit code.
/// Throws Error.
int runViewer(const ViewerOptions& options);

}  // namespace strandcast
