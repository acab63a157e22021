#pragma once
#include <string>
#include <vector>

#include "apps/picture_settings.h"

namespace strandcast {

/// A line for each picture option without effect beside the others, by the table in void_picture.cc:
/// "--light-cone is not used: the light is no spot".
std::vector<std::string> voidPictureOptions(const PictureOptions& options);
/// Logs these lines.
void warnOfVoidPicture(const PictureOptions& options);

}  // namespace strandcast
