#pragma once
#include <deque>
#include <optional>
#include <string>

#include "apps/viewer/hair_tool.h"
#include "apps/viewer/session.h"
#include "apps/viewer/widgets.h"
#include "core/distance_field.h"
#include "options/picture_settings.h"
#include "render/renderer.h"

namespace strandcast {

/// Requests of the panel to the viewer's loop.
struct PanelRequests {
  bool picture_changed = false;
  bool screenshot = false, single_step = false, reset = false;
  std::optional<uint32_t> join;  ///< id of a groom on the network
};

/// The user interface beside the picture: settings, buttons and plots.
class ViewerPanel {
 public:
  static constexpr float kWidth = 420, kPlotHeight = 150;  // pixels

  /// `picture`: the settings of the command line, which resets return to.
  ViewerPanel(const PictureOptions& picture, const std::string& preset_file);

  /// Draws all panels into a window of that size, pixels.
  PanelRequests draw(ViewerSession& session, NetworkList& network, const RenderStatistics& rendered,
                     float width, float height);
  /// Adds to the plots; call once per picture.
  void measure(ViewerSession& session, const RenderStatistics& rendered, double pictures_per_second);
  /// Logs a line for the user; the newest is shown first.
  void say(const std::string& message);
  /// Applies a preset over the present settings.
  void loadPreset(ViewerSession& session);
  void setFields(std::vector<std::shared_ptr<const DistanceField>> fields);

  PictureOptions picture;
  MouseTool tool = MouseTool::kOrbit;
  HandSettings hand;
  bool shown = true, plots_shown = true, paused = false;

 private:
  void drawTop(ViewerSession& session, PanelRequests& requests);
  void drawTools(ViewerSession& session);
  void drawNetwork(ViewerSession& session, NetworkList& network, PanelRequests& requests);
  void drawParameters(ViewerSession& session);
  void drawPicture(PanelRequests& requests);
  void drawLights(PanelRequests& requests);
  void drawPasses(const RenderStatistics& rendered, PanelRequests& requests);
  void drawSlices(ViewerSession& session);
  void drawFields();
  void drawPresets(ViewerSession& session, PanelRequests& requests);
  void drawMessages();
  void drawPlots(float left, float top, float width);
  bool matches(const std::string& name) const;

  const PictureOptions usual_;
  std::string preset_file_, record_file_ = "take.rec", filter_;
  std::deque<std::string> messages_;
  Plot phases_{"time by phase", "ms", {}}, latency_{"latency", "ms", {}}, stretch_{"stretch", "%", {}},
      loss_{"frames", "", {}};
  ReceiveStatistics received_;
  bool slice_wanted_ = false;
  SliceRequest slice_request_;
  ImageTexture slice_, field_slice_;
  std::string slice_scale_;
  std::vector<std::shared_ptr<const DistanceField>> fields_;
  int field_ = 0, field_axis_ = 0;
  float field_part_ = 0.5f;
  bool field_stale_ = true;
};

}  // namespace strandcast
