#include "ui/panels/timeline_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/counted.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/motion/figure_info.hpp"
#include "core/run/frame_figures.hpp"
#include "ui/panels/run_look.hpp"
#include "ui/panels/run_series.hpp"
#include "ui/session/data_sources.hpp"

namespace stillpoint {
namespace {

bool tells_keyframes(const SessionView& session) {
  const auto& records = session.run->records;
  return records.empty() || records.front().measured.keyframes;
}

}  // namespace

Rgb lane_colour(const FigureInfo& figure, ThemeName theme) {
  switch (figure.unit) {
    case FigureUnit::metres:
    case FigureUnit::degrees:
      return role_colour(Role::kEstimate, theme);
    case FigureUnit::share:
      return role_colour(Role::kUnion, theme);
    default:
      break;
  }
  if (figure.worse == WorseWhen::low) return role_colour(Role::kInlier, theme);
  return theme == ThemeName::kDark ? okabe_ito::kOrange : Rgb{0xB0, 0x75, 0x00};
}

std::string lane_text(double value, const FigureInfo& figure) {
  if (!std::isfinite(value)) return "–";
  if (figure.unit == FigureUnit::truth) return value != 0.0 ? "yes" : "no";
  return format_value(std::round(value * 10.0) / 10.0, shown_unit(figure.unit).unit);
}

void TimelineRows::status(float top, float bottom) const {
  paint_.ground(top, bottom, model_.frames.back());
  paint_.name(top, "Status", frame_.theme.text);
  paint_.status(model_.frames, model_.badness, top, bottom);
  const FrameRecord* record = session_.current->record;
  if (record != nullptr) paint_.value(top, std::string(to_string(record->status)), frame_.theme.text);
}

void TimelineRows::marks(float top, float bottom) const {
  const ThemeName theme = frame_.theme.name;
  const float height = bottom - top, middle = 0.5F * (top + bottom);
  const std::vector<int> hits = hit_frames(session_.debug);
  paint_.ground(top, bottom, model_.frames.back());
  paint_.name(top, "Marks", frame_.theme.text);
  paint_.signs(model_.keyframes, Sign::kDiamond, role_colour(Role::kEstimate, theme), middle, 0.24F * height);
  paint_.signs(hurt_frames(session_.debug), Sign::kCross, role_colour(Role::kOutlier, theme), middle,
               0.24F * height);
  paint_.signs(hits, Sign::kTriangle, role_colour(Role::kOutlier, theme), bottom - 0.3F * height,
               0.3F * height);
  paint_.signs(bookmarked_frames(session_.debug), Sign::kFlag, role_colour(Role::kWarning, theme), middle,
               0.42F * height);
  paint_.value(top,
               hits.empty() ? (tells_keyframes(session_) ? counted(model_.keyframes.size(), "keyframe")
                                                         : std::string())
                            : fmt::format("{} hit{}", hits.size(), hits.size() == 1 ? "" : "s"),
               frame_.theme.text);
}

void TimelineRows::ghost(std::size_t index, float top, float bottom) const {
  const GhostView& one = session_.debug.ghosts[index];
  const RunLook look = ghost_look(session_.debug.ghosts, index, frame_.theme.name);
  const auto& frames = model_.ghost_frames[index];
  paint_.ground(top, bottom, frames.empty() ? -1 : frames.back());
  paint_.name_sign(top, bottom, look.sign, look.colour);
  paint_.name(top, one.name, frame_.theme.text, 12.0F * frame_.scale);
  paint_.status(frames, model_.ghost_badness[index], 0.5F * (top + bottom), bottom);
  paint_.signs({one.from}, Sign::kLine, look.colour, 0.5F * (top + bottom), 3.0F * frame_.scale);
  if (one.diverged)
    paint_.signs({*one.diverged}, look.sign, look.colour, 0.5F * (top + bottom), 5.0F * frame_.scale);
  paint_.value(top,
               one.busy       ? "running…"
               : one.diverged ? fmt::format("≠ at {}", *one.diverged)
                              : "the same",
               frame_.theme.text_dim);
}

std::string frame_report(const SessionView& session, const TimelineModel& model, int index) {
  const auto at = record_of(session, index);
  if (!at) {
    return fmt::format("frame {}\nnot processed yet", index);
  }
  const FrameRecord& record = session.run->records[*at];
  std::string text = fmt::format("frame {}, {:.3f} s\n{}", index, record.timestamp - series_start(session),
                                 to_string(record.status));
  if (record.keyframe) text += ", keyframe";
  if (const std::string remarks = remarks_on(record); !remarks.empty()) text += "\n" + remarks;
  for (const TimelineLane& lane : model.lanes) {
    const FigureInfo& info = frame_figure_infos()[static_cast<std::size_t>(lane.figure)];
    bool known = std::isfinite(lane.values[*at]);
    std::string line = fmt::format("\n{} {}", shown_name(info), lane_text(lane.values[*at], info));
    for (std::size_t g = 0; g < lane.ghosts.size(); ++g)
      if (const auto there = record_of(*session.debug.ghosts[g].run, index)) {
        known = known || std::isfinite(lane.ghosts[g][*there]);
        line += fmt::format(", ghost {} {}", g + 1, lane_text(lane.ghosts[g][*there], info));
      }
    if (known) text += line;
  }
  for (const BreakpointView& one : session.debug.breakpoints)
    if (std::binary_search(one.hits.begin(), one.hits.end(), index))
      text += "\nbreakpoint: " + one.breakpoint.expression;
  const std::vector<int> hurt = hurt_frames(session.debug);
  if (std::binary_search(hurt.begin(), hurt.end(), index)) text += "\nremoval made it worse";
  if (const Bookmark* bookmark = bookmark_at(session.debug, index))
    text += "\nbookmark" + (bookmark->note.empty() ? "" : ": " + bookmark->note);
  return text;
}

Footer timeline_footer(const UiFrame& frame, const SessionView& session, const FigureInfo& worst_by) {
  const ThemeName theme = frame.theme.name;
  Footer footer;
  std::array<int, 5> counts{};
  for (const FrameOutline& one : session.run->records.outlines())
    ++counts[static_cast<std::size_t>(one.status)];
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    LegendEntry entry = look_of(static_cast<FrameStatus>(i), theme);
    entry.name = fmt::format("{} {}", counts[i], entry.name);
    footer.legend.push_back(std::move(entry));
  }
  if (tells_keyframes(session))
    footer.legend.push_back({"keyframe", role_colour(Role::kEstimate, theme), Sign::kDiamond});
  if (!session.debug.breakpoints.empty())
    footer.legend.push_back({"breakpoint hit", role_colour(Role::kOutlier, theme), Sign::kTriangle});
  if (!session.debug.bookmarks.empty())
    footer.legend.push_back({"bookmark", role_colour(Role::kWarning, theme), Sign::kFlag});
  if (!hurt_frames(session.debug).empty())
    footer.legend.push_back({"removal hurt", role_colour(Role::kOutlier, theme), Sign::kCross});
  footer.legend.push_back(
      {"worst by " + shown_name(worst_by), role_colour(Role::kWarning, theme), Sign::kRing});
  footer.caption = fmt::format(
      "Frame {} of {}; {} processed. Drag in the top row, or with Shift, to select a "
      "range.",
      session.current->index, session.frame_count, session.processed);
  if (session.debug.span)
    footer.caption = fmt::format("Frame {} of {}; frames {} to {} selected{}.", session.current->index,
                                 session.frame_count, session.debug.span->first, session.debug.span->last,
                                 session.debug.loop ? ", played over and over" : "");
  return footer;
}

}  // namespace stillpoint
