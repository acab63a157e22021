#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/parameters.h"
#include "transport/messages.h"

namespace strandcast {

/// Parameters by name, with their components.
using NamedValues = std::vector<std::pair<std::string, std::vector<double>>>;

/// Limits of the parameter table of a status.
inline constexpr size_t kMaxTableEntries = 256, kMaxTableComponents = 64, kMaxTableValues = 1024,
                        kMaxTableNameBytes = 8192;  // bytes

/// Precondition: names without spaces. Values are rounded to floats.
ParameterTable parameterTable(const NamedValues& values);
/// All of parameterList().
ParameterTable parameterTable(const Parameters& parameters);

/// After the parameters a table has the other things that commands steer, each named "KIND:NAME":
/// docs/wire.md, "Status".
inline constexpr const char *kWindSourceEntry = "fan", *kColliderEntry = "collider", *kUnusedEntry = "void";
/// Splits a list at single spaces; two spaces in a row give an empty name.
std::vector<std::string_view> splitNames(std::string_view text);
/// Whether each is a name, without spaces and control characters, and occurs once.
bool areDistinctNames(std::vector<std::string_view> names);
/// Escapes a name of any bytes but control characters for a list that spaces separate: spaces and % become
/// %20 and %25. withSpaces() is the inverse.
std::string withoutSpaces(const std::string& name);
std::string withSpaces(std::string_view text);
/// Appends an entry, its name escaped by withoutSpaces(). False, and nothing is appended, where it would
/// exceed the limits of the wire.
bool appendEntry(ParameterTable& table, const std::string& kind, const std::string& name,
                 const std::vector<double>& values);
/// The entries of a kind, named without it; kind "" means the parameters.
NamedValues entriesOf(const ParameterTable& table, const std::string& kind);

/// Whether a table fits the wire: consistent counts, each name once, finite values.
bool isSound(const ParameterTable& table);
/// All entries of a sound table, in its order.
NamedValues namedValues(const ParameterTable& table);

}  // namespace strandcast
