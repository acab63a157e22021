#include "light/dual_scattering_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace strandcast {

double DualScatteringTable::columnOf(double absorption) {
  const double root = std::sqrt(absorption);
  return std::isinf(root) ? 1 : root / (1 + root);
}

DualScatteringTable::DualScatteringTable(const FibreMaterial& material, BackscatteringSeries series) {
  std::array<double, kColumns> absorptions{};
  for (int column = 0; column < kColumns; ++column) {
    const double u = column / (kColumns - 1.0), root = u / (1 - u);
    absorptions[static_cast<size_t>(column)] =
        column + 1 < kColumns ? root * root : std::numeric_limits<double>::infinity();
  }
  const FibreLayers layers(material);
  numbers_.reserve(size_t{kRows} * kColumns * kNumbers);
  for (int row = 0; row < kRows; ++row) {
    const double cosine = row / (kRows - 1.0);
    for (const LayerScattering& layer : layers.at(std::sqrt(1 - cosine * cosine), absorptions)) {
      const Backscattering back =
          series == BackscatteringSeries::kPaper ? paperBackscattering(layer) : fullBackscattering(layer);
      for (const double number :
           {layer.forward, layer.forward_variance, back.attenuation, back.shift, back.variance})
        numbers_.push_back(static_cast<float>(number));
    }
  }
}

DualScatteringTable::Values DualScatteringTable::at(double cosine, double absorption) const {
  const auto split = [](double place, int count) {
    const double at = std::clamp(place, 0.0, 1.0) * (count - 1);
    const auto whole = static_cast<size_t>(std::min(at, count - 2.0));
    return std::pair(whole, at - static_cast<double>(whole));
  };
  const auto [row, down] = split(cosine, kRows);
  const auto [column, across] = split(columnOf(absorption), kColumns);
  const float* const first = &numbers_[(row * kColumns + column) * kNumbers];
  const float* const next = first + size_t{kColumns} * kNumbers;
  const auto number = [&, down = down, across = across](size_t i) {
    return (1 - down) * ((1 - across) * static_cast<double>(first[i]) +
                         across * static_cast<double>(first[kNumbers + i])) +
           down * ((1 - across) * static_cast<double>(next[i]) +
                   across * static_cast<double>(next[kNumbers + i]));
  };
  return {number(0), number(1), {number(2), number(3), number(4)}};
}

}  // namespace strandcast
