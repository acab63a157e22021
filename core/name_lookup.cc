#include "core/name_lookup.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace strandcast {
namespace {

size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row.back();
}

}  // namespace

std::string didYouMean(const std::string& name, std::span<const std::string> names) {
  const std::string* nearest = nullptr;
  size_t fewest = (name.size() + 2) / 3;  // with more edits it is a different name
  for (const std::string& known : names) {
    const size_t edits = editDistance(known, name);
    if (edits > fewest || (nearest != nullptr && edits == fewest)) continue;
    nearest = &known;
    fewest = edits;
  }
  return nearest == nullptr ? "" : "did you mean '" + *nearest + "'?";
}

}  // namespace strandcast
