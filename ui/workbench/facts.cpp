// Facts about the workbench by name, for recordings that expect one.
#include <fmt/format.h>

#include <array>
#include <utility>

#include "core/inspect/frame_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {
namespace {

std::string yes(bool is) { return is ? "yes" : "no"; }

constexpr std::array<const char*, 17> kFacts{
    "frame",  "frames",    "processed", "playing",   "dropped", "status",     "title",   "method", "message",
    "panels", "maximised", "theme",     "shortcuts", "palette", "log.errors", "choices", "runs"};

}  // namespace

std::string Workbench::fact_names() { return fmt::format("{}", fmt::join(kFacts, ", ")); }

std::optional<std::string> Workbench::fact(const std::string& what, const SessionView* session) const {
  const std::string none = "none";
  const auto of_session = [&](auto&& value) { return session == nullptr ? none : value(*session); };
  if (what == "frame")
    return of_session([](const SessionView& s) { return std::to_string(s.current->index); });
  if (what == "frames") return of_session([](const SessionView& s) { return std::to_string(s.frame_count); });
  if (what == "processed")
    return of_session([](const SessionView& s) { return std::to_string(s.processed); });
  if (what == "playing") return of_session([](const SessionView& s) { return yes(s.playing); });
  if (what == "status")
    return of_session([](const SessionView& s) {
      return s.current->record == nullptr ? std::string("unprocessed")
                                          : std::string(to_string(s.current->record->status));
    });
  if (what == "title") return of_session([](const SessionView& s) { return s.title; });
  // There "none" is a method.
  if (what == "method") return session == nullptr ? "no sequence" : maker_of(*session);
  if (what == "message") return message_.empty() ? none : message_;
  if (what == "panels") return fmt::format("{}", fmt::join(panels_of(layout_), ","));
  if (what == "maximised") return maximised_.empty() ? none : maximised_;
  if (what == "theme") return std::string(look_.theme == ThemeName::kDark ? "dark" : "light");
  if (what == "shortcuts") return yes(shortcuts_open_);
  if (what == "palette") return yes(palette_.open);
  if (what == "choices") {
    std::string text;
    for (const auto& [panel, choices] : choices_)
      for (const auto& [control, value] : choices.changed())
        text += fmt::format("{}{}: {}={}", text.empty() ? "" : ", ", panel, control, value);
    return text.empty() ? none : text;
  }
  if (what == "runs") {
    if (session == nullptr || runs_.pictures == RunPictures::alone) return to_string(RunPictures::alone);
    std::string text = to_string(runs_.pictures);
    const auto flipped = runs_.flipped(*session);
    for (const ListedRun& run : runs_.chosen_of(*session))
      text += fmt::format(" {}{}", run.name, flipped && flipped->name == run.name ? "*" : "");
    return text;
  }
  if (what == "dropped") return std::to_string(pace_ ? pace_->dropped : last_dropped_);
  if (what == "log.errors") return std::to_string(log_.errors());
  return std::nullopt;
}

}  // namespace stillpoint
