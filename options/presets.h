#pragma once
#include <filesystem>
#include <string>

#include "options/picture_settings.h"
#include "transport/parameter_table.h"

namespace strandcast {

/// Writes a preset, a TOML file. The table [parameters] is as in configuration files. The table [picture] has
/// every setting of pictureSettings(): a number or three, the name of a choice, or a file; and `passes`, the
/// names of passes in their order. A table [[light]] per light has the settings' names without "light-" as
/// keys and, for "light", `kind`. [picture] may also have the settings of a single light.
std::string presetText(const NamedValues& parameters, const PictureOptions& picture);
/// Applies a preset over `picture` and returns its parameters, checked. Settings that it does not name are
/// kept. Throws Error with file, line and key, and leaves `picture` unchanged.
NamedValues readPresetText(const std::string& text, const std::string& name, PictureOptions& picture);

/// The same for files; both throw Error where the file cannot be written or read.
void writePreset(const std::filesystem::path& file, const NamedValues& parameters,
                 const PictureOptions& picture);
NamedValues readPreset(const std::filesystem::path& file, PictureOptions& picture);

}  // namespace strandcast
