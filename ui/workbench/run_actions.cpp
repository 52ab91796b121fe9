// Which runs pictures show: alone, wiped against each other, or one after the other.
#include <fmt/format.h>

#include <algorithm>

#include "ui/theme/icons.hpp"
#include "ui/workbench/palette.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint {

void Workbench::add_run_actions() {
  const auto has_several = [this] { return session_ != nullptr && runs_.chosen_of(*session_).size() > 1; };
  const auto why_not = [this] {
    return session_ == nullptr ? std::string() : runs_.why_not_several(*session_);
  };
  // What is on can be put off, whatever runs are left.
  const auto has_several_or_wipes = [this, has_several] {
    return has_several() || runs_.pictures == RunPictures::wiped;
  };
  const auto add = [&](const char* name, const char* title, const char* icon, KeyChord key,
                       std::function<bool()> enabled, std::function<bool()> checked,
                       std::function<void()> run) {
    actions_.add({.name = name,
                  .title = title,
                  .group = "View",
                  .icon = icon,
                  .keys = key.key == Key::kNone ? std::vector<KeyChord>{} : std::vector{key},
                  .enabled = std::move(enabled),
                  .why_off = why_not,
                  .checked = std::move(checked),
                  .run = std::move(run)});
  };
  const auto is = [this](RunPictures pictures) {
    return [this, pictures] { return runs_.pictures == pictures; };
  };
  add("wipe_runs", "Wipe runs against each other in pictures", icons::kContrast, {Key::kW, {}},
      has_several_or_wipes, is(RunPictures::wiped), [this] {
        const bool wiped = runs_.pictures == RunPictures::wiped;
        runs_.pictures = wiped ? RunPictures::alone : RunPictures::wiped;
      });
  add("flip_runs", "Flip pictures to the next run", icons::kSwap, {Key::kF, {}}, has_several,
      is(RunPictures::flipped), [this] { runs_.flip(*session_, 1); });
  add("flip_runs_back", "Flip pictures to the run before", icons::kSwap, {Key::kF, kShift}, has_several, {},
      [this] { runs_.flip(*session_, -1); });
  actions_.add({.name = "runs_alone",
                .title = "Pictures of this run alone",
                .group = "View",
                .icon = icons::kImage,
                .enabled = [this] { return runs_.pictures != RunPictures::alone; },
                .off = "They are.",
                .run = [this] { runs_.pictures = RunPictures::alone; }});
}

void Workbench::add_picture_rows(std::vector<PaletteRow>& rows) {
  const std::vector<ListedRun> chosen = runs_.chosen_of(*session_), all = listed_runs(*session_);
  if (all.size() < 2) return;
  for (const ListedRun& run : all) {
    const bool on =
        std::any_of(chosen.begin(), chosen.end(), [&](const ListedRun& one) { return one.name == run.name; });
    rows.push_back({.icon = on ? icons::kHide : icons::kShow,
                    .title = on ? fmt::format("Leave {} out of wiped pictures", run.name)
                                : fmt::format("Take {} into wiped pictures", run.name),
                    .words = "run flip",
                    .run = [this, name = run.name] {
                      if (session_ != nullptr) runs_.toggle(*session_, name);
                    }});
    if (run.kind == ListedRun::Kind::own) continue;
    const bool hidden = runs_.hides(run.name);
    rows.push_back({.icon = hidden ? icons::kShow : icons::kHide,
                    .title = hidden ? fmt::format("Show {} in plots and the trajectory", run.name)
                                    : fmt::format("Hide {} in plots and the trajectory", run.name),
                    .words = "run table",
                    .run = [this, name = run.name] { runs_.toggle_hidden(name); }});
  }
}

}  // namespace stillpoint
