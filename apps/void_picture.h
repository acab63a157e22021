#pragma once
#include <string>
#include <vector>

#include "apps/picture_settings.h"

namespace strandcast {

/// A line for each option of the picture that does nothing beside the other settings, by the rules of one
/// table (void_picture.cc): "--light-cone is not used: the light is no spot".
std::vector<std::string> voidPictureOptions(const PictureOptions& options);
/// Logs them.
void warnOfVoidPicture(const PictureOptions& options);

}  // namespace strandcast
