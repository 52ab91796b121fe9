#include "core/inspect/sidecar.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/out_folder.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "stillpoint marks";
constexpr int kVersion = 1;                      // of the format: readers refuse what is newer
constexpr std::uintmax_t kLargest = 16U << 20U;  // bytes: no person marks more

Json to_json(const MarkedSequence& sequence, const Marks& marks) {
  Json json;
  json["format"] = kFormat;
  json["version"] = kVersion;
  json["sequence"] = {{"name", sequence.name}, {"fingerprint", sequence.hash}, {"frames", sequence.frames}};
  json["bookmarks"] = Json::array();
  for (const Bookmark& mark : marks.bookmarks)
    json["bookmarks"].push_back({{"frame", mark.frame}, {"note", mark.note}});
  json["pins"] = Json::array();
  for (const Pin& pin : marks.pins)
    json["pins"].push_back({{"frame", pin.frame}, {"x", pin.x}, {"y", pin.y}, {"name", pin.name}});
  json["breakpoints"] = Json::array();
  for (const Breakpoint& breakpoint : marks.breakpoints)
    json["breakpoints"].push_back({{"condition", breakpoint.expression}, {"enabled", breakpoint.enabled}});
  json["drawn"] = Json::array();
  for (const DrawnFrame& drawn : marks.drawn) {
    Json movers = Json::array();
    for (const Outline& outline : drawn.movers) {
      Json corners = Json::array();
      for (const Corner& corner : outline) corners.push_back({corner.x, corner.y});
      movers.push_back(std::move(corners));
    }
    json["drawn"].push_back({{"frame", drawn.frame}, {"movers", std::move(movers)}});
  }
  json["span"] = nullptr;
  if (marks.span)
    json["span"] = {{"first", marks.span->first}, {"last", marks.span->last}, {"loop", marks.loop}};
  return json;
}

/// Reads marks out of JSON, and refuses in one sentence what is not as it should be.
class MarksReader {
 public:
  MarksReader(const fs::path& file, const MarkedSequence& sequence) : file_(file), sequence_(sequence) {}

  Marks read(const Json& json) {
    if (!json.is_object() || json.value("format", Json()) != kFormat) refuse("it is no file of marks");
    if (json.value("version", Json()) != kVersion)
      refuse(fmt::format("it is of version {}, expected {}", json.value("version", Json()).dump(), kVersion));
    check_sequence(json.value("sequence", Json()));
    Marks marks;
    for (const Json& mark : list(json, "bookmarks"))
      marks.bookmarks.push_back({frame(mark, "frame"), text(mark, "note")});
    for (const Json& pin : list(json, "pins"))
      marks.pins.push_back({frame(pin, "frame"), number(pin, "x"), number(pin, "y"), text(pin, "name")});
    for (const Json& breakpoint : list(json, "breakpoints"))
      marks.breakpoints.push_back({text(breakpoint, "condition"), yes(breakpoint, "enabled")});
    for (const Json& drawn : list(json, "drawn"))
      marks.drawn.push_back({frame(drawn, "frame"), outlines(member(drawn, "movers"))});
    for (std::size_t i = 1; i < marks.drawn.size(); ++i)
      if (marks.drawn[i].frame <= marks.drawn[i - 1].frame) refuse("its drawn frames are not in order");
    if (const Json span = json.value("span", Json()); !span.is_null()) {
      marks.span = FrameSpan{frame(span, "first"), frame(span, "last")};
      marks.loop = yes(span, "loop");
      if (marks.span->first > marks.span->last) refuse("its span ends before it begins");
    }
    return marks;
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError(
        fmt::format("{}: {}; it is left as it is, and what is marked now is not kept", file_.string(), why));
  }
  void check_sequence(const Json& json) const {
    if (!json.is_object()) refuse("it does not say which sequence it belongs to");
    if (json.value("fingerprint", Json()) == sequence_.hash) return;
    const Json name = json.value("name", Json());
    if (name == sequence_.name) refuse("the sequence has changed since it was written");
    refuse(fmt::format("it belongs to another sequence ({})",
                       in_quotes(name.is_string() ? name.get<std::string>() : "?")));
  }
  [[nodiscard]] Json list(const Json& json, const char* key) const {
    Json items = json.value(key, Json::array());
    if (!items.is_array()) refuse(fmt::format("\"{}\" is no list", key));
    return items;
  }
  [[nodiscard]] Json member(const Json& json, const char* key) const {
    if (!json.is_object() || !json.contains(key)) refuse(fmt::format("\"{}\" is missing", key));
    return json[key];
  }
  [[nodiscard]] int frame(const Json& json, const char* key) const {
    const Json value = member(json, key);
    if (!value.is_number_integer() || value < 0 || value >= sequence_.frames)
      refuse(fmt::format("\"{}\" is {}, expected a frame from 0 to {}", key, in_quotes(value.dump()),
                         sequence_.frames - 1));
    return value.get<int>();
  }
  [[nodiscard]] std::vector<Outline> outlines(const Json& json) const {
    if (!json.is_array()) refuse("\"movers\" is no list");
    std::vector<Outline> all;
    for (const Json& corners : json) {
      if (!corners.is_array() || corners.size() < 3) refuse("an outline is no list of three corners or more");
      Outline& outline = all.emplace_back();
      for (const Json& corner : corners) {
        if (!corner.is_array() || corner.size() != 2) refuse("a corner is no pair of numbers");
        outline.push_back({coordinate(corner[0]), coordinate(corner[1])});
      }
    }
    return all;
  }
  [[nodiscard]] double coordinate(const Json& value) const {
    constexpr double kFar = 1e5;  // px: no image is so large
    if (!value.is_number() || !(std::abs(value.get<double>()) <= kFar)) refuse("a corner lies nowhere");
    return value.get<double>();
  }
  [[nodiscard]] double number(const Json& json, const char* key) const {
    const Json value = member(json, key);
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      refuse(fmt::format("\"{}\" is no number", key));
    return value.get<double>();
  }
  [[nodiscard]] std::string text(const Json& json, const char* key) const {
    const Json value = member(json, key);
    if (!value.is_string()) refuse(fmt::format("\"{}\" is no text", key));
    return value.get<std::string>();
  }
  [[nodiscard]] bool yes(const Json& json, const char* key) const {
    const Json value = member(json, key);
    if (!value.is_boolean()) refuse(fmt::format("\"{}\" is neither true nor false", key));
    return value.get<bool>();
  }

  const fs::path& file_;
  const MarkedSequence& sequence_;
};

bool can_write_in(const fs::path& folder) {
  std::error_code error;
  return !folder.empty() && fs::is_directory(folder, error) && ::access(folder.c_str(), W_OK | X_OK) == 0;
}

bool is_there(const fs::path& file) {
  std::error_code error;
  return !file.empty() && fs::exists(file, error);
}

}  // namespace

Marks read_marks(const fs::path& file, const MarkedSequence& sequence) {
  std::error_code error;
  std::ifstream stream(file, std::ios::binary);
  if (!stream || !fs::is_regular_file(file, error) || fs::file_size(file, error) > kLargest)
    throw InputError(fmt::format("{}: cannot be read as a file of marks", file.string()));
  std::stringstream text;
  text << stream.rdbuf();
  try {
    return MarksReader(file, sequence).read(parse_json<Json>(text.str()));
  } catch (const Json::exception&) {
    throw InputError(fmt::format("{}: is damaged; it is left as it is, and what is marked now is not kept",
                                 file.string()));
  }
}

void write_marks(const fs::path& file, const MarkedSequence& sequence, const Marks& marks) {
  write_text_file(file, to_json(sequence, marks).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

Sidecar::Sidecar(const SidecarPlaces& places, MarkedSequence sequence) : sequence_(std::move(sequence)) {
  if (!places.user_folder.empty()) user_file_ = places.user_folder / (sequence_.hash + ".json");
  const fs::path beside = places.folder.empty() ? fs::path() : places.folder / kSidecarName;
  const bool in_folder = can_write_in(places.folder) || (is_there(beside) && !is_there(user_file_));
  file_ = in_folder ? beside : user_file_;
}

Marks Sidecar::load() {
  if (!is_there(file_)) return {};
  try {
    kept_ = read_marks(file_, sequence_);
  } catch (const InputError&) {
    locked_ = true;
    throw;
  }
  return kept_;
}

void Sidecar::save(const Marks& marks) {
  if (locked_ || file_.empty() || marks == kept_) return;
  // A sequence that can only be read keeps its marks with the user from the first change on.
  if (!can_write_in(file_.parent_path()) && file_ != user_file_) file_ = user_file_;
  if (file_.empty()) return;
  std::error_code error;
  fs::create_directories(file_.parent_path(), error);
  write_marks(file_, sequence_, marks);
  kept_ = marks;
}

}  // namespace stillpoint
