#include "ui/shell/recording.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>
#include <utility>

#include "core/error.hpp"

namespace stillpoint {
namespace {

constexpr const char* kHead = "stillpoint recording";
constexpr std::array<const char*, 3> kButtons{"left", "right", "middle"};
// A window's side in px, and frames: more is a slip of the keyboard.
constexpr int kLargestRecorded = 16384, kMostFrames = 100'000'000;
constexpr double kLongestWait = 3600.0;  // s: longer is a slip of the keyboard

/// A line being read, word by word.
class Words {
 public:
  Words(const std::string& file, int line, std::string text)
      : file_(file), line_(line), text_(std::move(text)) {}

  [[noreturn]] void fail(const std::string& why) const {
    throw InputError(fmt::format("{}:{}: {}", file_, line_, why));
  }

  [[nodiscard]] bool more() {
    at_ = std::min(text_.find_first_not_of(' ', at_), text_.size());
    return at_ < text_.size();
  }

  std::string word(const char* what) {
    if (!more()) fail(fmt::format("expected {} after '{}'", what, text_));
    const std::size_t end = std::min(text_.find(' ', at_), text_.size());
    std::string found = text_.substr(at_, end - at_);
    at_ = end;
    return found;
  }

  std::string rest(const char* what) {
    if (!more()) fail(fmt::format("expected {} after '{}'", what, text_));
    return text_.substr(std::exchange(at_, text_.size()));
  }

  double number(const char* what, double low, double high) {
    const std::string found = word(what);
    double value = 0.0;
    const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
    if (error != std::errc() || end != found.data() + found.size() || !std::isfinite(value) || value < low ||
        value > high)
      fail(fmt::format("expected {} from {:g} to {:g}, found '{}'", what, low, high, found));
    return value;
  }

  int whole(const char* what, int low, int high) {
    const double value = number(what, low, high);
    if (value != std::floor(value)) fail(fmt::format("expected {} as a whole number, found {}", what, value));
    return static_cast<int>(value);
  }

  /// What may follow an event: "Ctrl+Shift".
  Modifiers modifiers() {
    if (!more()) return {};
    const std::string found = word("modifiers");
    const auto chord = parse_key_chord(found + "+A");
    if (!chord) fail(fmt::format("expected modifiers like Ctrl+Shift, found '{}'", found));
    return chord->modifiers;
  }

  int button() {
    const std::string found = word("a mouse button");
    for (std::size_t i = 0; i < kButtons.size(); ++i)
      if (found == kButtons[i]) return static_cast<int>(i);
    fail(fmt::format("expected left, right or middle, found '{}'", found));
  }

 private:
  const std::string& file_;
  int line_;
  std::string text_;
  std::size_t at_ = 0;
};

std::string modifier_text(const Modifiers& modifiers) {
  if (modifiers == Modifiers{}) return "";
  const std::string chord = to_string(KeyChord{Key::kA, modifiers});
  return fmt::format(" {}", std::string_view(chord).substr(0, chord.size() - 2));
}

void append_utf8(std::string& text, unsigned codepoint) {
  const auto put = [&](unsigned byte) { text += static_cast<char>(byte); };
  if (codepoint < 0x80U) {
    put(codepoint);
  } else if (codepoint < 0x800U) {
    put(0xC0U | codepoint >> 6U);
    put(0x80U | (codepoint & 0x3FU));
  } else if (codepoint < 0x10000U) {
    put(0xE0U | codepoint >> 12U);
    put(0x80U | (codepoint >> 6U & 0x3FU));
    put(0x80U | (codepoint & 0x3FU));
  } else {
    put(0xF0U | (codepoint >> 18U & 0x07U));
    put(0x80U | (codepoint >> 12U & 0x3FU));
    put(0x80U | (codepoint >> 6U & 0x3FU));
    put(0x80U | (codepoint & 0x3FU));
  }
}

/// The letters of a UTF-8 text; nothing where it is none.
std::optional<std::vector<unsigned>> codepoints(const std::string& text) {
  std::vector<unsigned> letters;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<std::uint8_t>(text[i++]);
    const int more = lead < 0x80         ? 0
                     : lead >> 5 == 0x6  ? 1
                     : lead >> 4 == 0xE  ? 2
                     : lead >> 3 == 0x1E ? 3
                                         : -1;
    if (more < 0) return std::nullopt;
    unsigned letter = more == 0 ? lead : lead & (0x3FU >> more);
    for (int k = 0; k < more; ++k, ++i) {
      if (i >= text.size() || (static_cast<std::uint8_t>(text[i]) & 0xC0U) != 0x80U) return std::nullopt;
      letter = letter << 6U | (static_cast<std::uint8_t>(text[i]) & 0x3FU);
    }
    letters.push_back(letter);
  }
  return letters;
}

/// The events of one line: a click is a press and a release, a text one event a letter.
std::vector<RecordedEvent> read_event(const std::string& kind, Words& words) {
  using namespace event;
  const auto position = [&](const char* what) { return words.number(what, -1e6, 1e6); };
  if (kind == "wait") return {Wait{words.number("seconds", 0.0, kLongestWait)}};
  if (kind == "idle") return {Idle{}};
  if (kind == "until") return {Until{words.whole("a frame", 0, kMostFrames)}};
  if (kind == "frame") return {Frame{words.whole("a frame", 0, kMostFrames)}};
  if (kind == "action") return {Act{words.word("an action's name")}};
  if (kind == "point") {
    const std::string panel = words.word("a panel's name");
    const double x = words.number("x as a share", 0.0, 1.0);
    return {Point{panel, x, words.number("y as a share", 0.0, 1.0)}};
  }
  if (kind == "size") {
    const int width = words.whole("a width", 16, kLargestRecorded);
    return {Resize{width, words.whole("a height", 16, kLargestRecorded)}};
  }
  if (kind == "screenshot") return {Screenshot{words.rest("a file's name")}};
  if (kind == "expect") {
    const std::string what = words.word("what is expected");
    return {Expect{what, words.rest("the value expected")}};
  }
  if (kind == "quit") return {Quit{}};
  if (kind == "move") {
    const double x = position("x in px");
    return {InputEvent{MouseMoved{static_cast<float>(x), static_cast<float>(position("y in px"))}}};
  }
  if (kind == "press" || kind == "release" || kind == "click") {
    const int button = words.button();
    const Modifiers modifiers = words.modifiers();
    std::vector<RecordedEvent> both;
    if (kind != "release") both.emplace_back(InputEvent{MouseButton{button, true, modifiers}});
    if (kind != "press") both.emplace_back(InputEvent{MouseButton{button, false, modifiers}});
    return both;
  }
  if (kind == "wheel") {
    const double dx = position("notches across");
    const double dy = position("notches up");
    return {InputEvent{MouseWheel{static_cast<float>(dx), static_cast<float>(dy), words.modifiers()}}};
  }
  if (kind == "key") {
    const std::string found = words.word("a key");
    auto chord = parse_key_chord(found);
    // A modifier's own press and release carry no key.
    if (!chord && found == "None") chord = KeyChord{};
    if (!chord && found.ends_with("+None")) {
      chord = parse_key_chord(found.substr(0, found.size() - 4) + "A");
      if (chord) chord->key = Key::kNone;
    }
    if (!chord) words.fail(fmt::format("expected a key like Ctrl+P, found '{}'", found));
    const std::string way = words.more() ? words.word("down or up") : "";
    if (!way.empty() && way != "down" && way != "up")
      words.fail(fmt::format("expected down or up, found '{}'", way));
    std::vector<RecordedEvent> both;
    if (way != "up") both.emplace_back(InputEvent{KeyChanged{chord->key, true, chord->modifiers}});
    if (way == "down") return both;
    both.emplace_back(
        InputEvent{KeyChanged{chord->key, false, way == "up" ? chord->modifiers : Modifiers{}}});
    return both;
  }
  if (kind == "text") {
    const std::string quoted = words.rest("a text");
    if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"')
      words.fail(fmt::format("expected a text between quotes, found {}", quoted));
    const auto letters = codepoints(quoted.substr(1, quoted.size() - 2));
    if (!letters) words.fail("the text is not UTF-8");
    std::vector<RecordedEvent> typed;
    for (const unsigned letter : *letters) typed.emplace_back(InputEvent{TextTyped{letter}});
    return typed;
  }
  if (kind == "focus") {
    const std::string way = words.word("in or out");
    if (way != "in" && way != "out") words.fail(fmt::format("expected in or out, found '{}'", way));
    return {InputEvent{FocusChanged{way == "in"}}};
  }
  if (kind == "drop") return {InputEvent{FilesDropped{{words.rest("a path")}}}};
  words.fail(
      fmt::format("'{}' is nothing that can happen; there are wait, idle, until, frame, action, point, "
                  "size, screenshot, expect, move, press, release, click, wheel, key, text, focus, drop "
                  "and quit",
                  kind));
}

/// Reads a line that says how things stood. @returns whether it is one
bool read_start(const std::string& kind, Words& words, int line, RecordingStart& start) {
  if (kind == "sequence") {
    start.sequence_line = line;
    start.sequence_frames = words.whole("a number of frames", 0, kMostFrames);
    start.sequence_name = words.rest("a sequence's name");
  } else if (kind == "opened") {
    start.opened_from = words.rest("a folder or generated:KIND");
  } else if (kind == "size") {
    start.size = {words.whole("a width", 16, kLargestRecorded), 0};
    start.size[1] = words.whole("a height", 16, kLargestRecorded);
  } else if (kind == "look") {
    start.theme = words.word("a theme");
    if (start.theme != "dark" && start.theme != "light")
      words.fail(fmt::format("expected dark or light, found '{}'", start.theme));
    start.scale = words.number("a scale", 0.5, 4.0);
  } else if (kind == "layout") {
    start.layout = words.rest("a layout");
  } else if (kind == "set") {
    start.settings.push_back(words.rest("section.name=value"));
  } else {
    return false;
  }
  return true;
}

void read_head(const std::string& line, const std::string& file) {
  const std::string head = fmt::format("{} {}", kHead, Recording::kVersion);
  if (line == head) return;
  if (line.rfind(kHead, 0) == 0)
    throw InputError(fmt::format("{}:1: is of another version ('{}'); expected '{}'", file, line, head));
  throw InputError(fmt::format("{}:1: is no recording; expected '{}'", file, head));
}

struct LineOf {
  std::string operator()(const event::Wait& one) const { return fmt::format("wait {:.3g}", one.seconds); }
  std::string operator()(const event::Idle&) const { return "idle"; }
  std::string operator()(const event::Until& one) const { return fmt::format("until {}", one.frame); }
  std::string operator()(const event::Frame& one) const { return fmt::format("frame {}", one.frame); }
  std::string operator()(const event::Act& one) const { return "action " + one.name; }
  std::string operator()(const event::Point& one) const {
    return fmt::format("point {} {:.4g} {:.4g}", one.panel, one.x, one.y);
  }
  std::string operator()(const event::Resize& one) const {
    return fmt::format("size {} {}", one.width, one.height);
  }
  std::string operator()(const event::Screenshot& one) const { return "screenshot " + one.file; }
  std::string operator()(const event::Expect& one) const {
    return fmt::format("expect {} {}", one.what, one.value);
  }
  std::string operator()(const event::Quit&) const { return "quit"; }
  std::string operator()(const InputEvent& event) const {
    return std::visit([this](const auto& one) { return (*this)(one); }, event);
  }
  std::string operator()(const MouseMoved& one) const { return fmt::format("move {:g} {:g}", one.x, one.y); }
  std::string operator()(const MouseButton& one) const {
    if (one.button < 0 || one.button >= static_cast<int>(kButtons.size())) return "# another mouse button";
    return fmt::format("{} {}{}", one.down ? "press" : "release",
                       kButtons[static_cast<std::size_t>(one.button)], modifier_text(one.modifiers));
  }
  std::string operator()(const MouseWheel& one) const {
    return fmt::format("wheel {:g} {:g}{}", one.dx, one.dy, modifier_text(one.modifiers));
  }
  std::string operator()(const KeyChanged& one) const {
    return fmt::format("key {} {}", to_string(KeyChord{one.key, one.modifiers}), one.down ? "down" : "up");
  }
  std::string operator()(const TextTyped& one) const {
    std::string text = "text \"";
    append_utf8(text, one.codepoint);
    return text + '"';
  }
  std::string operator()(const FocusChanged& one) const { return one.focused ? "focus in" : "focus out"; }
  std::string operator()(const FilesDropped& one) const {
    std::string text;
    for (const std::string& path : one.paths) text += (text.empty() ? "drop " : "\ndrop ") + path;
    return text;
  }
};

}  // namespace

Recording parse_recording(const std::string& text, const std::string& file) {
  Recording recording;
  recording.file = file;
  std::istringstream lines(text);
  std::string line;
  bool started = false;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1) {
      read_head(line, file);
      continue;
    }
    Words words(file, number, line);
    if (!words.more() || line.front() == '#') continue;
    const std::string kind = words.word("an event");
    if (started || !read_start(kind, words, number, recording.start)) {
      started = true;
      for (RecordedEvent& one : read_event(kind, words)) recording.lines.push_back({number, std::move(one)});
    }
    if (words.more()) words.fail(fmt::format("'{}' is more than '{}' takes", words.rest(""), kind));
  }
  if (text.empty()) read_head("", file);
  return recording;
}

Recording read_recording(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored) || !file || !(text << file.rdbuf()))
    throw InputError(
        fmt::format("{}: cannot be read; expected a recording as --record writes it", path.string()));
  return parse_recording(text.str(), path.string());
}

std::string to_line(const RecordedEvent& event) { return std::visit(LineOf{}, event); }

std::string to_text(const RecordingStart& start) {
  std::string text = fmt::format("{} {}\n", kHead, Recording::kVersion);
  if (!start.sequence_name.empty())
    text += fmt::format("sequence {} {}\n", start.sequence_frames, start.sequence_name);
  if (!start.opened_from.empty()) text += fmt::format("opened {}\n", start.opened_from);
  text += fmt::format("size {} {}\nlook {} {:g}\n", start.size[0], start.size[1], start.theme, start.scale);
  if (!start.layout.empty()) text += fmt::format("layout {}\n", start.layout);
  for (const std::string& setting : start.settings) text += fmt::format("set {}\n", setting);
  return text;
}

}  // namespace stillpoint
