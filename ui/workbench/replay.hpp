#pragma once

#include <filesystem>
#include <functional>

#include "ui/shell/offscreen.hpp"
#include "ui/shell/recording.hpp"
#include "ui/shell/window.hpp"
#include "ui/workbench/app_controller.hpp"

namespace stillpoint {

/// What a replay does to a shell; window and offscreen alike.
struct ReplayShell {
  Canvas* canvas = nullptr;
  std::function<UiFrame(const FrameFunction&)> draw;
  std::function<cv::Mat(const FrameFunction&)> capture;  ///< draws a frame and gives what it shows
  std::function<void(int, int)> resize;                  ///< px
};
[[nodiscard]] ReplayShell replay_shell(Window& window);
[[nodiscard]] ReplayShell replay_shell(Offscreen& offscreen);

struct ReplayOptions {
  std::filesystem::path out{};            ///< folder for screenshots, which must be there
  double patience_s = 120.0;              ///< how long something may take to come to rest, wall time
  std::function<void()> between = [] {};  ///< called between frames of the interface; may throw
};

struct ReplayResult {
  int events = 0, screenshots = 0;
  bool quit = false;  ///< it ended the program
};

/// Throws InputError, naming the line, when a recording was made of another sequence than `source`.
void require_same_sequence(const Recording& recording, const FrameSource& source);

/// Plays a recording on a controller that was opened as the recording's start says.
/// @throws InputError with file and line: an action, panel or fact there is not, what was expected and does
/// not hold, what does not come to rest, a screenshot that cannot be written
ReplayResult replay(const Recording& recording, AppController& controller, const ReplayShell& shell,
                    const ReplayOptions& options = {});

}  // namespace stillpoint
