// Checks of a groom before a show: what they found, how bad it is, and where.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "groom/groom.h"

namespace strandcast {

/// kFault: the show should not begin.
enum class CheckSeverity : uint8_t { kOk, kWarning, kFault };
/// "ok", "warning" or "fault".
const char* nameOf(CheckSeverity severity);

/// The result of one check.
struct CheckResult {
  CheckSeverity severity = CheckSeverity::kOk;
  std::string key;       ///< for programs: "zero_edges". Remarks of readers share one key
  std::string what;      ///< the finding with its numbers
  double number = 0;     ///< the number that decides, in `unit`
  std::string unit{};    ///< "strands", "mm", "ms"; may be empty
  std::string where{};   ///< the first or the worst place; empty: the whole
  std::string remedy{};  ///< what to do; empty where nothing is wrong
};

/// A vertex that a picture marks.
struct CheckMark {
  enum class Kind : uint8_t {
    kRoot,
    kInside,
    kShape
  };  ///< off the skin; inside the body; sharp or not finite
  Kind kind;
  Vec3 position;  ///< m
};

/// Results of several checks, in their order.
struct CheckReport {
  std::vector<CheckResult> results;
  std::vector<CheckMark> marks;

  void add(CheckResult result) { results.push_back(std::move(result)); }
  /// Appends the results and marks of another report.
  void add(CheckReport other);
  /// The worst severity; kOk without results.
  CheckSeverity worst() const;
  size_t count(CheckSeverity severity) const;
  /// The first result with this key; null if there is none.
  const CheckResult* find(const std::string& key) const;
};

/// "ready", "ready with warnings" or "not ready".
const char* verdictOf(CheckSeverity worst);

/// Median lengths, m, between which strands are hair.
constexpr float kShortestHair = 1e-3f, kLongestHair = 3.0f;
constexpr float kFoldDegrees = 150;   ///< angle from edge to edge above which a strand is folded
constexpr float kUnevenEdges = 8;     ///< ratio of a strand's longest to its shortest edge
constexpr float kSameStrand = 1e-5f;  ///< m, distance of all vertices within which strands are duplicates

/// Checks of strands alone: size, lengths, faulty vertices and edges, duplicates, folds, and what cleaning
/// changed or left out (GroomReport).
///
/// `as_read`: the strands in metres, Y up, before cleaning; numbers need not be finite. `cleaned`: the groom
/// after cleanStrands(). `part_names`: by StrandSet::parts; may be empty. Strands are counted from 0 within
/// their part. Places of folds and edges are those of the cleaned strands.
CheckReport checkGroom(const StrandSet& as_read, const Groom& cleaned,
                       std::span<const std::string> part_names = {});

/// "strand 12 of tail": counted from 0 within its part.
std::string strandPlace(const StrandSet& strands, size_t strand, std::span<const std::string> part_names);

}  // namespace strandcast
