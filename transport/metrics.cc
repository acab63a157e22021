#include "transport/metrics.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace strandcast {
namespace {

std::vector<std::string> wordsOf(const std::string& names) {
  std::vector<std::string> words;
  for (size_t begin = 0; begin < names.size();) {
    const size_t end = std::min(names.find(' ', begin), names.size());
    words.push_back(names.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

}  // namespace

bool isSound(const MetricTable& table) {
  return table.values.size() <= kMaxMetrics && wordsOf(table.names).size() == table.values.size() &&
         std::all_of(table.values.begin(), table.values.end(), [](double v) { return std::isfinite(v); });
}

std::map<std::string, double> namedValues(const MetricTable& table) {
  std::map<std::string, double> named;
  const std::vector<std::string> names = wordsOf(table.names);
  for (size_t i = 0; i < names.size(); ++i) named[names[i]] = table.values[i];
  return named;
}

}  // namespace strandcast
