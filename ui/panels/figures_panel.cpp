#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/figure_pairs.hpp"
#include "core/run/worst_frames.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/run_look.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/plot/plot.hpp"

namespace stillpoint {
namespace {

constexpr int kTime = -1;  // in place of a figure: over time

/// Any figure recorded of each frame over time, or against any other, for all runs.
class FiguresPanel final : public NamedPanel {
 public:
  explicit FiguresPanel(Shared shared) : NamedPanel("figures", "Figures", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {360.0F, 260.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (session.run->records.empty()) {
      draw_absent(frame, "No frame has been processed yet.");
      return;
    }
    if (y_ < 0) y_ = usual_figure(session.run->measured());
    if (frame.controls) {
      choose("##y", y_, false, frame);
      ImGui::SameLine();
      ImGui::AlignTextToFramePadding();
      ImGui::TextUnformatted("over");
      ImGui::SameLine();
      choose("##x", x_, true, frame);
    }
    collect(session);
    Footer footer;
    footer.caption = caption(session);
    draw_curves(frame, session, actions, room_above(frame, footer));
    footer.draw(frame);
  }

 private:
  struct Key {
    const void* run = nullptr;
    std::uint64_t revision = 0;
    int x = kTime, y = 0;
    std::vector<std::pair<const RunView*, std::size_t>> others{};  // with how many records
    bool operator==(const Key&) const = default;
  };

  void choose(const char* id, int& figure, bool with_time, const UiFrame& frame) {
    const std::vector<FigureInfo>& infos = frame_figure_infos();
    ImGui::SetNextItemWidth(170.0F * frame.scale);
    const std::string shown = figure == kTime ? "time" : shown_name(infos[static_cast<std::size_t>(figure)]);
    if (!ImGui::BeginCombo(id, shown.c_str(), ImGuiComboFlags_HeightLarge)) return;
    if (with_time && ImGui::Selectable("time", figure == kTime)) figure = kTime;
    for (int i = 0; i < static_cast<int>(infos.size()); ++i) {
      const FigureInfo& info = infos[static_cast<std::size_t>(i)];
      ImGui::PushID(i);
      if (ImGui::Selectable(shown_name(info).c_str(), i == figure)) figure = i;
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s\n%s", info.name.c_str(), info.help.c_str());
      ImGui::PopID();
    }
    ImGui::EndCombo();
  }

  void collect(const SessionView& session) {
    Key key{session.run.get(), session.revision, x_, y_, {}};
    if (session.baseline) key.others.emplace_back(session.baseline.get(), session.baseline->records.size());
    for (const GhostView& ghost : session.debug.ghosts)
      key.others.emplace_back(ghost.run.get(), ghost.run->records.size());
    if (kept_ == key) return;
    kept_ = std::move(key);
    const double start = series_start(session);
    run_ = curve_of(*session.run, start);
    baseline_ = session.baseline ? curve_of(*session.baseline, start) : FigurePairs();
    ghosts_.clear();
    for (const GhostView& ghost : session.debug.ghosts) ghosts_.push_back(curve_of(*ghost.run, start));
    views_ = {};
  }

  [[nodiscard]] FigurePairs curve_of(const RunView& run, double start) const {
    FigurePairs curve;
    if (x_ == kTime) {  // what is not known is a gap
      curve.y = frame_figure_values(run.measured(), y_);
      for (const FrameOutline& frame : run.records.outlines()) {
        curve.x.push_back(frame.timestamp - start);
        curve.frames.push_back(frame.index);
      }
    } else {
      curve = figure_pairs(run.measured(), x_, y_);
      for (double& x : curve.x) x *= factor_of(x_);
    }
    for (double& y : curve.y) y *= factor_of(y_);
    return curve;
  }

  static double factor_of(int figure) {
    return shown_unit(frame_figure_infos()[static_cast<std::size_t>(figure)].unit).factor;
  }

  void draw_curves(const UiFrame& frame, const SessionView& session, PanelActions& actions, ImVec2 size) {
    const FigureInfo& y = frame_figure_infos()[static_cast<std::size_t>(y_)];
    const ThemeName theme = frame.theme.name;
    Plot plot{.y_label = shown_name(y), .y_unit = std::string(shown_unit(y.unit).unit)};
    if (x_ == kTime) {
      plot.x_label = "time", plot.x_unit = "s";
      plot.x_limits = record_range(session);
      plot.bands = lost_bands(session, role_colour(Role::kRemoved, theme));
      plot.cursor_x = session.current->frame.timestamp - series_start(session);
    } else {
      const FigureInfo& x = frame_figure_infos()[static_cast<std::size_t>(x_)];
      plot.x_label = shown_name(x), plot.x_unit = std::string(shown_unit(x.unit).unit);
    }
    const auto add = [&](const std::string& name, const FigurePairs& curve, Rgb colour, SeriesStyle line,
                         float width) {
      if (!curve.x.empty())
        plot.series.push_back(
            {name, curve.x, curve.y, colour, x_ == kTime ? line : SeriesStyle::kDots, width});
    };
    if (session.baseline)
      add(baseline_name(session), baseline_, role_colour(Role::kBaseline, theme), SeriesStyle::kDashed, 1.6F);
    for (std::size_t i = 0; i < ghosts_.size(); ++i) {
      const RunLook look = ghost_look(session.debug.ghosts, i, theme);
      add(shortened(session.debug.ghosts[i].name, 24), ghosts_[i], look.colour, look.line, 2.0F);
    }
    add(session.run->name, run_, role_colour(Role::kEstimate, theme), SeriesStyle::kLine, 2.0F);
    const auto here = std::find(run_.frames.begin(), run_.frames.end(), session.current->index);
    if (x_ != kTime && here != run_.frames.end())
      plot.marks.push_back({run_.x[static_cast<std::size_t>(here - run_.frames.begin())],
                            fmt::format("frame {}", session.current->index),
                            role_colour(Role::kCursor, theme)});
    const PlotResponse response = draw_plot(frame, "figures", plot, views_[x_ == kTime ? 0 : 1], size);
    if (!response.clicked_x) return;
    if (x_ == kTime)
      actions.go_to_frame = frame_at(session, *response.clicked_x);
    else if (const auto nearest = nearest_index(run_.x, *response.clicked_x))
      actions.go_to_frame = run_.frames[*nearest];
  }

  /// Over how many frames, and how far the two go together.
  [[nodiscard]] std::string caption(const SessionView& session) const {
    const FigureInfo& y = frame_figure_infos()[static_cast<std::size_t>(y_)];
    const auto known = std::count_if(run_.y.begin(), run_.y.end(), [](double v) { return !std::isnan(v); });
    std::string text =
        fmt::format("{}: known of {} of {} frames.", y.help, known, session.run->records.size());
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    if (x_ == kTime) return text;
    if (const auto together = rank_correlation(run_))
      text += fmt::format(" With {} it goes along to {:+.2f} (Spearman's rank correlation).",
                          shown_name(frame_figure_infos()[static_cast<std::size_t>(x_)]), *together);
    return text;
  }

  int x_ = kTime, y_ = -1;  // indices into frame_figure_infos(); y_ below 0: the usual one
  Key kept_;
  FigurePairs run_, baseline_;
  std::vector<FigurePairs> ghosts_;
  std::array<PlotView, 2> views_;  // over time, against a figure
};

}  // namespace

std::unique_ptr<Panel> make_figures_panel(Shared shared) {
  return std::make_unique<FiguresPanel>(std::move(shared));
}

}  // namespace stillpoint
