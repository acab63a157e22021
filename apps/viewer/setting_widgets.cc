#include "apps/viewer/setting_widgets.h"

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

}  // namespace strandcast
