#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/run_look.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/plot/plot.hpp"

namespace stillpoint {
namespace {

/// The relative pose errors of run and baseline, METHOD.md's figure 6: over a second and from frame to frame.
class ErrorsPanel final : public NamedPanel {
 public:
  explicit ErrorsPanel(Shared shared) : NamedPanel("errors", "Error over time", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {320.0F, 190.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (session.run->evaluation.matched.empty()) {
      draw_absent(frame, session.ground_truth->empty()
                             ? "This sequence has no ground truth to measure errors against."
                             : "No frame with a pose lies near a ground-truth pose yet.");
      return;
    }
    // Two plots one below the other where both can be read, else one of them.
    const bool both = ImGui::GetContentRegionAvail().y > kRoomForBoth * frame.scale;
    Controls controls(frame);
    if (!both)
      controls.choice("over", {session.run->evaluation.rpe_time.delta, "Frame"}, over_,
                      "What motions are measured over");
    controls.choice("of", {"Translation", "Rotation"}, of_);
    controls.toggle("Log scale", log_, "Errors on a logarithmic axis");
    collect(session);

    Footer footer;
    footer.caption = caption(session);
    const ImVec2 room = room_above(frame, footer);
    const ImVec2 size{room.x, both ? 0.5F * (room.y - ImGui::GetStyle().ItemSpacing.y) : room.y};
    if (both || over_ == kSecond) plot(frame, session, actions, &Curves::second, size);
    if (both || over_ == kFrame) plot(frame, session, actions, &Curves::frame, size);
    footer.draw(frame);
  }

 private:
  struct Curves {
    Series second, frame;
  };

  void collect(const SessionView& session) {
    const double start = series_start(session);
    Key key{session.run.get(), session.baseline.get(), session.revision, of_, {}};
    for (const GhostView& ghost : session.debug.ghosts)
      key.ghosts.emplace_back(ghost.run.get(), ghost.run->records.size());
    if (kept_ == key) return;
    kept_ = std::move(key);
    ghosts_.clear();
    for (const GhostView& ghost : session.debug.ghosts)
      ghosts_.push_back(curves(ghost.run->evaluation, start));
    run_ = curves(session.run->evaluation, start);
    baseline_ = session.baseline ? curves(session.baseline->evaluation, start) : Curves{};
  }

  [[nodiscard]] Curves curves(const TrajectoryEvaluation& evaluation, double start) const {
    return {error_series(evaluation.rpe_time, start, of_ == kRotation),
            error_series(evaluation.rpe_frame, start, of_ == kRotation)};
  }

  void plot(const UiFrame& frame, const SessionView& session, PanelActions& actions, Series Curves::*which,
            ImVec2 size) {
    const ThemeName theme = frame.theme.name;
    const Series &run = run_.*which, &baseline = baseline_.*which;
    Plot plot{.x_label = "time", .x_unit = "s"};
    const bool per_second = which == &Curves::second;
    plot.y_label = per_second ? "RPE over " + evaluation_of(session).rpe_time.delta : "RPE per frame";
    plot.y_unit = of_ == kRotation ? "°" : "mm";
    if (!baseline.x.empty()) {
      plot.series.push_back({baseline_name(session), baseline.x, baseline.y,
                             role_colour(Role::kBaseline, theme), SeriesStyle::kDashed});
    }
    add_ghosts(frame, session, which, plot);
    plot.series.push_back(
        {session.run->name, run.x, run.y, role_colour(Role::kEstimate, theme), SeriesStyle::kLine, 2.0F});
    plot.x_limits = record_range(session);
    plot.bands = lost_bands(session, role_colour(Role::kRemoved, theme));
    plot.cursor_x = session.current->frame.timestamp - series_start(session);
    view_[per_second].x = x_;
    view_[per_second].log_y = log_;
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const PlotResponse response =
        draw_plot(frame, per_second ? "rpe_over_time" : "rpe_per_frame", plot, view_[per_second], size);
    x_ = view_[per_second].x;
    if (run.x.empty() && baseline.x.empty()) {
      draw_label(frame, {corner.x + 0.3F * size.x, corner.y + 0.4F * size.y},
                 per_second
                     ? fmt::format("No two poses lie {} apart yet.", evaluation_of(session).rpe_time.delta)
                     : "No two neighbouring frames have poses yet.",
                 frame.theme.text_dim);
    }
    if (response.clicked_x) actions.go_to_frame = frame_at(session, *response.clicked_x);
  }

  /// Ghosts in the same axes, and where each parts from the run.
  void add_ghosts(const UiFrame& frame, const SessionView& session, Series Curves::*which, Plot& plot) const {
    for (std::size_t i = 0; i < ghosts_.size(); ++i) {
      const GhostView& ghost = session.debug.ghosts[i];
      const RunLook look = ghost_look(session.debug.ghosts, i, frame.theme.name);
      const Series& series = ghosts_[i].*which;
      plot.series.push_back({shortened(ghost.name, 24), series.x, series.y, look.colour, look.line, 2.0F});
      if (!ghost.diverged) continue;
      if (const auto at = record_of(session, *ghost.diverged))
        plot.marks.push_back({session.run->records.outlines()[*at].timestamp - series_start(session),
                              fmt::format("≠ at {}", *ghost.diverged), look.colour});
    }
  }

  [[nodiscard]] static const TrajectoryEvaluation& evaluation_of(const SessionView& session) {
    return session.run->evaluation;
  }

  /// ", 12.3 mm over 1 s"; nothing where no two poses are so far apart.
  [[nodiscard]] static std::string figure(const ErrorStatistics& statistics, double factor, const char* unit,
                                          const std::string& delta) {
    if (statistics.count == 0) return {};
    return fmt::format(", {:.3g} {} over {}", factor * statistics.rmse, unit, delta);
  }

  /// "paper: RMSE 28.7 mm over 1 s, ATE 19.4 mm" of such parts.
  [[nodiscard]] static std::string figures_of(const std::string& name, const std::string& rpe,
                                              const std::string& ate) {
    const std::string parts = (rpe.empty() ? "" : ", RMSE" + rpe.substr(1)) + ate;
    return parts.empty() ? name + ": no figures" : name + ":" + parts.substr(1);
  }

  [[nodiscard]] std::string caption(const SessionView& session) const {
    const auto figures = [this](const RunView& run, const std::string& name) {
      const auto& evaluation = run.evaluation;
      if (evaluation.matched.empty()) return fmt::format("{}: no figures", name);
      if (of_ == kRotation) {
        return figures_of(name,
                          figure(evaluation.rpe_time.rotation_deg, 1.0, "°", evaluation.rpe_time.delta) +
                              figure(evaluation.rpe_frame.rotation_deg, 1.0, "°", evaluation.rpe_frame.delta),
                          {});
      }
      const AbsoluteTrajectoryError& ate = evaluation.ate;
      return figures_of(
          name,
          figure(evaluation.rpe_time.translation_m, 1000.0, "mm", evaluation.rpe_time.delta) +
              figure(evaluation.rpe_frame.translation_m, 1000.0, "mm", evaluation.rpe_frame.delta),
          ate.why_none.empty() ? fmt::format(", ATE {:.3g} mm", 1000.0 * ate.translation_m.rmse)
                               : std::string());
    };
    std::string text = figures(*session.run, session.run->name);
    if (session.baseline) text += ".  " + figures(*session.baseline, baseline_name(session));
    for (const GhostView& ghost : session.debug.ghosts)
      text += ".  " + figures(*ghost.run, shortened(ghost.name));
    return text + ". Each error stands at the end of its motion.";
  }

  static constexpr float kRoomForBoth = 300.0F;  // design px
  enum Over { kSecond, kFrame };
  enum Of { kTranslation, kRotation };
  struct Key {
    const void *run = nullptr, *baseline = nullptr;
    std::uint64_t revision = 0;
    int of = 0;
    std::vector<std::pair<const RunView*, std::size_t>> ghosts{};  // with how many records
    bool operator==(const Key&) const = default;
  };

  int over_ = kSecond, of_ = kTranslation;
  bool log_ = false;
  Key kept_;
  Curves run_, baseline_;
  std::vector<Curves> ghosts_;
  PlotView view_[2];
  std::optional<AxisRange> x_;  // both plots show the same time
};

}  // namespace

std::unique_ptr<Panel> make_errors_panel(Shared shared) {
  return std::make_unique<ErrorsPanel>(std::move(shared));
}

}  // namespace stillpoint
