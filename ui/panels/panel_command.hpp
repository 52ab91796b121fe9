#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ui/shell/input.hpp"

namespace stillpoint {

struct PanelActions;
struct SessionView;

/// Something a panel can have done, by menu, key and palette, whether or not it is drawn.
struct PanelCommand {
  std::string name;   ///< "stage_next"
  std::string title;  ///< "Next stage of the frame"
  std::string group;  ///< the menu it stands in
  std::string icon;
  std::vector<KeyChord> keys{};
  bool repeats = false;                               ///< while its key is held
  bool shows = false;                                 ///< brings its panel up where it is not shown
  std::function<bool(const SessionView&)> enabled{};  ///< always, when empty
  std::string off{};                                  ///< why it is not, for people
  std::function<void(const SessionView&, PanelActions&)> run;
};

}  // namespace stillpoint
