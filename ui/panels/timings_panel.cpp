#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "core/evaluation/tables.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/motion/stage_log.hpp"
#include "core/odometry/frame_record.hpp"
#include "ui/panels/all_panels.hpp"
#include "ui/panels/run_look.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/plot/right_click.hpp"
#include "ui/shell/ui_pace.hpp"
#include "ui/theme/fonts.hpp"

namespace stillpoint {
namespace {

struct Stage {
  const char* name;
  double StageTimes::*value;
};

constexpr std::array<Stage, 6> kStages{{{"Motion", &StageTimes::motion},
                                        {"Features", &StageTimes::features},
                                        {"Matching", &StageTimes::matching},
                                        {"Pose", &StageTimes::pose},
                                        {"Mapping", &StageTimes::mapping},
                                        {"Bundle", &StageTimes::bundle}}};
constexpr float kRoomForPlot = 110.0F;        // design px, least height of the plot above the table
constexpr double kFrameTime = 1000.0 / 30.0;  // ms, of a 30 Hz camera

struct Figures {
  double mean = 0.0, median = 0.0, p99 = 0.0;
};

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
constexpr Figures kNoFigures{kNotKnown, kNotKnown, kNotKnown};

Figures figures_of(std::vector<double> values) {
  if (values.empty()) return {};
  Figures figures;
  for (const double value : values) figures.mean += value / static_cast<double>(values.size());
  std::sort(values.begin(), values.end());
  const auto last = static_cast<double>(values.size() - 1);
  figures.median = values[static_cast<std::size_t>(std::lround(0.5 * last))];
  figures.p99 = values[static_cast<std::size_t>(std::lround(0.99 * last))];
  return figures;
}

/// What a ghost run's frames took: its own, from where it branched off.
struct GhostTimes {
  std::vector<double> index, total;
  std::array<Figures, kStages.size()> figures;
  Figures whole;
  std::size_t records = 0;
  const RunView* run = nullptr;
};

GhostTimes times_of(const GhostView& ghost) {
  GhostTimes times{.index = {},
                   .total = {},
                   .figures = {},
                   .whole = {},
                   .records = ghost.run->records.size(),
                   .run = ghost.run.get()};
  std::array<std::vector<double>, kStages.size()> values;
  for (const FrameRecord& record : ghost.run->records) {
    // Nobody held a clock to a run that another program made.
    if (record.index < ghost.from || !record.measured.times) continue;
    times.index.push_back(record.index);
    times.total.push_back(record.ms.total);
    for (std::size_t i = 0; i < kStages.size(); ++i) values[i].push_back(record.ms.*kStages[i].value);
  }
  times.figures.fill(kNoFigures);
  times.whole = kNoFigures;
  if (times.index.empty()) return times;
  for (std::size_t i = 0; i < kStages.size(); ++i) times.figures[i] = figures_of(std::move(values[i]));
  times.whole = figures_of(times.total);
  return times;
}

/// What each stage takes: stacked frame by frame, and in figures.
class TimingsPanel final : public NamedPanel {
 public:
  explicit TimingsPanel(Shared shared) : NamedPanel("timings", "Timings", std::move(shared)) {}

  [[nodiscard]] PanelSize least() const override { return {440.0F, 220.0F}; }

  void draw(UiFrame& frame, const SessionView& session, PanelActions& actions) override {
    if (session.run->records.empty()) {
      draw_absent(frame, "No frame has been processed yet.");
      return;
    }
    if (!session.run->records.back().measured.times) {
      draw_absent(frame, fmt::format("{} left no times.", session.run->name));
      return;
    }
    if (session.run->records.back().ms.total <= 0.0) {
      draw_absent(frame,
                  "Stage times differ from run to run, so this image leaves them out; --timings shows them.");
      return;
    }
    collect(session);
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float row = frame.fonts.text->FontSize + 2.0F * ImGui::GetStyle().CellPadding.y;
    const float table = row * static_cast<float>(kStages.size() + 2) + 2.0F * frame.scale;
    collect_ghosts(session);
    Footer footer;
    footer.caption =
        "Wall time. Motion and features run beside each other where threads allow, so stages may add up to "
        "more than the whole.";
    if (stereo_ms_ > 0.0)
      footer.caption +=
          fmt::format(" Matching left to right took {:.1f} ms a frame, median, while reading.", stereo_ms_);
    if (frame.pace != nullptr && frame.pace->busy_frames > 0)
      footer.caption += fmt::format(
          " The interface: {:.0f} ms a frame; beside work at the longest {:.0f} ms, {} of {} frames over "
          "{:.0f} ms.",
          frame.pace->mean_ms, frame.pace->longest_busy_ms, frame.pace->busy_over_limit,
          frame.pace->busy_frames, UiPace::kLimitMs);
    // In a low panel the plot alone is shown, and names the stages itself.
    const bool has_table = room.y > table + kRoomForPlot * frame.scale;
    const float below = footer.height(frame) + ImGui::GetStyle().ItemSpacing.y * (has_table ? 2.0F : 1.0F) +
                        (has_table ? table : 0.0F);
    draw_plot_of(frame, session, actions, !has_table,
                 {room.x, std::max(room.y - below, 60.0F * frame.scale)});
    if (has_table) draw_table(frame, session);
    footer.draw(frame);
  }

 private:
  [[nodiscard]] static Rgb colour_of(std::size_t stage) { return kSeriesColours[stage]; }

  void collect(const SessionView& session) {
    const FrameRecords& records = session.run->records;
    if (run_ == session.run.get() && revision_ == session.revision && index_.size() == records.size()) return;
    // The same run, grown: what was read of it before stays.
    const bool goes_on =
        columns_ != nullptr && columns_ == session.run->columns && index_.size() <= records.size();
    run_ = session.run.get();
    columns_ = session.run->columns;
    revision_ = session.revision;
    if (!goes_on) {
      index_.clear();
      total_.clear();
      stereo_.clear();
      for (auto* all : {&tops_, &values_})
        for (auto& one : *all) one.clear();
    }
    const auto end = records.end();
    for (auto at = records.begin() + static_cast<std::ptrdiff_t>(index_.size()); at != end; ++at) {
      const FrameRecord& record = *at;
      stereo_.push_back(record.ms.stereo);
      index_.push_back(record.index);
      total_.push_back(record.ms.total);
      double sum = 0.0;
      for (std::size_t i = 0; i < kStages.size(); ++i) {
        const double one = record.ms.*kStages[i].value;
        values_[i].push_back(one);
        sum += one;
        tops_[i].push_back(sum);
      }
    }
    for (std::size_t i = 0; i < kStages.size(); ++i) figures_[i] = figures_of(values_[i]);
    whole_ = figures_of(total_);
    stereo_ms_ = figures_of(stereo_).median;
  }

  void collect_ghosts(const SessionView& session) {
    const auto& all = session.debug.ghosts;
    ghosts_.resize(all.size());
    for (std::size_t i = 0; i < all.size(); ++i)
      if (ghosts_[i].run != all[i].run.get() || ghosts_[i].records != all[i].run->records.size())
        ghosts_[i] = times_of(all[i]);
  }

  void draw_plot_of(const UiFrame& frame, const SessionView& session, PanelActions& actions, bool named,
                    ImVec2 size) {
    Plot plot{.x_label = "frame", .y_label = "time a frame", .y_unit = "ms", .x_step = 1.0};
    // The highest stack first: each lower one is painted over it.
    for (std::size_t i = kStages.size(); i-- > 0;)
      plot.series.push_back(
          {named ? kStages[i].name : "", index_, tops_[i], colour_of(i), SeriesStyle::kBars});
    plot.series.push_back({"whole frame", index_, total_, frame.theme.text, SeriesStyle::kSteps, 1.5F});
    for (std::size_t i = 0; i < ghosts_.size(); ++i) {
      const RunLook look = ghost_look(session.debug.ghosts, i, frame.theme.name);
      plot.series.push_back({shortened(session.debug.ghosts[i].name, 24), ghosts_[i].index, ghosts_[i].total,
                             look.colour, look.line, 2.0F});
    }
    plot.levels.push_back({kFrameTime, "30 frames a second", role_colour(Role::kWarning, frame.theme.name)});
    plot.cursor_x = session.current->index + 0.5;
    const double first = index_.front(), last = index_.back();
    plot.x_limits = AxisRange{first, last + 1.0};
    const PlotResponse response = draw_plot(frame, "stack", plot, view_, size);
    if (response.clicked_x)
      actions.go_to_frame = static_cast<int>(std::floor(std::clamp(*response.clicked_x, first, last)));
  }

  [[nodiscard]] Table table_of(const SessionView& session) const {
    const FrameRecord* record = session.current->record;
    Table table{{"stage (ms)", "this frame", "mean", "median", "p99"}, {}};
    for (const GhostView& ghost : session.debug.ghosts) table.header.push_back("mean, " + ghost.name);
    const auto add = [&](const char* name, double now, const Figures& figures, const auto& of_ghost) {
      std::vector<std::string> row{name};
      const auto push = [&row](double value) {
        row.push_back(std::isnan(value) ? std::string() : fmt::format("{:.4f}", value));
      };
      for (const double value : {now, figures.mean, figures.median, figures.p99}) push(value);
      for (const GhostTimes& ghost : ghosts_) push(of_ghost(ghost).mean);
      table.rows.push_back(std::move(row));
    };
    for (std::size_t i = 0; i < kStages.size(); ++i)
      add(kStages[i].name, record == nullptr ? kNotKnown : record->ms.*kStages[i].value, figures_[i],
          [i](const GhostTimes& ghost) { return ghost.figures[i]; });
    add("whole frame", record == nullptr ? kNotKnown : record->ms.total, whole_,
        [](const GhostTimes& ghost) { return ghost.whole; });
    return table;
  }

  void draw_table(const UiFrame& frame, const SessionView& session) const {
    const FrameRecord* record = session.current->record;
    // Beside each mean stands that of every ghost.
    const int columns = 5 + static_cast<int>(ghosts_.size());
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const auto as_table = [&] { return table_of(session); };
    if (!ImGui::BeginTable("figures", columns,
                           ImGuiTableFlags_BordersInnerH | ImGuiTableFlags_SizingStretchSame))
      return;
    ImGui::TableSetupColumn("Stage, ms", ImGuiTableColumnFlags_WidthStretch, 1.6F);
    for (const char* name : {"this frame", "mean", "median", "p99"}) ImGui::TableSetupColumn(name);
    for (const GhostView& ghost : session.debug.ghosts)
      ImGui::TableSetupColumn(shortened("mean, " + ghost.name, 24).c_str());
    ImGui::TableHeadersRow();
    const auto cell = [&](double value) {
      ImGui::TableNextColumn();
      ImGui::PushFont(frame.fonts.mono);
      ImGui::TextUnformatted(std::isnan(value) ? "      –" : fmt::format("{:7.2f}", value).c_str());
      ImGui::PopFont();
    };
    const auto row = [&](const char* name, const Rgb& colour, Sign sign, double now, const Figures& figures,
                         const std::function<const Figures&(const GhostTimes&)>& of_ghost) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      const ImVec2 at = ImGui::GetCursorScreenPos();
      const float half = 0.5F * frame.fonts.text->FontSize;
      draw_sign(frame, *ImGui::GetWindowDrawList(), {at.x + half, at.y + half}, 4.5F * frame.scale, sign,
                to_u32(colour));
      ImGui::SetCursorPosX(ImGui::GetCursorPosX() + 22.0F * frame.scale);
      ImGui::TextUnformatted(name);
      cell(now);
      cell(figures.mean);
      cell(figures.median);
      cell(figures.p99);
      for (std::size_t i = 0; i < ghosts_.size(); ++i) {
        ImGui::PushStyleColor(ImGuiCol_Text,
                              to_vec4(ghost_look(session.debug.ghosts, i, frame.theme.name).colour));
        cell(of_ghost(ghosts_[i]).mean);
        ImGui::PopStyleColor();
      }
    };
    for (std::size_t i = 0; i < kStages.size(); ++i) {
      const double now = record != nullptr ? record->ms.*kStages[i].value : kNotKnown;
      row(kStages[i].name, colour_of(i), Sign::kSquare, now, figures_[i],
          [i](const GhostTimes& ghost) -> const Figures& { return ghost.figures[i]; });
    }
    row("Whole frame", frame.theme.text, Sign::kLine, record != nullptr ? record->ms.total : kNotKnown,
        whole_, [](const GhostTimes& ghost) -> const Figures& { return ghost.whole; });
    ImGui::EndTable();
    offer_table(frame, "timings", low, as_table);
  }

  std::vector<double> index_, total_;
  double stereo_ms_ = 0.0;
  std::array<std::vector<double>, kStages.size()> tops_;    // ms, each stage added to those before
  std::array<std::vector<double>, kStages.size()> values_;  // ms, of each stage
  std::vector<double> stereo_;                              // ms
  std::array<Figures, kStages.size()> figures_;
  Figures whole_;
  std::vector<GhostTimes> ghosts_;
  PlotView view_;
  const void* run_ = nullptr;
  std::shared_ptr<const FigureColumns> columns_;  // by which a run is known as it grows
  std::uint64_t revision_ = 0;
};

}  // namespace

std::unique_ptr<Panel> make_timings_panel(Shared shared) {
  return std::make_unique<TimingsPanel>(std::move(shared));
}

}  // namespace stillpoint
