#pragma once
#include <filesystem>
#include <string>

#include "apps/picture_settings.h"
#include "transport/parameter_table.h"

namespace strandcast {

/// A preset is a TOML file with two tables: [parameters], as configuration files have it, and [picture], with
/// every setting of pictureSettings(): a number or three, the name of a choice, or a file, and `passes`, the
/// names of passes in their order; and with a table [[light]] for each light, whose keys are the names of its
/// settings without "light-" and, for "light", `kind`. [picture] may have the settings of a single light too.
std::string presetText(const NamedValues& parameters, const PictureOptions& picture);
/// Lays a preset over `picture` and gives its parameters, checked. What it does not name stays. Throws Error,
/// with file, line and key, and leaves `picture` as it was.
NamedValues readPresetText(const std::string& text, const std::string& name, PictureOptions& picture);

/// The same with files; throw Error where one cannot be written or read.
void writePreset(const std::filesystem::path& file, const NamedValues& parameters,
                 const PictureOptions& picture);
NamedValues readPreset(const std::filesystem::path& file, PictureOptions& picture);

}  // namespace strandcast
