#pragma once
#include <string>
#include <vector>

#include "apps/picture_settings.h"

namespace strandcast {

/// A line for each picture option without effect beside the others, by the table in
/// unused_picture_options.cc:
/// "--light-cone is not used: the light is no spot".
std::vector<std::string> unusedPictureOptions(const PictureOptions& options);
/// Logs these lines.
void warnOfUnusedPictureOptions(const PictureOptions& options);

}  // namespace strandcast
