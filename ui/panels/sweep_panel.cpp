#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "core/error.hpp"
#include "core/parameter.hpp"
#include "core/run/ablation.hpp"
#include "core/run/sweep.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/panel.hpp"
#include "ui/panels/panel_kit.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/panels/parameter_rows.hpp"
#include "ui/plot/plot.hpp"
#include "ui/session/debug_view.hpp"
#include "ui/session/session_view.hpp"
#include "ui/shell/ui_frame.hpp"

namespace stillpoint {
namespace {

/// One parameter at several values, a run each: what error and masks become.
class SweepPanel final : public NamedPanel {
 public:
  explicit SweepPanel(Shared shared) : NamedPanel("sweep", "Parameter sweep", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {400.0F, 280.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (frame.controls) draw_question(frame, session, actions);
    const std::optional<SweepView>& sweep = session.debug.sweep;
    if (!sweep) {
      draw_absent(frame,
                  "A parameter and where it goes from and to: the sequence's first frames are run at each "
                  "value, beside the session.");
      return;
    }
    collect(*sweep);
    draw_progress(frame, *sweep, actions);
    if (sweep->points.empty()) {
      draw_absent(frame, !sweep->problem.empty() ? sweep->problem
                         : sweep->busy           ? "The first value is being run."
                                                 : "It was stopped before the first value was done.");
      return;
    }
    draw_chosen(session, *sweep, actions, frame);
    const Footer footer = footer_of(*sweep);
    const ImVec2 room = room_above(frame, footer);
    const bool masks = std::any_of(iou_.begin(), iou_.end(), [](double iou) { return !std::isnan(iou); });
    const float gap = ImGui::GetStyle().ItemSpacing.y;
    const ImVec2 size{room.x, masks ? 0.5F * (room.y - gap) : room.y};
    plot(frame, *sweep, "rpe", "RPE over 1 s", "mm", rpe_, role_colour(Role::kEstimate, frame.theme.name),
         size);
    if (masks)
      plot(frame, *sweep, "iou", "mask IoU", "%", iou_, role_colour(Role::kUnion, frame.theme.name), size);
    footer.draw(frame);
  }

 private:
  void draw_question(const UiFrame& frame, const SessionView& session, PanelActions& actions) {
    const float width = std::min(240.0F * frame.scale, ImGui::GetContentRegionAvail().x);
    ImGui::SetNextItemWidth(width);
    if (ImGui::BeginCombo("##parameter", parameter_.empty() ? "Parameter…" : parameter_.c_str(),
                          ImGuiComboFlags_HeightLarge)) {
      ImGui::SetNextItemWidth(-1.0F);
      if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
      ImGui::InputTextWithHint("##filter", "Search", filter_.data(), filter_.size());
      Config config = session.config;
      for (const Parameter& parameter : parameters(config)) {
        if (std::holds_alternative<std::string*>(parameter.value) || !matches(parameter, filter_.data()))
          continue;
        if (ImGui::Selectable(parameter.key.c_str(), parameter.key == parameter_)) {
          const SweepRange usual = usual_sweep(session.config, parameter.key);
          parameter_ = usual.parameter, low_ = usual.low, high_ = usual.high;
        }
        if (ImGui::IsItemHovered())
          ImGui::SetTooltip("%s\n%s", parameter.help.c_str(), range_text(parameter).c_str());
      }
      ImGui::EndCombo();
    }
    const float field = 74.0F * frame.scale;
    number("from", low_, field);
    number("to", high_, field);
    whole("values", steps_, 0.6F * field);
    whole("frames", frames_, field);
    steps_ = std::clamp(steps_, 2, 50), frames_ = std::clamp(frames_, 0, session.frame_count);
    Controls controls(frame);
    const bool busy = session.debug.sweep && session.debug.sweep->busy;
    ImGui::BeginDisabled(parameter_.empty() || busy);
    if (controls.button("Sweep", "Runs the first frames (0 = all) once at each value")) {
      const SweepRange range{parameter_, low_, high_, steps_};
      actions.requests.emplace_back(
          request::Sweep{session.debug.preview_config.value_or(session.config), range, frames_});
    }
    ImGui::EndDisabled();
  }

  /// A field's name before it, on the line of the one before where there is room.
  static void name_field(const char* name, float width) {
    ImGui::SameLine();
    const float gap = ImGui::GetStyle().ItemInnerSpacing.x;
    if (ImGui::GetContentRegionAvail().x < width + gap + ImGui::CalcTextSize(name).x) ImGui::NewLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(name);
    ImGui::SameLine(0.0F, gap);
    ImGui::SetNextItemWidth(width);
  }
  static void number(const char* name, double& value, float width) {
    name_field(name, width);
    ImGui::InputDouble(fmt::format("##{}", name).c_str(), &value, 0.0, 0.0, "%.4g");
  }
  static void whole(const char* name, int& value, float width) {
    name_field(name, width);
    ImGui::InputInt(fmt::format("##{}", name).c_str(), &value, 0);
  }

  static void draw_progress(const UiFrame& frame, const SweepView& sweep, PanelActions& actions) {
    if (!sweep.busy) return;
    const auto done = sweep.points.size(), all = sweep.values.size();
    ImGui::ProgressBar(static_cast<float>(done) / static_cast<float>(std::max<std::size_t>(1, all)),
                       {200.0F * frame.scale, 0.0F}, fmt::format("{} of {}", done, all).c_str());
    if (!frame.controls) return;
    ImGui::SameLine();
    if (ImGui::Button("Stop")) actions.requests.emplace_back(request::StopSweep{});
  }

  void collect(const SweepView& sweep) {
    values_.clear(), rpe_.clear(), iou_.clear();
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (const SweepPoint& point : sweep.points) {
      values_.push_back(point.value);
      rpe_.push_back(point.reached.rpe_m ? 1000.0 * *point.reached.rpe_m : none);
      iou_.push_back(point.reached.mask_iou ? 100.0 * *point.reached.mask_iou : none);
    }
    if (chosen_ >= values_.size()) chosen_ = best_of(sweep.points).value_or(0);
    if (of_ != sweep.range) chosen_ = best_of(sweep.points).value_or(0);
    of_ = sweep.range;
  }

  /// What the value chosen reached, and what can be done with it.
  void draw_chosen(const SessionView& session, const SweepView& sweep, PanelActions& actions,
                   const UiFrame& frame) const {
    const SweepPoint& point = sweep.points[chosen_];
    const AblationCell& cell = point.reached;
    std::string text = fmt::format("{:.6g}: ", point.value);
    text += cell.rpe_m ? fmt::format("RPE {:.1f} mm", 1000.0 * *cell.rpe_m) : std::string("no RPE");
    if (cell.mask_iou) text += fmt::format(", IoU {:.1f} %", 100.0 * *cell.mask_iou);
    if (cell.coverage < 1.0)
      text += fmt::format(", {:.1f} % of the frames have a pose", 100.0 * cell.coverage);
    ImGui::TextUnformatted(text.c_str());
    if (!frame.controls) return;
    Config config = swept(sweep.base, sweep.range.parameter, point.value);
    config.run.threads = session.config.run.threads;
    Controls controls(frame);
    if (controls.button("Try on this frame", "The frame shown is worked out anew with this value"))
      actions.requests.emplace_back(request::Preview{config});
    if (controls.button("Run beside", "As a second run beside this one, from the first frame on"))
      actions.requests.emplace_back(request::AddGhost{config, change_name(config, session.config), 0});
    if (controls.button("Run all", "This run begins anew with this value"))
      actions.requests.emplace_back(request::RunAll{config});
  }

  void plot(const UiFrame& frame, const SweepView& sweep, const char* id, const char* label, const char* unit,
            const std::vector<double>& y, Rgb colour, ImVec2 size) {
    Plot plot{.x_label = sweep.range.parameter, .y_label = label, .y_unit = unit};
    plot.series.push_back({label, values_, y, colour, SeriesStyle::kLine, 1.6F});
    plot.series.push_back({"", values_, y, colour, SeriesStyle::kDots});
    plot.x_limits = AxisRange{sweep.values.front(), sweep.values.back()};
    plot.cursor_x = values_[chosen_];
    plot.legend = false;
    Config base = sweep.base;
    for (const Parameter& parameter : parameters(base))
      if (parameter.key == sweep.range.parameter)
        if (const auto own = number_of(parameter))
          plot.marks.push_back({*own, "the run's", frame.theme.text_dim});
    PlotView& view = views_[id == std::string_view("iou") ? 1 : 0];
    view.x = x_;
    const PlotResponse response = draw_plot(frame, id, plot, view, size);
    x_ = view.x;
    if (response.clicked_x)
      if (const auto nearest = nearest_index(values_, *response.clicked_x)) chosen_ = *nearest;
  }

  [[nodiscard]] Footer footer_of(const SweepView& sweep) const {
    Footer footer;
    const std::string frames =
        sweep.frames > 0 ? fmt::format("the first {} frames", sweep.frames) : "all frames";
    footer.caption = fmt::format("Method {}, {} once at each of {} values of {}.", sweep.base.run.method,
                                 frames, sweep.values.size(), sweep.range.parameter);
    if (const auto best = best_of(sweep.points))
      footer.caption += fmt::format(
          " Least error at {:.6g}, {:.1f} mm; how far runs scatter by themselves, "
          "`benchmark --repeat` tells.",
          sweep.points[*best].value, rpe_[*best]);
    if (!sweep.problem.empty()) footer.caption += " Ended early: " + sweep.problem;
    return footer;
  }

  std::string parameter_;
  std::array<char, 64> filter_{};
  double low_ = 0.0, high_ = 1.0;
  int steps_ = 7, frames_ = 100;
  SweepRange of_;           // the sweep drawn last
  std::size_t chosen_ = 0;  // of its points
  std::vector<double> values_, rpe_, iou_;
  std::array<PlotView, 2> views_;
  std::optional<AxisRange> x_;  // both plots show the same values
};

}  // namespace

std::unique_ptr<Panel> make_sweep_panel(Shared shared) {
  return std::make_unique<SweepPanel>(std::move(shared));
}

}  // namespace stillpoint
