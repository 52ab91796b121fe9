#include "core/inspect/openable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <system_error>

#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/run/open_run.hpp"
#include "core/sequence/image_file.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// What folders of sequences have in them, in one layout or another.
constexpr std::array<std::string_view, 22> kSequenceEntries = {
    "rgb.txt",       "color.txt", "associations.txt", "associate.txt",  "rgb",   "color",
    "colour",        "image",     "image_0",          "image_2",        "left",  "mav0",
    "cam0",          "results",   "seq-01",           "aligned_depth",  "depth", "images",
    "metadata.yaml", "traj.txt",  "calib.txt",        "calibration.txt"};

/// Numbers in names go by their value.
bool comes_before(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const auto number_at = [&digit](const std::string& text, std::size_t& at) {
    while (at < text.size() && text[at] == '0') ++at;
    const std::size_t begin = at;
    while (at < text.size() && digit(text[at])) ++at;
    return std::string_view(text).substr(begin, at - begin);
  };
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      const std::string_view left = number_at(a, i), right = number_at(b, j);
      if (left.size() != right.size()) return left.size() < right.size();
      if (left != right) return left < right;
      continue;
    }
    const int left = std::tolower(static_cast<unsigned char>(a[i])),
              right = std::tolower(static_cast<unsigned char>(b[j]));
    if (left != right) return left < right;
    ++i, ++j;
  }
  return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

bool has_a_sequence(const fs::path& folder) {
  std::error_code none;
  if (std::any_of(kSequenceEntries.begin(), kSequenceEntries.end(),
                  [&](std::string_view name) { return fs::exists(folder / name, none); }))
    return true;
  // Or it is a folder of frames: one among many other folders is not looked for to the end.
  int left = 64;
  for (auto it = fs::directory_iterator(folder, none); !none && left-- > 0 && it != fs::directory_iterator();
       it.increment(none))
    if (is_image_name(it->path().filename().string())) return true;
  return false;
}

/// How a sensor's depth is stored.
std::string depth_words(const Camera& camera) {
  if (camera.is_stereo()) return fmt::format("by stereo, {:.4g} m apart", camera.baseline_m);
  std::string words = fmt::format("at {:g} a metre", camera.depth_scale);
  if (const auto& depth = camera.depth_camera)
    words += fmt::format(", registered from {}x{} px", depth->camera.width, depth->camera.height);
  return words;
}

}  // namespace

std::optional<PlaceKind> kind_of_place(const fs::path& path) {
  std::error_code none;
  if (fs::is_directory(path, none))
    return is_run_folder(path)    ? PlaceKind::run
           : has_a_sequence(path) ? PlaceKind::sequence
                                  : PlaceKind::folder;
  if (!fs::is_regular_file(path, none)) return std::nullopt;
  try {
    if (is_sequence_file(path.string())) return PlaceKind::file;
  } catch (const InputError&) {  // it cannot be read
  }
  return std::nullopt;
}

std::vector<OpenPlace> places_in(const fs::path& folder) {
  std::error_code problem;
  std::vector<OpenPlace> places;
  for (auto it = fs::directory_iterator(folder, problem); !problem && it != fs::directory_iterator();
       it.increment(problem)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with('.') || is_image_name(name)) continue;  // of frames there may be very many
    if (const auto kind = kind_of_place(it->path())) places.push_back({name, *kind});
  }
  if (problem) throw InputError(fmt::format("{}: cannot be read ({})", folder.string(), problem.message()));
  std::sort(places.begin(), places.end(), [](const OpenPlace& a, const OpenPlace& b) {
    const bool a_file = a.kind == PlaceKind::file, b_file = b.kind == PlaceKind::file;
    return a_file != b_file ? b_file : comes_before(a.name, b.name);
  });
  return places;
}

std::vector<SequenceFact> sequence_facts(const FrameSource& source) {
  const Camera& camera = source.camera();
  const double seconds = source.size() > 0 ? source.timestamp(source.size() - 1) - source.timestamp(0) : 0.0;
  return {{"Frames", fmt::format("{}, {:.3f} s", counted(source.size(), "frame"), seconds)},
          {"Camera", fmt::format("{} ({}x{} px)", camera.name, camera.width, camera.height)},
          {"Depth", source.has_depth() ? depth_words(camera) : "none"},
          {"Masks", source.has_masks() ? "yes" : "none"},
          {"Ground truth",
           source.ground_truth().empty() ? "none" : counted(source.ground_truth().size(), "pose")}};
}

}  // namespace stillpoint
