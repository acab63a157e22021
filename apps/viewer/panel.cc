#include "apps/viewer/panel.h"

#include <fmt/format.h>
#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include <algorithm>

#include "apps/viewer/widgets.h"
#include "core/error.h"
#include "service/slices.h"

namespace strandcast {
namespace {

constexpr size_t kMessages = 6;
constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                    ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse;

bool chosen(const char* label, bool on) {
  if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0.20f, 0.50f, 0.72f, 1));
  const bool pressed = ImGui::Button(label);
  if (on) ImGui::PopStyleColor();
  return pressed;
}

bool choice(const char* label, int& value, std::initializer_list<const char*> names) {
  bool changed = false;
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(label);
  int i = 0;
  for (const char* name : names) {
    ImGui::SameLine();
    if (ImGui::RadioButton(name, value == i)) {
      value = i;
      changed = true;
    }
    ++i;
  }
  return changed;
}

}  // namespace

ViewerPanel::ViewerPanel(const PictureOptions& picture_options, const std::string& preset_file)
    : picture(picture_options), usual_(picture_options), preset_file_(preset_file) {}

void ViewerPanel::say(const std::string& message) {
  messages_.push_front(message);
  if (messages_.size() > kMessages) messages_.pop_back();
}

bool ViewerPanel::matches(const std::string& name) const {
  return filter_.empty() || name.find(filter_) != std::string::npos;
}

void ViewerPanel::measure(ViewerSession& session, const RenderStatistics& rendered,
                          double pictures_per_second) {
  const auto status = session.subscriber().status();
  const ReceiveStatistics now = session.subscriber().statistics();
  if (status) {
    phases_.add("step", status->step_ms_median);
    stretch_.add("mean", 100 * status->mean_stretch);
    stretch_.add("largest", 100 * status->max_stretch);
  }
  phases_.add("guides", rendered.guides_ms);
  phases_.add("growth", rendered.growth_ms);
  phases_.add("shadow", rendered.shadow_ms);
  phases_.add("hair", rendered.hair_ms);
  phases_.add("rest", rendered.body_ms + rendered.resolve_ms);
  latency_.add("half", now.latency_ms_p50);
  latency_.add("99 %", now.latency_ms_p99);
  const auto since = [](uint64_t newer, uint64_t older) {
    return static_cast<double>(newer < older ? 0 : newer - older);
  };
  loss_.add("shown/s", pictures_per_second);
  loss_.add("lost", since(now.frames_lost, received_.frames_lost));
  loss_.add("mended", since(now.frames_concealed, received_.frames_concealed));
  received_ = now;
  for (const CommandOutcome& outcome : session.takeOutcomes()) {
    if (!outcome.refusal.empty())
      say("refused: " + outcome.refusal);
    else if (outcome.kind == CommandKind::kSetParameter)
      say(outcome.name + " is set");
  }
}

PanelRequests ViewerPanel::draw(ViewerSession& session, NetworkList& network,
                                const RenderStatistics& rendered, float width, float height) {
  PanelRequests requests;
  if (!shown) return requests;
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({kWidth, height});
  ImGui::Begin("panel", nullptr, kFixed);
  drawTop(session, requests);
  drawTools(session);
  drawMessages();
  ImGui::Separator();
  ImGui::SetNextItemWidth(-1);
  ImGui::InputTextWithHint("##filter", "find a setting", &filter_);
  ImGui::BeginChild("settings");
  drawParameters(session);
  drawPicture(requests);
  if (filter_.empty()) {
    drawPasses(rendered, requests);
    drawSlices(session);
    drawFields();
    drawPresets(session, requests);
    drawNetwork(session, network, requests);
  }
  ImGui::EndChild();
  ImGui::End();
  if (plots_shown) drawPlots(kWidth, height - kPlotHeight, width - kWidth);
  return requests;
}

void ViewerPanel::drawTop(ViewerSession& session, PanelRequests& requests) {
  const auto status = session.subscriber().status();
  const auto groom = session.subscriber().groom();
  ImGui::Text("%s", groom ? groom->name.c_str() : "no groom");
  if (status) {
    ImGui::SameLine();
    ImGui::TextDisabled("groom %u, %s%s, %llu strands", session.groomId(), status->backend.c_str(),
                        session.isHere() ? " here" : "", static_cast<unsigned long long>(status->strands));
    helpHere(status->device);
  }
  if (chosen(paused ? "resume" : "pause", paused)) {
    paused = !paused;
    session.commands().send(CommandKind::kPause, "", {paused ? 1.0 : 0.0});
  }
  helpHere("Space");
  ImGui::SameLine();
  requests.single_step = ImGui::Button("step");
  helpHere("single step of the paused simulation (.)");
  ImGui::SameLine();
  requests.reset = ImGui::Button("reset hair");
  helpHere("reset the hair to its rest shape (R)");
  ImGui::SameLine();
  requests.screenshot = ImGui::Button("screenshot");
  helpHere("writes strandcast_0000.png and following (P)");
  ImGui::SameLine();
  if (chosen(session.records() ? "stop" : "record", session.records())) {
    try {
      if (session.records())
        session.stopRecording();
      else
        session.startRecording(record_file_);
      say(session.records() ? "records into " + record_file_ : record_file_ + " is written");
    } catch (const Error& error) {
      say(error.what());
    }
  }
  helpHere("records the stream into a file that `strandcast replay` publishes again");
  if (session.records()) {
    ImGui::SameLine();
    ImGui::Text("%.1f s", session.recordedSeconds());
  } else {
    textRow("record into", "file of the next recording", record_file_);
  }
  if (const std::string problem = session.recordingProblem(); !problem.empty())
    ImGui::TextWrapped("%s", problem.c_str());
}

void ViewerPanel::drawTools(ViewerSession& session) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("mouse");
  for (int i = 0; i < 5; ++i) {
    ImGui::SameLine();
    if (chosen(kMouseTools[i], tool == static_cast<MouseTool>(i))) tool = static_cast<MouseTool>(i);
    helpHere(
        fmt::format("action of dragging with the left button ({}); the right button always orbits, the wheel "
                    "zooms, Shift pulls and Control turns the head",
                    i + 1));
  }
  if (tool == MouseTool::kPull || tool == MouseTool::kComb) {
    float centimetres = 100 * (tool == MouseTool::kPull ? hand.radius : hand.comb_radius);
    ImGui::SetNextItemWidth(120);
    if (ImGui::SliderFloat("hand (cm)", &centimetres, 0.1f, 8, "%.1f"))
      (tool == MouseTool::kPull ? hand.radius : hand.comb_radius) = 0.01f * centimetres;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(120);
    ImGui::SliderFloat("force (1/s)", &hand.rate, 5, 400, "%.0f");
  }
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("head ");
  for (const char* motion : {"still", "nod", "shake", "turn"}) {
    ImGui::SameLine();
    if (ImGui::Button(motion)) session.commands().send(CommandKind::kHeadMotion, motion, {});
  }
}

void ViewerPanel::drawMessages() {
  if (!messages_.empty()) {
    ImGui::PushTextWrapPos(0);
    ImGui::TextColored({0.65f, 0.85f, 0.7f, 1}, "%s", messages_.front().c_str());
    ImGui::PopTextWrapPos();
    std::string all;
    for (const std::string& message : messages_) all += message + "\n";
    helpHere(all);
  } else {
    ImGui::TextDisabled("drag in the picture; Tab hides this panel");
  }
}

void ViewerPanel::drawParameters(ViewerSession& session) {
  if (!filter_.empty()) ImGui::SetNextItemOpen(true);
  if (!ImGui::CollapsingHeader("Simulation", ImGuiTreeNodeFlags_DefaultOpen)) return;
  const size_t waiting = session.commands().waiting();
  if (filter_.empty())
    ImGui::TextDisabled("%s", waiting > 0
                                  ? fmt::format("{} commands wait for the daemon's answer", waiting).c_str()
                                  : "sent to the daemon as commands; all answered");
  for (const ParameterInfo& info : session.settable()) {
    if (!matches(info.name)) continue;
    const auto known = session.parameter(info.name);
    const std::vector<double> usual = session.usualParameter(info.name);
    std::vector<double> values = known.value_or(usual);
    if (!known) ImGui::PushStyleVar(ImGuiStyleVar_Alpha, 0.55f);
    const bool changed = settingRow(info, {}, usual, values);
    if (!known) ImGui::PopStyleVar();
    if (changed) session.setParameter(info.name, values);
  }
}

void ViewerPanel::drawPicture(PanelRequests& requests) {
  std::string group;
  bool open = false, lights_shown = false;
  PictureOptions usual = usual_;
  for (const PictureSetting& setting : pictureSettings()) {
    if (!matches(setting.info.name)) continue;
    if (group != setting.group) {
      group = setting.group;
      if (!filter_.empty()) ImGui::SetNextItemOpen(true);
      open = ImGui::CollapsingHeader(group.c_str());
    }
    if (!open) continue;
    if (setting.of_light && !lights_shown) {
      lights_shown = true;
      drawLights(requests);
      usual.settings.lights.resize(picture.settings.lights.size());  // added lights have the defaults
      usual.light = picture.light;
    }
    if (setting.file != nullptr) {
      std::string file = (picture.*setting.file).string();
      if (!textRow(setting.info.name, setting.info.help, file)) continue;
      picture.*setting.file = file;
      requests.picture_changed = true;
      continue;
    }
    std::vector<double> values = setting.get(picture);
    if (!settingRow(setting.info, setting.choices, setting.get(usual), values)) continue;
    setting.set(picture, values);
    requests.picture_changed = true;
  }
}

/// Selects the light that the rows below edit, and the number of lights.
void ViewerPanel::drawLights(PanelRequests& requests) {
  std::vector<Light>& lights = picture.settings.lights;
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted("lights");
  for (size_t i = 0; i < lights.size(); ++i) {
    ImGui::SameLine();
    ImGui::PushID(static_cast<int>(i));
    if (chosen(fmt::format(" {} ", i + 1).c_str(), picture.light == i)) picture.light = i;
    ImGui::PopID();
    helpHere("the settings below belong to this light");
  }
  const auto button = [](const char* label, bool possible) {
    if (!possible) return false;
    ImGui::SameLine();
    return ImGui::Button(label);
  };
  const bool add = button("add", lights.size() < kMaxLights), remove = button("remove", lights.size() > 1);
  if (add) addLight(picture, "panel");
  if (remove) {
    lights.erase(lights.begin() + static_cast<ptrdiff_t>(picture.light));
    picture.light = std::min(picture.light, lights.size() - 1);
  }
  requests.picture_changed |= add || remove;
}

void ViewerPanel::drawPasses(const RenderStatistics& rendered, PanelRequests& requests) {
  if (!ImGui::CollapsingHeader("Passes")) return;
  ImGui::TextDisabled("in this order; %zu of %zu hairs, %d segments", rendered.hairs_drawn,
                      rendered.hairs_grown, rendered.segments_drawn);
  std::vector<RenderPass>& passes = picture.settings.passes;
  std::optional<size_t> out;
  for (size_t i = 0; i < passes.size(); ++i) {
    ImGui::PushID(static_cast<int>(passes[i]));
    bool on = true;
    if (ImGui::Checkbox("##on", &on)) out = i;
    ImGui::SameLine();
    if (ImGui::ArrowButton("up", ImGuiDir_Up) && i > 0) {
      std::swap(passes[i], passes[i - 1]);
      requests.picture_changed = true;
    }
    ImGui::SameLine();
    ImGui::TextUnformatted(nameOf(passes[i]));
    for (const PassTime& time : rendered.passes)
      if (time.pass == passes[i]) {
        ImGui::SameLine(kWidth - 120);
        ImGui::TextDisabled("%.2f ms", time.ms);
      }
    ImGui::PopID();
  }
  for (const RenderPass pass : allPasses()) {
    if (std::find(passes.begin(), passes.end(), pass) != passes.end()) continue;
    bool on = false;
    if (!ImGui::Checkbox(nameOf(pass), &on)) continue;
    passes.insert(passes.begin() + static_cast<ptrdiff_t>(std::min(passes.size(), static_cast<size_t>(pass))),
                  pass);
    requests.picture_changed = true;
    break;
  }
  if (out) {
    passes.erase(passes.begin() + static_cast<ptrdiff_t>(*out));
    requests.picture_changed = true;
  }
}

void ViewerPanel::drawSlices(ViewerSession& session) {
  const bool open = ImGui::CollapsingHeader("Air");
  if (!open) {
    if (slice_wanted_) session.requestSlice(std::nullopt);
    slice_wanted_ = false;
    return;
  }
  int quantity = static_cast<int>(slice_request_.quantity);
  bool changed = choice("show  ", quantity, {"density", "wind", "pressure", "divergence"});
  changed |= choice("across", slice_request_.axis, {"x", "y", "z"});
  slice_request_.quantity = static_cast<AirQuantity>(quantity);
  if (changed || !slice_wanted_) session.requestSlice(slice_request_);
  slice_wanted_ = true;
  if (const auto slice = session.takeSlice()) {
    slice_.set(slice->image);
    slice_scale_ = fmt::format("full colour: {:.3g} {}", slice->full, slice->unit);
  }
  if (const std::string problem = session.sliceProblem(); !problem.empty()) {
    ImGui::TextWrapped("%s", problem.c_str());
  } else if (!slice_.isEmpty()) {
    slice_.show(ImGui::GetContentRegionAvail().x);
    ImGui::TextDisabled("%s; red above 0, blue below, hair as dots", slice_scale_.c_str());
  }
}

void ViewerPanel::setFields(std::vector<std::shared_ptr<const DistanceField>> fields) {
  fields_ = std::move(fields);
  field_ = 0;
  field_stale_ = true;
}

void ViewerPanel::drawFields() {
  if (!ImGui::CollapsingHeader("Body fields")) return;
  if (fields_.empty()) {
    ImGui::TextWrapped("no field is baked: switch on keep-out or mark-collided");
    return;
  }
  for (int i = 0; i < static_cast<int>(fields_.size()); ++i) {
    if (i > 0) ImGui::SameLine();
    if (ImGui::RadioButton(fmt::format("part {}", i + 1).c_str(), field_ == i)) {
      field_ = i;
      field_stale_ = true;
    }
  }
  field_stale_ |= choice("across", field_axis_, {"x", "y", "z"});
  ImGui::SetNextItemWidth(-1);
  field_stale_ |= ImGui::SliderFloat("##part", &field_part_, 0, 1, "at %.2f of the grid");
  if (field_stale_)
    field_slice_.set(
        fieldSlice(*fields_[static_cast<size_t>(field_)], field_axis_, static_cast<double>(field_part_)));
  field_stale_ = false;
  field_slice_.show(ImGui::GetContentRegionAvail().x);
  ImGui::TextDisabled("distance: blue outside, red inside, black the surface");
}

void ViewerPanel::loadPreset(ViewerSession& session) {
  try {
    for (const auto& [name, values] : readPreset(preset_file_, picture)) session.setParameter(name, values);
    say(preset_file_ + " is loaded");
  } catch (const Error& error) {
    say(error.what());
  }
}

void ViewerPanel::drawPresets(ViewerSession& session, PanelRequests& requests) {
  if (!ImGui::CollapsingHeader("Presets")) return;
  textRow("file", "TOML file with every setting above; also readable with --preset FILE", preset_file_);
  if (ImGui::Button("save")) {
    try {
      writePreset(preset_file_, session.parameters(), picture);
      say(preset_file_ + " is saved");
    } catch (const Error& error) {
      say(error.what());
    }
  }
  ImGui::SameLine();
  if (ImGui::Button("load")) {
    loadPreset(session);
    requests.picture_changed = true;
  }
  ImGui::SameLine();
  if (ImGui::Button("reset picture settings")) {
    picture = usual_;
    requests.picture_changed = true;
  }
}

void ViewerPanel::drawNetwork(ViewerSession& session, NetworkList& network, PanelRequests& requests) {
  if (!ImGui::CollapsingHeader("Network")) return;
  if (!network.listens() && ImGui::Button("look for daemons")) network.listen();
  if (!network.problem().empty()) ImGui::TextWrapped("%s", network.problem().c_str());
  const std::vector<Status> daemons = network.daemons();
  if (network.listens() && daemons.empty()) ImGui::TextDisabled("no daemon found");
  for (const Status& daemon : daemons) {
    ImGui::PushID(static_cast<int>(daemon.groom_id));
    const bool current = !session.isHere() && daemon.groom_id == session.groomId();
    if (ImGui::Selectable(fmt::format("groom {}: {}", daemon.groom_id, daemon.groom_name).c_str(), current) &&
        !current)
      requests.join = daemon.groom_id;
    ImGui::TextDisabled("   %s, %llu strands, step %.2f ms, %u readers", daemon.backend.c_str(),
                        static_cast<unsigned long long>(daemon.strands), daemon.step_ms_median,
                        daemon.readers);
    helpHere(daemon.device);
    ImGui::PopID();
  }
}

void ViewerPanel::drawPlots(float left, float top, float width) {
  ImGui::SetNextWindowPos({left, top});
  ImGui::SetNextWindowSize({width, kPlotHeight});
  ImGui::Begin("plots", nullptr, kFixed | ImGuiWindowFlags_NoScrollbar);
  const float each = (ImGui::GetContentRegionAvail().x - 3 * 12) / 4, tall = ImGui::GetContentRegionAvail().y;
  bool first = true;
  for (const Plot* plot : {&phases_, &latency_, &stretch_, &loss_}) {
    if (!first) ImGui::SameLine(0, 12);
    first = false;
    plot->draw(each, tall);
  }
  ImGui::End();
}

}  // namespace strandcast
