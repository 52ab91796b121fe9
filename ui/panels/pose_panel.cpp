#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/evaluation/pose_series.hpp"
#include "core/evaluation/trajectory_metrics.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/run_look.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/plot/plot.hpp"

namespace stillpoint {
namespace {

/// Poses number by number over time: run, baseline and ghosts, each aligned to the ground truth, beside it.
class PosePanel final : public NamedPanel {
 public:
  explicit PosePanel(Shared shared) : NamedPanel("pose", "Pose over time", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {340.0F, 240.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (session.run->trajectory.size() < 2) {
      draw_absent(frame, "No two frames have poses yet.");
      return;
    }
    Controls controls(frame);
    controls.choice("of", {"Position", "Rotation", "Speed"}, of_);
    const bool has_truth = !session.run->evaluation.matched.empty();
    if (has_truth)
      controls.toggle("Error", error_, "What each run's poses differ by from the ground truth's");
    collect(session, has_truth && error_);
    Footer footer;
    footer.caption = caption(has_truth);
    // All three one below the other where they can be read, else one of them.
    const bool all = of_ != kSpeed && ImGui::GetContentRegionAvail().y > kRoomForAll * frame.scale;
    if (of_ != kSpeed && !all)
      controls.choice("axis",
                      of_ == kRotation ? std::vector<std::string>{"Roll", "Pitch", "Yaw"}
                                       : std::vector<std::string>{"x", "y", "z"},
                      axis_);
    const int count = all ? 3 : 1;
    const ImVec2 room = room_above(frame, footer);
    const float gaps = static_cast<float>(count - 1) * ImGui::GetStyle().ItemSpacing.y;
    const ImVec2 size{room.x, (room.y - gaps) / static_cast<float>(count)};
    for (int i = 0; i < count; ++i)
      plot(frame, session, actions, all ? i : of_ == kSpeed ? 0 : axis_, i == 0, i + 1 == count, size);
    footer.draw(frame);
  }

 private:
  enum Of { kPosition, kRotation, kSpeed };
  struct Key {
    const void *run = nullptr, *baseline = nullptr;
    std::uint64_t revision = 0;
    bool error = false;
    std::vector<std::pair<const RunView*, std::size_t>> ghosts{};  // with how many records
    bool operator==(const Key&) const = default;
  };

  void collect(const SessionView& session, bool error) {
    Key key{session.run.get(), session.baseline.get(), session.revision, error, {}};
    for (const GhostView& ghost : session.debug.ghosts)
      key.ghosts.emplace_back(ghost.run.get(), ghost.run->records.size());
    if (kept_ == key) return;
    kept_ = std::move(key);
    const double start = series_start(session);
    truth_.reset();
    if (!error && !session.run->evaluation.matched.empty()) truth_ = truth_of(*session.run, start);
    baseline_.reset();
    if (session.baseline) baseline_ = curve_of(*session.baseline, start, error);
    ghosts_.clear();
    for (const GhostView& ghost : session.debug.ghosts) ghosts_.push_back(curve_of(*ghost.run, start, error));
    run_ = curve_of(*session.run, start, error);
  }

  static PoseSeries truth_of(const RunView& run, double start) {
    Trajectory truth;
    for (const MatchedPose& pose : run.evaluation.matched) truth.push_back({pose.timestamp, pose.truth});
    return pose_series(truth, start);
  }

  /// In the truth's world where there is truth, else in the run's own.
  static PoseSeries curve_of(const RunView& run, double start, bool error) {
    const TrajectoryEvaluation& evaluation = run.evaluation;
    if (evaluation.matched.empty()) return error ? PoseSeries() : pose_series(run.trajectory, start);
    Trajectory aligned;
    for (const MatchedPose& pose : evaluation.matched)
      aligned.push_back({pose.timestamp, evaluation.ate.alignment.truth_from_estimate * pose.estimate});
    const PoseSeries series = pose_series(aligned, start);
    return error ? difference(series, truth_of(run, start)) : series;
  }

  [[nodiscard]] const std::vector<double>& values(const PoseSeries& series, int which) const {
    const auto at = static_cast<std::size_t>(which);
    return of_ == kSpeed ? series.speed : of_ == kRotation ? series.angle[at] : series.position[at];
  }

  void plot(const UiFrame& frame, const SessionView& session, PanelActions& actions, int which, bool first,
            bool lowest, ImVec2 size) {
    constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"}, kTurns = {"roll", "pitch", "yaw"};
    const auto at = static_cast<std::size_t>(which);
    const ThemeName theme = frame.theme.name;
    Plot plot;
    if (lowest) plot.x_label = "time", plot.x_unit = "s";
    plot.y_label = of_ == kSpeed ? "speed" : of_ == kRotation ? kTurns[at] : kAxes[at];
    plot.y_unit = of_ == kSpeed ? "m/s" : of_ == kRotation ? "°" : "m";
    plot.y_from_zero = of_ == kSpeed;
    plot.legend = first;
    const auto add = [&](const std::string& name, const PoseSeries& series, Rgb colour, SeriesStyle style,
                         float width) {
      if (!series.time.empty())
        plot.series.push_back({name, series.time, values(series, which), colour, style, width});
    };
    if (truth_)
      add("ground truth", *truth_, role_colour(Role::kGroundTruth, theme), SeriesStyle::kLine, 1.6F);
    if (baseline_)
      add(baseline_name(session), *baseline_, role_colour(Role::kBaseline, theme), SeriesStyle::kDashed,
          1.6F);
    for (std::size_t i = 0; i < ghosts_.size(); ++i) {
      const RunLook look = ghost_look(session.debug.ghosts, i, theme);
      add(shortened(session.debug.ghosts[i].name, 24), ghosts_[i], look.colour, look.line, 2.0F);
    }
    add(session.run->name, run_, role_colour(Role::kEstimate, theme), SeriesStyle::kLine, 2.0F);
    plot.x_limits = record_range(session);
    plot.bands = lost_bands(session, role_colour(Role::kRemoved, theme));
    plot.cursor_x = session.current->frame.timestamp - series_start(session);
    PlotView& view = view_[static_cast<std::size_t>(of_)][at];
    view.x = x_;
    const PlotResponse response = draw_plot(frame, kAxes[at], plot, view, size);
    x_ = view.x;
    if (response.clicked_x) actions.go_to_frame = frame_at(session, *response.clicked_x);
  }

  [[nodiscard]] std::string caption(bool has_truth) const {
    const std::string what =
        of_ == kSpeed      ? "The camera's speed, from frame to frame."
        : of_ == kRotation ? "Roll, pitch and yaw of R = Rz(yaw) Ry(pitch) Rx(roll), turned on past 180°."
                           : "The camera's position.";
    if (!has_truth) return what + " There is no ground truth: the world is that of the first frame.";
    return what + (error_ ? " Aligned (SE(3)) less the ground truth at the same moment."
                          : " Runs are aligned (SE(3)) to the ground truth.");
  }

  static constexpr float kRoomForAll = 330.0F;  // design px

  int of_ = kPosition, axis_ = 0;
  bool error_ = false;
  Key kept_;
  std::optional<PoseSeries> truth_, baseline_;
  std::vector<PoseSeries> ghosts_;
  PoseSeries run_;
  std::array<std::array<PlotView, 3>, 3> view_;
  std::optional<AxisRange> x_;  // all plots show the same time
};

}  // namespace

std::unique_ptr<Panel> make_pose_panel(Shared shared) {
  return std::make_unique<PosePanel>(std::move(shared));
}

}  // namespace stillpoint
