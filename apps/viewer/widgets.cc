#include "apps/viewer/widgets.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include <algorithm>
#include <cmath>

namespace strandcast {
namespace {

constexpr float kNameWidth = 148, kUnitWidth = 52, kResetWidth = 26;

bool isColour(const ParameterInfo& info) { return info.components == 3 && info.low == 0 && info.high == 1; }

bool isSwitch(const ParameterInfo& info, const std::vector<std::string>& choices) {
  return choices == std::vector<std::string>{"off", "on"} ||
         (choices.empty() && info.whole && info.low == 0 && info.high == 1);
}

/// Prints as many digits as the value needs.
const char* formatOf(const ParameterInfo& info) { return info.whole ? "%.0f" : "%.4g"; }

bool drag(const ParameterInfo& info, std::vector<double>& values) {
  double size = 0;
  for (const double v : values) size = std::max(size, std::fabs(v));
  const bool small = info.high - info.low <= 10;
  const double usual = small ? (info.high - info.low) / 100 : 1;
  const auto speed = static_cast<float>(info.whole ? std::max(0.1, size / 100) * info.multiple
                                                   : (size > 0 ? size / 100 : usual / 10));
  return ImGui::DragScalarN("##value", ImGuiDataType_Double, values.data(), info.components, speed, &info.low,
                            &info.high, formatOf(info), ImGuiSliderFlags_AlwaysClamp);
}

bool widget(const ParameterInfo& info, const std::vector<std::string>& choices, std::vector<double>& values) {
  if (isSwitch(info, choices)) {
    bool on = values[0] != 0;
    if (!ImGui::Checkbox("##value", &on)) return false;
    values[0] = on ? 1 : 0;
    return true;
  }
  if (!choices.empty()) {
    bool changed = false;
    const auto chosen = static_cast<size_t>(values[0]);
    if (ImGui::BeginCombo("##value", choices[chosen].c_str())) {
      for (size_t i = 0; i < choices.size(); ++i)
        if (ImGui::Selectable(choices[i].c_str(), i == chosen) && i != chosen) {
          values[0] = static_cast<double>(i);
          changed = true;
        }
      ImGui::EndCombo();
    }
    return changed;
  }
  if (isColour(info)) {
    float colour[3];
    std::copy(values.begin(), values.end(), colour);
    if (!ImGui::ColorEdit3("##value", colour, ImGuiColorEditFlags_Float)) return false;
    values.assign(colour, colour + 3);
    return true;
  }
  const std::vector<double> before = values;
  if (!drag(info, values)) return false;
  for (double& v : values)
    if (info.whole) v = std::clamp(std::round(v / info.multiple) * info.multiple, info.low, info.high);
  return values != before;
}

}  // namespace

void helpHere(const std::string& text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(420);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

bool settingRow(const ParameterInfo& info, const std::vector<std::string>& choices,
                const std::vector<double>& usual, std::vector<double>& values) {
  ImGui::PushID(info.name.c_str());
  const bool other = values != usual;
  ImGui::AlignTextToFramePadding();
  if (other)
    ImGui::TextColored({1, 0.86f, 0.6f, 1}, "%s", info.name.c_str());
  else
    ImGui::TextUnformatted(info.name.c_str());
  helpHere(fmt::format("{}\n\nrange: {}{}{}", info.help, info.range.empty() ? "of the list" : info.range,
                       info.unit.empty() ? "" : " ", info.unit));
  ImGui::SameLine(kNameWidth);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - kUnitWidth - kResetWidth);
  bool changed = widget(info, choices, values);
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - kUnitWidth - kResetWidth + 6);
  ImGui::TextDisabled("%s", info.unit.c_str());
  if (other) {
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - kResetWidth + 2);
    if (ImGui::SmallButton("<")) {
      values = usual;
      changed = true;
    }
    helpHere(fmt::format("reset to {:g}", fmt::join(usual, " ")));
  }
  ImGui::PopID();
  return changed;
}

bool textRow(const std::string& name, const std::string& help, std::string& text) {
  ImGui::PushID(name.c_str());
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(name.c_str());
  helpHere(help);
  ImGui::SameLine(kNameWidth);
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  const bool changed = ImGui::InputText("##value", &text, ImGuiInputTextFlags_EnterReturnsTrue);
  ImGui::PopID();
  return changed;
}

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

ImageTexture::~ImageTexture() {
  if (id_ != 0) glDeleteTextures(1, &id_);
}

void ImageTexture::set(const Image& image) {
  if (image.width != width_ || image.height != height_) {
    if (id_ != 0) glDeleteTextures(1, &id_);
    glCreateTextures(GL_TEXTURE_2D, 1, &id_);
    glTextureStorage2D(id_, 1, GL_RGB8, image.width, image.height);
    glTextureParameteri(id_, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    width_ = image.width;
    height_ = image.height;
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(id_, 0, 0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE, image.rgb.data());
}

void ImageTexture::show(float width) const {
  const float height = width * static_cast<float>(height_) / static_cast<float>(width_);
  ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(id_)), {width, height});
}

}  // namespace strandcast
