#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/inspect/frame_view.hpp"
#include "core/motion/methods.hpp"
#include "core/run/removal_errors.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/panel.hpp"
#include "ui/panels/panel_kit.hpp"
#include "ui/panels/panels_shared.hpp"
#include "ui/panels/removal_summary.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/plot/plot.hpp"
#include "ui/session/data_sources.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"

namespace stillpoint {
namespace {

/// Did removal help? Each frame's step solved with what the method removed, with nothing removed and with
/// what is truly dynamic removed, from the same map.
class RemovalPanel final : public NamedPanel {
 public:
  explicit RemovalPanel(Shared shared) : NamedPanel("removal", "Did removal help?", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {300.0F, 230.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (session.debug.removal->empty()) {
      draw_unchecked(frame, session, actions);
      return;
    }
    collect(session);
    draw_head(frame, session, actions);
    Footer footer;
    footer.legend = {{"helped", helped_colour(), Sign::kSquare}, {"hurt", hurt_colour(frame), Sign::kCircle}};
    footer.caption = caption();
    const ImVec2 room = room_above(frame, footer);
    draw_plot_of(frame, session, actions, room);
    footer.draw(frame);
  }

 private:
  [[nodiscard]] static Rgb helped_colour() { return okabe_ito::kGreen; }
  [[nodiscard]] static Rgb hurt_colour(const UiFrame& frame) {
    return role_colour(Role::kOutlier, frame.theme.name);
  }

  /// Why there is nothing to see, and the way to it where there is one.
  static void draw_unchecked(const UiFrame& frame, const SessionView& session, PanelActions& actions) {
    if (!session.outside.empty()) {
      draw_absent(frame, fmt::format("{} was run by another program: its poses cannot be solved again here.",
                                     session.outside));
    } else if (method_of(session.config).baseline) {
      draw_absent(frame, fmt::format("Method {} removes nothing: there is nothing to check.",
                                     session.config.run.method));
    } else if (session.ground_truth->empty()) {
      draw_absent(frame, "Without ground truth nobody can tell whether removal helped.");
    } else if (session.config.run.check_removal != 0) {
      draw_absent(frame, "No frame has been solved with and without removal yet.");
    } else {
      Controls controls(frame);
      if (controls.button("Check removal", "This run begins anew, with run.check_removal = 1")) {
        Config config = session.config;
        config.run.check_removal = 1;
        actions.requests.push_back(request::RunAll{config});
      }
      draw_absent(frame,
                  "Each frame's pose can be solved again without removal, and with the true mask where it is "
                  "known: that tells whether removal helped. It makes a run somewhat slower.");
    }
  }

  void collect(const SessionView& session) {
    const auto& errors = *session.debug.removal;
    index_.clear();
    for (Series* series : {&with_, &without_, &oracle_, &hurt_}) *series = {};
    for (const RemovalError& one : errors) {
      const double frame = one.frame;
      // Where frames are missing between, so is the line.
      if (!index_.empty() && one.frame > index_.back() + 1) {
        for (Series* series : {&with_, &without_, &oracle_}) {
          series->x.push_back(frame - 0.5);
          series->y.push_back(std::nan(""));
        }
      }
      index_.push_back(one.frame);
      const auto add = [frame](Series& series, double metres) {
        series.x.push_back(frame);
        series.y.push_back(1000.0 * metres);
      };
      add(with_, one.with_removal_m);
      add(without_, one.without_removal_m);
      add(oracle_, one.oracle_m);
      if (one.hurt) add(hurt_, one.with_removal_m);
    }
    summary_ = summarise(errors);
  }

  void draw_head(const UiFrame& frame, const SessionView& session, PanelActions& actions) {
    ImGui::PushFont(frame.fonts.strong);
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextUnformatted(sentence_of(summary_).c_str());
    ImGui::PopTextWrapPos();
    ImGui::PopFont();
    Controls controls(frame);
    const int here = session.current->index;
    const auto jump = [&](const char* label, const char* tooltip, std::optional<int> to) {
      ImGui::BeginDisabled(!to);
      if (controls.button(label, tooltip) && to) actions.go_to_frame = to;
      ImGui::EndDisabled();
    };
    const std::vector<int> hurt = hurt_frames(session.debug);
    jump("Worst hurt", "Where removal did most harm",
         summary_.worst_frame >= 0 ? std::optional(summary_.worst_frame) : std::nullopt);
    jump(icons::kChevronLeft, "Hurt before this frame (Shift+J)", previous_in(hurt, here));
    jump(icons::kChevronRight, "Hurt after this frame (J)", next_in(hurt, here));
    jump("Most helped", "Where removal gained most",
         summary_.best_frame >= 0 ? std::optional(summary_.best_frame) : std::nullopt);
    controls.toggle("Log scale", log_, "Errors on a logarithmic axis");
  }

  void draw_plot_of(const UiFrame& frame, const SessionView& session, PanelActions& actions, ImVec2 size) {
    const ThemeName theme = frame.theme.name;
    Plot plot{.x_label = "frame", .y_label = "step error", .y_unit = "mm", .x_step = 1.0};
    for (const RemovalError& one : *session.debug.removal) {
      if (!one.hurt && !one.helped) continue;
      plot.bands.push_back({{one.frame - 0.5, one.frame + 0.5},
                            one.hurt ? hurt_colour(frame) : helped_colour(),
                            one.hurt ? 0.28F : 0.12F});
    }
    plot.series.push_back({"without removal", without_.x, without_.y, role_colour(Role::kBaseline, theme),
                           SeriesStyle::kDashed});
    if (summary_.oracle > 0)
      plot.series.push_back({"ground-truth mask", oracle_.x, oracle_.y,
                             role_colour(Role::kGroundTruth, theme), SeriesStyle::kDotted});
    plot.series.push_back(
        {"with removal", with_.x, with_.y, role_colour(Role::kEstimate, theme), SeriesStyle::kLine, 2.0F});
    if (!hurt_.x.empty())
      plot.series.push_back({"hurt", hurt_.x, hurt_.y, hurt_colour(frame), SeriesStyle::kDots, 2.2F});
    plot.cursor_x = session.current->index;
    plot.x_limits = AxisRange{static_cast<double>(index_.front()),
                              std::max(static_cast<double>(index_.back()), index_.front() + 1.0)};
    view_.log_y = log_;
    const PlotResponse response = draw_plot(frame, "removal", plot, view_, size);
    if (response.clicked_x)
      actions.go_to_frame = static_cast<int>(std::lround(
          std::clamp(*response.clicked_x, plot.x_limits->low, static_cast<double>(index_.back()))));
  }

  [[nodiscard]] std::string caption() const {
    std::string text = fmt::format("Median step error {:.3g} mm with removal, {:.3g} mm without",
                                   1000.0 * summary_.median_with_m, 1000.0 * summary_.median_without_m);
    if (summary_.oracle > 0)
      text += fmt::format(", {:.3g} mm by the ground-truth mask (oracle), which is worse in {} of {} frames",
                          1000.0 * summary_.median_oracle_m, summary_.beat_oracle, summary_.oracle);
    if (summary_.median_widened > 0)
      text +=
          fmt::format("; what was removed takes the position's σ to {:.2f} times", summary_.median_widened);
    if (summary_.worst_frame >= 0)
      text += fmt::format(". It hurt most at frame {}, by {:.3g} mm", summary_.worst_frame,
                          1000.0 * summary_.greatest_harm_m);
    return text + ".";
  }

  std::vector<int> index_;
  Series with_, without_, oracle_, hurt_;
  RemovalSummary summary_;
  PlotView view_;
  bool log_ = false;
};

}  // namespace

std::unique_ptr<Panel> make_removal_panel(Shared shared) {
  return std::make_unique<RemovalPanel>(std::move(shared));
}

}  // namespace stillpoint
