#pragma once

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <variant>
#include <vector>

#include "ui/shell/input.hpp"

namespace stillpoint {

// A recorded interaction: a text file, one event a line, that drives window and offscreen alike.
//
//   stillpoint recording 1
//   sequence 300 generated:walking_static
//   opened generated:walking_static
//   size 1600 900
//   look dark 1
//   layout {"panel": "input"}
//   set run.method=paper
//   key Right
//   idle
//   screenshot after.png
//
// What stands before the first event says how things stood at the start, all of it optional: the sequence
// (frames and name) and where it was opened, size, look, layout, and parameters that differ from their
// defaults. Lines that are empty or begin with # count for nothing.

// Events besides input. Words below are those of the file.
namespace event {
struct Wait {
  double seconds = 0.0;
};               ///< `wait 0.5`: the interface's clock goes on so far
struct Idle {};  ///< `idle`: until nothing is being worked on
struct Until {
  int frame = 0;
};  ///< `until 12`: while playing, until that frame or a later one is shown
struct Frame {
  int frame = 0;
};  ///< `frame 12`: goes there, and waits until it is shown
struct Act {
  std::string name;
};  ///< `action toggle_theme`: a named action, as from the palette
struct Point {
  std::string panel;
  double x = 0.0, y = 0.0;
};  ///< `point errors 0.5 0.2`: the mouse goes there, in shares of the panel's tile
struct Resize {
  int width = 0, height = 0;
};  ///< `size 800 600`, px
struct Screenshot {
  std::string file;
};  ///< `screenshot name.png`: what is shown, once it is static
struct Expect {
  std::string what, value;
};               ///< `expect frame 12`: ends the replay with one sentence where it does not hold
struct Quit {};  ///< `quit`
}  // namespace event

using RecordedEvent =
    std::variant<InputEvent, event::Wait, event::Idle, event::Until, event::Frame, event::Act, event::Point,
                 event::Resize, event::Screenshot, event::Expect, event::Quit>;

struct RecordedLine {
  int line = 0;  ///< of the file, from 1
  RecordedEvent what;
};

/// How things stood when recording began.
struct RecordingStart {
  std::string sequence_name;           ///< empty: any will do
  int sequence_frames = 0;             ///< 0: any number
  std::string opened_from;             ///< a folder or generated:KIND; empty: the name
  int sequence_line = 0;               ///< of the file, for messages
  std::array<int, 2> size{1600, 900};  ///< px
  std::string theme = "dark";
  double scale = 1.0;
  std::string layout;                 ///< JSON; empty: the default one
  std::vector<std::string> settings;  ///< section.name=value
};

struct Recording {
  static constexpr int kVersion = 1;  // of the format: readers refuse what is newer
  std::string file;                   ///< for messages
  RecordingStart start;
  std::vector<RecordedLine> lines;
};

/// Reads a recording.
/// @param file its name, for messages
/// @throws InputError with file and line: no recording, another version, an unknown event, a value that
/// cannot be
[[nodiscard]] Recording parse_recording(const std::string& text, const std::string& file);
[[nodiscard]] Recording read_recording(const std::filesystem::path& path);

/// The file's words for one event, and for the start.
[[nodiscard]] std::string to_line(const RecordedEvent& event);
[[nodiscard]] std::string to_text(const RecordingStart& start);

/// What a recorder has to know of the workbench at an event.
struct RecordedState {
  int frame = 0;
  bool playing = false, idle = true;
};

/// Writes a recording while someone works. Each line is on disk before the next event, so that nothing is
/// lost when the program ends badly.
class Recorder {
 public:
  /// @throws InputError when the file cannot be written
  Recorder(const std::filesystem::path& path, const RecordingStart& start);

  /// An event the interface took at `time_s` of its clock.
  void event(const InputEvent& event, double time_s, const RecordedState& state);
  /// The size drawn at, px; written when it changes.
  void size(int width, int height);
  /// The state at a frame of the interface: what to wait for before the next event.
  void state(const RecordedState& state);
  /// Writes what is held back. @throws InputError when writing has failed on the way
  void finish();
  /// False once something could not be written; nothing is written any more then.
  [[nodiscard]] bool intact() const { return intact_; }

 private:
  void write(const RecordedEvent& event);
  void flush_move();

  std::filesystem::path path_;
  std::ofstream file_;
  std::array<int, 2> size_{};
  std::vector<InputEvent> move_;  // the last mouse position, while only the last one counts
  double last_s_ = 0.0;
  bool was_busy_ = false, was_playing_ = false, intact_ = true;
};

}  // namespace stillpoint
