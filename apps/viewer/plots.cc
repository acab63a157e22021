#include "apps/viewer/plots.h"

#include <fmt/format.h>
#include <imgui/imgui.h>

#include <algorithm>
#include <cmath>

namespace strandcast {
namespace {

/// A palette for readers with colour vision deficiency (Okabe and Ito 2008).
constexpr ImU32 kColours[] = {IM_COL32(86, 180, 233, 255), IM_COL32(230, 159, 0, 255),
                              IM_COL32(0, 158, 115, 255),  IM_COL32(204, 121, 167, 255),
                              IM_COL32(240, 228, 66, 255), IM_COL32(213, 94, 0, 255),
                              IM_COL32(170, 170, 220, 255)};
constexpr ImU32 kFrame = IM_COL32(255, 255, 255, 22), kQuiet = IM_COL32(190, 195, 205, 255);

ImU32 colourOf(size_t line) { return kColours[line % std::size(kColours)]; }

/// The smallest of 1, 2 or 5 times a power of ten that is at least `value`.
double niceTop(double value) {
  if (!(value > 0) || !std::isfinite(value)) return 1;
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (value <= step * power * 1.0001) return step * power;
  return 10 * power;
}

}  // namespace

void History::add(double value) {
  values_[count_ % kLength] = std::isfinite(value) ? value : 0;
  ++count_;
}

double History::at(size_t i) const { return values_[(count_ < kLength ? i : count_ + i) % kLength]; }

void Plot::add(const std::string& name, double value) {
  for (Line& line : lines)
    if (line.name == name) return line.history.add(value);
  lines.push_back({name, {}});
  lines.back().history.add(value);
}

void Plot::draw(float width, float height) const {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float text = ImGui::GetTextLineHeight();
  ImGui::Dummy({width, height});
  double largest = 0;
  for (const Line& line : lines)
    for (size_t i = 0; i < line.history.size(); ++i) largest = std::max(largest, line.history.at(i));
  const double top = niceTop(largest);
  const float right = corner.x + width, upper = corner.y + text + 4, lower = corner.y + height - 2;
  draw->PushClipRect(corner, {right, corner.y + height}, true);
  draw->AddText(corner, IM_COL32(235, 235, 240, 255),
                fmt::format("{}{}", title, unit.empty() ? "" : " (" + unit + ")").c_str());
  draw->AddRectFilled({corner.x, upper}, {right, lower}, IM_COL32(20, 21, 24, 255), 3);
  for (int quarter = 1; quarter < 4; ++quarter) {
    const float y = lower + (upper - lower) * static_cast<float>(quarter) / 4;
    draw->AddLine({corner.x, y}, {right, y}, kFrame);
  }
  for (size_t n = 0; n < lines.size(); ++n) {
    const History& history = lines[n].history;
    std::vector<ImVec2> points;
    for (size_t i = 0; i < history.size(); ++i)
      points.push_back({right - width * static_cast<float>(history.size() - 1 - i) /
                                    static_cast<float>(History::kLength - 1),
                        lower + (upper - lower) * static_cast<float>(history.at(i) / top)});
    draw->AddPolyline(points.data(), static_cast<int>(points.size()), colourOf(n), 0, 1.5f);
  }
  const std::string scale = fmt::format("{:g}", top);
  draw->AddText({right - ImGui::CalcTextSize(scale.c_str()).x - 4, upper + 1}, kQuiet, scale.c_str());
  float label = upper + 1;
  for (size_t n = 0; n < lines.size() && label + text < lower + 2; ++n, label += text) {
    const std::string words = fmt::format("{} {:.3g}", lines[n].name, lines[n].history.newest());
    draw->AddRectFilled({corner.x + 3, label},
                        {corner.x + 7 + ImGui::CalcTextSize(words.c_str()).x, label + text},
                        IM_COL32(20, 21, 24, n == 0 ? 255 : 170));  // may cover the scale's label
    draw->AddText({corner.x + 5, label}, colourOf(n), words.c_str());
  }
  draw->PopClipRect();
}

}  // namespace strandcast
