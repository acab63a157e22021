#pragma once
#include <string>

#include "apps/picture_options.h"
#include "apps/settings.h"
#include "transport/subscriber.h"

namespace strandcast {

struct ViewerOptions {
  Settings settings;
  bool here = false;  ///< simulate in this process
  PictureOptions picture;
  double timeout = 20;  ///< s, to wait for a daemon
  double max_fps = 0;   ///< pictures a second at most; 0: as many as the display shows
  Playout playout = Playout::kSmooth;
  std::string preset_file = "preset.toml";
};

/// The window, until it is closed or settings.duration has passed; gives the program's exit code. Throws
/// Error.
int runViewer(const ViewerOptions& options);

}  // namespace strandcast
